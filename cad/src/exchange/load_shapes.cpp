// STEP goes through XDE for the product names and placements, the names of faces and solids come
// from their entities (one pass over the model: asking per face is quadratic in OpenCASCADE 7.6).
#include "exchange/load_shapes.h"

#include <fmt/format.h>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BinTools.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_SolidModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <cctype>
#include <sstream>

#include "exchange/step_colours.h"
#include "exchange/step_string.h"

namespace phront::cad {
namespace {

// Assemblies nest less deep than this; deeper means a circle.
constexpr int kDeepestAssembly = 200;

std::string utf8(const TCollection_ExtendedString& text) {
  std::string out(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter buffer = out.data();
  text.ToUTF8CString(buffer);
  out.resize(out.find('\0'));
  return out;
}

std::string labelName(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  return textOfStepString(utf8(name->Get()));  // OpenCASCADE 7.6 leaves \\X2\\ as it is
}

/// `assembly`: the one that the label is a component of.
void collect(const TDF_Label& label, const TopLoc_Location& place, int depth, int assembly,
             Loaded& loaded) {
  if (depth > kDeepestAssembly) return;
  TDF_Label product = label;
  TopLoc_Location here = place;
  if (XCAFDoc_ShapeTool::IsReference(label)) {
    here = place * XCAFDoc_ShapeTool::GetLocation(label);
    XCAFDoc_ShapeTool::GetReferredShape(label, product);
  }
  if (XCAFDoc_ShapeTool::IsAssembly(product)) {
    TDF_LabelSequence parts;
    XCAFDoc_ShapeTool::GetComponents(product, parts);
    const int own = static_cast<int>(loaded.assemblies.size());
    loaded.assemblies.push_back({labelName(product), assembly});
    for (const TDF_Label& part : parts) collect(part, here, depth + 1, own, loaded);
    return;
  }
  const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(product);
  if (!shape.IsNull()) loaded.shapes.push_back({shape.Moved(here), labelName(product), assembly});
}

std::string asText(const Handle(TCollection_HAsciiString) & text) {
  return text.IsNull() ? std::string() : std::string(text->ToCString());
}

// Names of face and solid entities, and a warning for faces that were tried but gave nothing.
void nameEntities(const XSControl_WorkSession& session, Loaded& loaded) {
  const Handle(Transfer_TransientProcess) process = session.TransferReader()->TransientProcess();
  const auto model = Handle(StepData_StepModel)::DownCast(session.Model());
  int lost = 0;
  std::string firstLost;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(model->Value(i));
    const bool isFace = !item.IsNull() && item->IsKind(STANDARD_TYPE(StepShape_FaceSurface));
    const bool isSolid = !item.IsNull() && item->IsKind(STANDARD_TYPE(StepShape_SolidModel));
    if ((!isFace && !isSolid) || process->MapIndex(item) == 0) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, item);
    if (shape.IsNull()) {
      if (isFace && lost++ == 0) firstLost = fmt::format("#{}", model->IdentLabel(item));
      continue;
    }
    const std::string name = textOfStepString(asText(item->Name()));
    if (name.empty() || name == "NONE") continue;
    const TopAbs_ShapeEnum kind = isFace ? TopAbs_FACE : TopAbs_SOLID;
    for (TopExp_Explorer it(shape, kind); it.More(); it.Next()) {
      loaded.marks.setName(it.Current(), name);
    }
  }
  if (lost > 0) {
    loaded.warnings.push_back(
        fmt::format("{} of the file's faces could not be read (the first is {})", lost, firstLost));
  }
}

std::string externalSentence(const StepScan& scan) {
  if (scan.externalFiles.empty()) return {};
  return fmt::format(
      "it holds no geometry of its own: its parts lie in other files ({}{}); give a file that "
      "contains them",
      scan.externalFiles.front(), scan.externalFiles.size() > 1 ? ", ..." : "");
}

tl::unexpected<Error> nothing(const std::string& reason) {
  return fail(ErrorCode::UnreadableInput,
              reason.empty() ? "it holds no shapes that OpenCASCADE can read" : reason);
}

}  // namespace

