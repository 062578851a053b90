// OpenCASCADE writes into memory in a guarded child; the bytes are then written here, aside in the
// same folder, flushed and renamed: whatever fails, there is either the whole file or the old one.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <STEPConstruct.hxx>
#include <STEPControl_Writer.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepWriter.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>

#include "exchange/arc_ranges.h"
#include "exchange/guard.h"
#include "exchange/step_colours.h"
#include "exchange/step_products.h"
#include "exchange/step_string.h"
#include "phront/cad/exchange.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

namespace fs = std::filesystem;

// Large faceted solids take OpenCASCADE's STEP writer a minute.
constexpr GuardLimits kWriteLimits{.seconds = 180, .memoryMiB = 16384};

tl::unexpected<Error> cannotWrite(const fs::path& path, const std::string& why) {
  return fail(ErrorCode::CannotWrite, fmt::format("writing {}: {}", path.filename().string(), why),
              path.string());
}

tl::unexpected<Error> refused(const Body& body, const char* format) {
  return fail(ErrorCode::CannotWrite,
              fmt::format("OpenCASCADE cannot write body '{}' as {}", body.name, format));
}

void nameItem(const STEPControl_Writer& writer, const TopoDS_Shape& shape,
              const std::string& name) {
  if (name.empty()) return;
  const Handle(XSControl_WorkSession) session = writer.WS();
  TopLoc_Location location;
  const Handle(StepRepr_RepresentationItem) item =
      STEPConstruct::FindEntity(session->TransferWriter()->FinderProcess(), shape, location);
  if (!item.IsNull()) item->SetName(new TCollection_HAsciiString(stepString(name).c_str()));
}

// Curves in the parameters of planes say nothing that the planes do not; without them a
// polyhedron's file has a third of the size and is read three times as fast.
bool needsParameterCurves(const TopoDS_Shape& shape) {
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    const BRepAdaptor_Surface surface(TopoDS::Face(face.Current()), Standard_False);
    if (surface.GetType() != GeomAbs_Plane) return true;
  }
  return false;
}

void nameFaces(const STEPControl_Writer& writer, const Body& body) {
  const TopoDS_Shape& shape = occtShape(body.shape);
  nameItem(writer, shape, body.name);
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  const auto named =
      std::min<std::size_t>(body.faceNames.size(), static_cast<std::size_t>(faces.Extent()));
  for (std::size_t f = 0; f < named; ++f)
    nameItem(writer, faces(static_cast<int>(f) + 1), body.faceNames[f]);
}

/// Runs in the child: changes the shapes.
Result<std::string> stepBytes(const Model& model) {
  STEPControl_Writer writer;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.unit", "MM");
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  constexpr int kWholeShapes = 0;
  constexpr int kNestedCompounds = 1;
  Interface_Static::SetIVal("write.step.assembly",
                            model.assemblies.empty() ? kWholeShapes : kNestedCompounds);
  for (const Body& body : model.bodies)
    keepArcsWithinOneTurn(
        occtShape(body.shape));  // of this process only: bytesAs() runs in a child
  const ProductTree tree = productTree(model);
  for (const TopoDS_Shape& root : tree.roots) {
    Interface_Static::SetIVal("write.surfacecurve.mode", needsParameterCurves(root) ? 1 : 0);
    if (writer.Transfer(root, STEPControl_AsIs) != IFSelect_RetDone)
      return fail(ErrorCode::CannotWrite, "OpenCASCADE cannot write this model as STEP");
  }
  for (const Body& body : model.bodies) nameFaces(writer, body);
  nameProducts(writer, tree);
  writeColours(writer.WS(), model);
  StepData_StepWriter text(writer.Model());
  text.SendModel(Handle(StepData_Protocol)::DownCast(writer.WS()->Protocol()));
  std::ostringstream stream;
  text.Print(stream);
  return std::move(stream).str();
}

