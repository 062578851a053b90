// A STEP file gives colours by styled items that point at solids, shells and faces. A colour on a
// face overrides that of its solid.
#include "exchange/step_colours.h"

#include <Interface_InterfaceModel.hxx>
#include <Quantity_Color.hxx>
#include <STEPConstruct_Styles.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepVisual_Colour.hxx>
#include <StepVisual_MechanicalDesignGeometricPresentationRepresentation.hxx>
#include <StepVisual_PresentationStyleAssignment.hxx>
#include <StepVisual_StyledItem.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>

#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

std::optional<Colour> colourOf(const STEPConstruct_Styles& styles,
                               const Handle(StepVisual_StyledItem) & style) {
  Handle(StepVisual_Colour) surface;
  Handle(StepVisual_Colour) boundary;
  Handle(StepVisual_Colour) curve;
  Handle(StepVisual_Colour) render;
  Standard_Real transparency = 0;
  Standard_Boolean isComponent = Standard_False;
  if (!styles.GetColors(style, surface, boundary, curve, render, transparency, isComponent))
    return std::nullopt;
  Quantity_Color colour;
  const Handle(StepVisual_Colour)& seen = surface.IsNull() ? render : surface;
  if (seen.IsNull() || !STEPConstruct_Styles::DecodeColor(seen, colour)) return std::nullopt;
  return Colour{colour.Red(), colour.Green(), colour.Blue()};
}

void mark(const TopoDS_Shape& shape, const Colour& colour, ShapeMarks& marks) {
  if (shape.ShapeType() == TopAbs_SOLID || shape.ShapeType() == TopAbs_FACE) {
    marks.setColour(shape, colour);
    return;
  }
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next())
    marks.setColour(solid.Current(), colour);
  for (TopExp_Explorer face(shape, TopAbs_FACE, TopAbs_SOLID); face.More(); face.Next())
    marks.setColour(face.Current(), colour);
}

/// Writes colours of one session; equal ones share their entities.
class ColourWriter {
 public:
  explicit ColourWriter(const Handle(XSControl_WorkSession) & session)
      : session_(session), styles_(session) {}

  void add(const TopoDS_Shape& shape, const Colour& colour) {
    const Quantity_Color value(colour.red, colour.green, colour.blue, Quantity_TOC_RGB);
    const Handle(StepVisual_Colour) encoded =
        STEPConstruct_Styles::EncodeColor(value, predefined_, mixed_);
    styles_.AddStyle(shape, styles_.GetColorPSA({}, encoded), {});
  }

  /// Puts the styles so far into the context of a shape.
  void finish(const TopoDS_Shape& shape) {
    if (styles_.NbStyles() == 0) return;
    Handle(StepVisual_MechanicalDesignGeometricPresentationRepresentation) presentation;
    if (styles_.CreateMDGPR(styles_.FindContext(shape), presentation))
      session_->Model()->AddWithRefs(presentation);
    styles_.ClearStyles();
  }

 private:
  Handle(XSControl_WorkSession) session_;
  STEPConstruct_Styles styles_;
  STEPConstruct_DataMapOfAsciiStringTransient predefined_;
  STEPConstruct_DataMapOfPointTransient mixed_;
};

}  // namespace

void readColours(const Handle(XSControl_WorkSession) & session, ShapeMarks& marks) {
  STEPConstruct_Styles styles(session);
  if (!styles.LoadStyles()) return;
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  for (int i = 1; i <= styles.NbStyles(); ++i) {
    const Handle(StepVisual_StyledItem) style = styles.Style(i);
    if (style.IsNull() || style->Item().IsNull()) continue;
    const std::optional<Colour> colour = colourOf(styles, style);
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, style->Item());
    if (colour && !shape.IsNull()) mark(shape, *colour, marks);
  }
}

void writeColours(const Handle(XSControl_WorkSession) & session, const Model& model) {
  ColourWriter writer(session);
  TopTools_MapOfShape done;  // instances of one part are one product
  for (const Body& body : model.bodies) {
    TopoDS_Shape shape = occtShape(body.shape);
    // In an assembly the file has the part where it was made, and its place beside it.
    if (body.assembly >= 0) shape.Location(TopLoc_Location());
    if (!done.Add(shape)) continue;
    if (body.colour) writer.add(shape, *body.colour);
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    for (int f = 1; f <= faces.Extent(); ++f) {
      const auto i = static_cast<std::size_t>(f) - 1;
      if (i < body.faceColours.size() && body.faceColours[i])
        writer.add(faces(f), *body.faceColours[i]);
    }
    writer.finish(shape);
  }
}

}  // namespace phront::cad
