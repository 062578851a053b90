// The drawing module: VTK on a surfaceless EGL context. VTK's own off-screen window ends the
// process where there is no X server, so the generic window is used, which leaves the context to
// us. Weak spot: lines are lifted a little towards the eye to lie over the surface; at grazing
// views a hidden one may show through.
#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkCommand.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <exception>

#include "io/draw/egl_context.h"
#include "io/picture_scene.h"

namespace phront::io {
namespace {

constexpr std::array<double, 3> kBackground{0.97, 0.975, 0.98};
constexpr std::array<double, 3> kLineColor{0.13, 0.15, 0.19};
constexpr std::array<double, 3> kTextColor{0.13, 0.15, 0.19};
constexpr int kSamples = 8;  // anti-aliasing; GL takes the nearest it has

/// Answers the generic window's questions about the context, which is ours.
class ContextAnswers : public vtkCommand {
 public:
  static ContextAnswers* New() { return new ContextAnswers; }  // NOLINT: VTK's reference counting
  const EglContext* context = nullptr;

  void Execute(vtkObject* /*caller*/, unsigned long event, void* data) override {
    if (event == vtkCommand::WindowMakeCurrentEvent) (void)context->makeCurrent();
    if (event == vtkCommand::WindowIsCurrentEvent) *static_cast<bool*>(data) = context->isCurrent();
    if (event == vtkCommand::WindowSupportsOpenGLEvent) *static_cast<int*>(data) = 1;
    if (event == vtkCommand::WindowIsDirectEvent) *static_cast<int*>(data) = 1;
  }
};

/// GLEW finds all functions of the context, then says it failed because it finds no GLX. The
/// context is known to be good: carry on.
class SurfacelessWindow : public vtkGenericOpenGLRenderWindow {
 public:
  vtkTypeMacro(SurfacelessWindow, vtkGenericOpenGLRenderWindow);
  static SurfacelessWindow* New();

 protected:
  void OpenGLInitContext() override {
    if (Initialized) return;
    Superclass::OpenGLInitContext();
    GlewInitValid = true;
    Initialized = true;
    MaximumHardwareLineWidth = 1;  // thicker lines are drawn by shaders, which always works
  }
};
vtkStandardNewMacro(SurfacelessWindow);

/// VTK prints its errors; phront prints nothing.
class SilentVtk {
 public:
  SilentVtk() : before_(vtkObject::GetGlobalWarningDisplay()) {
    vtkObject::SetGlobalWarningDisplay(0);
  }
  SilentVtk(const SilentVtk&) = delete;
  SilentVtk& operator=(const SilentVtk&) = delete;
  ~SilentVtk() { vtkObject::SetGlobalWarningDisplay(before_); }

 private:
  int before_;
};

vtkNew<vtkPolyData> surfaceOf(const SceneView& view) {
  // Relative to the centre: the card computes in single precision.
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> normals;
  normals->SetNumberOfComponents(3);
  normals->SetName("Normals");
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  colors->SetName("Colors");
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    const Vec3 p = view.points[i] - view.center;
    points->InsertNextPoint(p.x(), p.y(), p.z());
    const Vec3& n = view.normals[i];
    normals->InsertNextTuple3(n.x(), n.y(), n.z());
    colors->InsertNextTypedTuple(view.colors[i].data());
  }
  vtkNew<vtkCellArray> triangles;
  for (const auto& t : view.triangles) triangles->InsertNextCell({t[0], t[1], t[2]});
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(triangles);
  data->GetPointData()->SetNormals(normals);
  data->GetPointData()->SetScalars(colors);
  return data;
}

vtkNew<vtkPolyData> linesOf(const SceneView& view, const Vec3& lift) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  for (const auto& line : view.lines) {
    vtkIdType ids[2];
    for (int k = 0; k < 2; ++k) {
      const Vec3 p = line[static_cast<std::size_t>(k)] - view.center + lift;
      ids[k] = points->InsertNextPoint(p.x(), p.y(), p.z());
    }
    cells->InsertNextCell(2, ids);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(cells);
  return data;
}

void addSurface(vtkRenderer* renderer, const SceneView& view) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(surfaceOf(view));
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* property = actor->GetProperty();
  property->SetInterpolationToPhong();
  property->SetAmbient(0.24);
  property->SetDiffuse(0.8);
  property->SetSpecular(0.06);
  property->SetSpecularPower(30);
  renderer->AddActor(actor);
}

void addLines(vtkRenderer* renderer, const SceneView& view, const Scene& scene) {
  constexpr double kLift = 2e-3;  // of the view's height: above depth rounding, below what is seen
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(linesOf(view, kLift * scene.halfHeight * scene.towardsEye));
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(kLineColor[0], kLineColor[1], kLineColor[2]);
  actor->GetProperty()->LightingOff();
  constexpr double kThicknessPerPixel = 1.0 / 400;
  actor->GetProperty()->SetLineWidth(
      static_cast<float>(std::max(1.0, scene.height * kThicknessPerPixel)));
  renderer->AddActor(actor);
}