Result<std::string> igesBytes(const Model& model) {
  constexpr int kBrepMode = 1;  // entities 186: keeps the topology
  IGESControl_Writer writer("MM", kBrepMode);
  for (const Body& body : model.bodies) {
    if (!writer.AddShape(occtShape(body.shape))) return refused(body, "IGES");
  }
  writer.ComputeModel();
  std::ostringstream stream;
  if (!writer.Write(stream)) {
    return fail(ErrorCode::CannotWrite, "OpenCASCADE cannot write this model as IGES");
  }
  return std::move(stream).str();
}

Result<std::string> brepBytes(const Model& model) {
  TopoDS_Shape shape = occtShape(model.bodies.front().shape);
  if (model.bodies.size() > 1) {
    BRep_Builder builder;
    TopoDS_Compound compound;
    builder.MakeCompound(compound);
    for (const Body& body : model.bodies) builder.Add(compound, occtShape(body.shape));
    shape = compound;
  }
  std::ostringstream stream;
  BRepTools::Write(shape, stream, Standard_False, Standard_False, TopTools_FormatVersion_CURRENT);
  return std::move(stream).str();
}

Result<std::string> bytesAs(const Model& model, ShapeFormat format) {
  switch (format) {
    case ShapeFormat::Step:
      return stepBytes(model);
    case ShapeFormat::Iges:
      return igesBytes(model);
    case ShapeFormat::Brep:
      return brepBytes(model);
  }
  return fail(ErrorCode::CannotWrite, "its format is not known");
}

// Writes, flushes to the disk and closes; 0 or errno.
int writeWhole(const fs::path& path, const std::string& bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) return errno;
  int error = 0;
  for (std::size_t done = 0; done < bytes.size() && error == 0;) {
    const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (n >= 0) {
      done += static_cast<std::size_t>(n);
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (error == 0 && ::fsync(fd) != 0 && errno != EINVAL) error = errno;
  if (::close(fd) != 0 && error == 0) error = errno;
  return error;
}

Result<void> writeAside(const fs::path& path, const std::string& bytes) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const fs::path aside = folder / fmt::format(".{}.{}.part", path.filename().string(), ::getpid());
  std::error_code ignored;
  fs::remove(aside, ignored);  // left by a process of the same number that was killed
  int error = writeWhole(aside, bytes);
  if (error == 0 && ::rename(aside.c_str(), path.c_str()) != 0) error = errno;
  if (error == 0) return {};
  fs::remove(aside, ignored);
  return cannotWrite(path, std::strerror(error));
}

Result<void> checkTarget(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) return cannotWrite(path, "there is a folder of that name");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return cannotWrite(path, "it exists and is not a regular file");
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    return cannotWrite(path, "the folder " + folder.string() + " does not exist");
  }
  return {};
}

bool isTree(const Model& model) {
  const int count = static_cast<int>(model.assemblies.size());
  for (int a = 0; a < count; ++a) {
    const int parent = model.assemblies[static_cast<std::size_t>(a)].parent;
    if (parent < -1 || parent >= a) return false;
  }
  return std::all_of(model.bodies.begin(), model.bodies.end(), [&](const Body& body) {
    return body.assembly >= -1 && body.assembly < count;
  });
}

}  // namespace

Result<void> writeModel(const Model& model, const fs::path& path) {
  const auto format = shapeFormatOf(path);
  if (!format) return tl::unexpected<Error>(format.error());
  if (model.bodies.empty()) return cannotWrite(path, "the model has no bodies");
  for (const Body& body : model.bodies) {
    if (body.shape.empty()) return cannotWrite(path, "body '" + body.name + "' has no shape");
  }
  if (!isTree(model)) return cannotWrite(path, "its assemblies are no tree, parents first");
  if (auto target = checkTarget(path); !target) return target;
  const std::string what = "writing " + path.filename().string();
  const auto bytes = runInChild(what, kWriteLimits, [&] { return bytesAs(model, *format); });
  if (!bytes) {
    Error error = bytes.error();
    if (error.code == ErrorCode::Failed) error.code = ErrorCode::CannotWrite;
    if (error.message.find(what) == std::string::npos) error.message = what + ": " + error.message;
    error.where = path.string();
    return tl::unexpected<Error>(error);
  }
  return writeAside(path, *bytes);
}

}  // namespace phront::cad