Mark& ShapeMarks::at(const TopoDS_Shape& shape) {
  const TopoDS_Shape key = shape.Located(TopLoc_Location());
  Mark* mark = marks_.ChangeSeek(key);
  return mark ? *mark : *marks_.Bound(key, Mark());
}

void ShapeMarks::setName(const TopoDS_Shape& shape, const std::string& name) {
  if (!name.empty()) at(shape).name = name;
}

void ShapeMarks::setColour(const TopoDS_Shape& shape, const Colour& colour) {
  at(shape).colour = colour;
}

void ShapeMarks::copy(const TopoDS_Shape& from, const TopoDS_Shape& to) {
  const Mark mark = of(from);
  if (!mark.name.empty() || mark.colour) at(to) = mark;
}

Mark ShapeMarks::of(const TopoDS_Shape& shape) const {
  const Mark* mark = marks_.Seek(shape.Located(TopLoc_Location()));
  return mark ? *mark : Mark();
}

Result<Loaded> loadStep(const FileText& file, const StepScan& scan) {
  STEPCAFControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  reader.SetNameMode(Standard_True);
  reader.SetColorMode(Standard_False);
  reader.SetLayerMode(Standard_False);
  reader.SetPropsMode(Standard_False);
  std::istringstream stream(scan.endLineMissing ? file.bytes + "\nEND-ISO-10303-21;\n"
                                                : file.bytes);
  if (reader.ChangeReader().ReadStream("input", stream) != IFSelect_RetDone) {
    return fail(ErrorCode::UnreadableInput, "OpenCASCADE's STEP reader refuses it");
  }
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  const Handle(XCAFDoc_ShapeTool) tool = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  XCAFDoc_ShapeTool::SetAutoNaming(Standard_False);
  Loaded loaded;
  loaded.emptyReason = externalSentence(scan);
  if (!reader.Transfer(document)) return nothing(loaded.emptyReason);
  loaded.unit = scan.unit;
  loaded.unitInMm = scan.unitInMm;
  TDF_LabelSequence roots;
  tool->GetFreeShapes(roots);
  for (const TDF_Label& root : roots) collect(root, TopLoc_Location(), 0, -1, loaded);
  if (loaded.shapes.empty()) return nothing(loaded.emptyReason);
  nameEntities(*reader.Reader().WS(), loaded);
  readColours(reader.Reader().WS(), loaded.marks);
  return loaded;
}

Result<Loaded> loadIges(const std::filesystem::path& path) {
  IGESControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) {
    return fail(ErrorCode::UnreadableInput, "OpenCASCADE's IGES reader refuses it");
  }
  reader.SetReadVisible(Standard_True);
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  if (shape.IsNull()) return nothing({});
  Loaded loaded;
  loaded.shapes.push_back({shape, {}, -1});
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  const Handle(Transfer_TransientProcess) process =
      reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(IGESData_IGESEntity) entity = model->Entity(i);
    if (!entity->HasName() || process->MapIndex(entity) == 0) continue;
    const TopoDS_Shape result = TransferBRep::ShapeResult(process, entity);
    if (result.IsNull()) continue;
    for (const TopAbs_ShapeEnum kind : {TopAbs_FACE, TopAbs_SOLID}) {
      for (TopExp_Explorer it(result, kind); it.More(); it.Next()) {
        loaded.marks.setName(it.Current(), asText(entity->NameValue()));
      }
    }
  }
  loaded.unitInMm = model->GlobalSection().UnitValue();
  loaded.unit = asText(model->GlobalSection().UnitName());
  for (char& c : loaded.unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return loaded;
}

Result<Loaded> loadBrep(const FileText& file) {
  std::istringstream stream(file.bytes);
  TopoDS_Shape shape;
  if (file.binaryBrep) {
    BinTools::Read(shape, stream);
  } else {
    BRep_Builder builder;
    BRepTools::Read(shape, stream, builder);
  }
  if (shape.IsNull()) {
    return fail(ErrorCode::UnreadableInput, "OpenCASCADE finds no shape in it");
  }
  Loaded loaded;
  loaded.shapes.push_back({shape, {}, -1});
  return loaded;
}

}  // namespace phront::cad