/// Text that VTK can set: bytes that are no ASCII become question marks, and what is too long for
/// the view keeps its end, where file names differ.
std::string printable(std::string text, std::size_t most) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  }
  if (text.size() > most) text = "..." + text.substr(text.size() - most + 3);
  return text;
}

void addCaption(vtkRenderer* renderer, const SceneView& view, double width, const Scene& scene) {
  if (view.caption.empty()) return;
  constexpr double kSizeShare = 0.36;   // of the caption's strip
  constexpr double kGlyphWidth = 0.62;  // of the font size, on the safe side for Arial
  constexpr std::size_t kMostGlyphs = 72;
  const std::string text = printable(view.caption, kMostGlyphs);
  const double strip = kCaptionShare * scene.height;
  const double size =
      std::min(kSizeShare * strip, 0.96 * width / (kGlyphWidth * static_cast<double>(text.size())));
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  vtkTextProperty* property = actor->GetTextProperty();
  property->SetFontFamilyToArial();
  property->SetFontSize(std::max(6, static_cast<int>(size)));
  property->SetColor(kTextColor[0], kTextColor[1], kTextColor[2]);
  property->SetJustificationToCentered();
  property->SetVerticalJustificationToCentered();
  actor->SetPosition(width / 2, strip / 2);
  renderer->AddActor2D(actor);
}

void addLights(vtkRenderer* renderer) {
  // In the camera's frame: a key light from the upper left, a head light, a weak one from the
  // right.
  const auto add = [&](double x, double y, double intensity) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(x, y, 1);
    light->SetFocalPoint(0, 0, 0);
    light->SetIntensity(intensity);
    renderer->AddLight(light);
  };
  renderer->AutomaticLightCreationOff();
  add(-0.5, 1.2, 0.55);
  add(0, 0, 0.42);
  add(1.5, 0.2, 0.2);
}

void setCamera(vtkRenderer* renderer, const Scene& scene) {
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  // The view's part of the strip's height lies above the captions: the middle is moved down.
  const double whole = scene.halfHeight / (1 - kCaptionShare);
  const Vec3 focus = -kCaptionShare * whole * scene.up;
  const Vec3 eye = focus + 2 * scene.radius * scene.towardsEye;
  camera->SetFocalPoint(focus.x(), focus.y(), focus.z());
  camera->SetPosition(eye.x(), eye.y(), eye.z());
  camera->SetViewUp(scene.up.x(), scene.up.y(), scene.up.z());
  camera->SetParallelScale(whole);
  camera->SetClippingRange(0.5 * scene.radius, 3.5 * scene.radius);
}

Result<std::string> draw(const Scene& scene) {
  const SilentVtk silent;
  auto context = EglContext::create();
  if (!context) return tl::unexpected(context.error());

  vtkNew<ContextAnswers> answers;
  answers->context = &*context;
  vtkNew<SurfacelessWindow> window;
  for (const auto event :
       {vtkCommand::WindowMakeCurrentEvent, vtkCommand::WindowIsCurrentEvent,
        vtkCommand::WindowSupportsOpenGLEvent, vtkCommand::WindowIsDirectEvent}) {
    window->AddObserver(event, answers);
  }
  window->SetReadyForRendering(true);
  window->SetFrameBlitModeToNoBlit();  // there is no surface to blit to
  window->SetOffScreenRendering(1);
  window->SetSize(scene.width, scene.height);
  window->SetMultiSamples(kSamples);

  const auto count = static_cast<double>(scene.views.size());
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    vtkNew<vtkRenderer> renderer;
    renderer->SetViewport(static_cast<double>(i) / count, 0, static_cast<double>(i + 1) / count, 1);
    renderer->SetBackground(kBackground.data());
    addLights(renderer);
    addSurface(renderer, scene.views[i]);
    addLines(renderer, scene.views[i], scene);
    addCaption(renderer, scene.views[i], scene.width / count, scene);
    setCamera(renderer, scene);
    window->AddRenderer(renderer);
  }
  window->Render();

  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  image->ShouldRerenderOff();
  image->SetInputBufferTypeToRGB();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  std::string png;
  if (bytes != nullptr) {
    png.assign(reinterpret_cast<const char*>(bytes->GetPointer(0)),
               static_cast<std::size_t>(bytes->GetNumberOfValues()));
  }
  window->Finalize();
  if (png.empty()) return fail(ErrorCode::Failed, "no picture: VTK drew nothing");
  return png;
}

}  // namespace
}  // namespace phront::io

// Found by its plain name; both sides are built from the same picture_scene.h.
extern "C" __attribute__((visibility("default"))) void phrontDrawScene(
    const phront::io::Scene& scene, phront::Result<std::string>& png) {
  try {
    png = phront::io::draw(scene);
  } catch (const std::exception& e) {
    png = phront::fail(phront::ErrorCode::Failed, std::string("no picture: ") + e.what());
  }
}
