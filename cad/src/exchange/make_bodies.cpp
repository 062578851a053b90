// Solids one by one, then all faces that belong to no solid, sewn together at 1e-5 of their
// diagonal: files without topology (IGES, surface models) become closed solids where they close.
#include "exchange/make_bodies.h"

#include <fmt/format.h>
#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

#include "exchange/repair_solid.h"
#include "exchange/tolerances.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

// Above this share of the diagonal edges and vertices say little about where faces end.
constexpr double kLargeTolerance = 1e-3;
constexpr double kQuickLook = 0.5;  // the quick box of poles is up to twice too large
// Above this share the faces do not meet at all, whatever the file claims.
constexpr double kAbsurdTolerance = 0.25;

// A sentence's end why the vertices are nonsense, or empty.
std::string vertexDefect(const Loaded& loaded, double maxExtent) {
  for (const NamedShape& named : loaded.shapes) {
    TopTools_IndexedMapOfShape vertices;
    TopExp::MapShapes(named.shape, TopAbs_VERTEX, vertices);
    for (int i = 1; i <= vertices.Extent(); ++i) {
      const gp_Pnt p = BRep_Tool::Pnt(TopoDS::Vertex(vertices(i)));
      const double reach = std::max({std::abs(p.X()), std::abs(p.Y()), std::abs(p.Z())});
      if (!std::isfinite(p.X() + p.Y() + p.Z()))
        return "a vertex has a coordinate that is no number";
      if (reach > maxExtent) {
        return fmt::format("it reaches to {:.3g} mm (limit {:.3g} mm): check its length unit",
                           reach, maxExtent);
      }
    }
  }
  return {};
}

class BodyMaker {
 public:
  BodyMaker(Loaded loaded, const ReadOptions& options)
      : loaded_(std::move(loaded)), options_(options) {}

  Result<Model> make() {
    if (const std::string defect = vertexDefect(loaded_, options_.maxExtent); !defect.empty()) {
      return fail(ErrorCode::UnreadableInput, defect);
    }
    model_.unit = loaded_.unit;
    model_.unitInMm = loaded_.unitInMm;
    model_.warnings = loaded_.warnings;
    model_.assemblies = loaded_.assemblies;
    for (const NamedShape& named : loaded_.shapes) addSolids(named);
    addLooseFaces();
    if (!defect_.empty()) return fail(ErrorCode::UnreadableInput, defect_);
    if (model_.bodies.empty()) return fail(ErrorCode::UnreadableInput, noFaces());
    if (loaded_.unitInMm != 1) tellSize();
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) markFaces(model_.bodies[b]);
    return std::move(model_);
  }

 private:
  [[nodiscard]] std::string noFaces() const {
    if (!loaded_.emptyReason.empty()) return loaded_.emptyReason;
    for (const NamedShape& named : loaded_.shapes) {
      if (TopExp_Explorer(named.shape, TopAbs_EDGE).More())
        return "it holds edges but no faces; planar wires give a drawing: name the output .svg or "
               ".dxf";
    }
    return "it holds no faces";
  }

  // A wrong unit is seen by the size.
  void tellSize() {
    Bnd_Box box;
    for (const Body& body : model_.bodies) {
      BRepBndLib::Add(occtShape(body.shape), box, Standard_False);
    }
    if (box.IsVoid()) return;
    const gp_XYZ size = box.CornerMax().XYZ() - box.CornerMin().XYZ();
    model_.warnings.push_back(
        fmt::format("the file's length unit is {} (1 {} = {:g} mm): the model measures {:.4g} x "
                    "{:.4g} x {:.4g} "
                    "mm",
                    model_.unit, model_.unit, model_.unitInMm, size.X(), size.Y(), size.Z()));
  }

  void addSolids(const NamedShape& named) {
    int solids = 0;
    for (TopExp_Explorer it(named.shape, TopAbs_SOLID); it.More(); it.Next()) ++solids;
    for (TopExp_Explorer it(named.shape, TopAbs_SOLID); it.More(); it.Next()) {
      const TopoDS_Shape& solid = it.Current();
      if (facesOf(solid).empty()) continue;
      std::string name = named.name;
      const std::string own = loaded_.marks.of(solid).name;
      if (name.empty()) {
        name = own;
      } else if (solids > 1 && !own.empty() && own != name) {
        name += "/" + own;
      }
      const std::size_t first = model_.bodies.size();
      if (!options_.repair) {
        add({solid, true}, name);
      } else {
        RepairContext context = contextOf(name);
        for (const RepairedBody& body : repairSolid(solid, context)) add(body, name);
      }
      for (std::size_t b = first; b < model_.bodies.size(); ++b) {
        model_.bodies[b].colour = loaded_.marks.of(solid).colour;
        model_.bodies[b].assembly = named.assembly;
      }
    }
  }

  void addLooseFaces() {
    FaceSet loose;
    std::string name;
    bool oneName = true;
    for (const NamedShape& named : loaded_.shapes) {
      const std::size_t before = loose.size();
      for (TopExp_Explorer it(named.shape, TopAbs_FACE, TopAbs_SOLID); it.More(); it.Next()) {
        loose.push_back(TopoDS::Face(it.Current()));
      }
      if (loose.size() == before) continue;
      oneName = oneName && (before == 0 || named.name == name);
      name = named.name;
    }
    if (loose.empty()) return;
    if (!oneName) name.clear();
    if (!options_.repair) {
      for (const FaceSet& faces : componentsOf(loose)) add({shellOf(faces), false}, name);
      return;
    }
    RepairContext context = contextOf(name);
    context.sewTolerance = options_.sewTolerance.value_or(sewToleranceOf(shellOf(loose)));
    const EdgeUse asRead = edgeUse(loose);
    std::vector<RepairedBody> bodies = sewFaces(loose, context);
    reportSewing(asRead, bodies, *context.sewTolerance);
    for (const RepairedBody& body : bodies) add(body, name);
  }

  void reportSewing(const EdgeUse& asRead, const std::vector<RepairedBody>& bodies,
                    double tolerance) {
    int freeEdges = 0;
    int sheets = 0;
    int turned = 0;
    for (const RepairedBody& body : bodies) {
      if (body.solid) continue;
      ++sheets;
      turned += body.turned;
      freeEdges += edgeUse(facesOf(body.shape)).freeEdges;
    }
    if (asRead.freeEdges > freeEdges) {
      model_.warnings.push_back(
          fmt::format("faces without a solid are sewn within {:.3g} mm: {} free edges before, {} "
                      "after",
                      tolerance, asRead.freeEdges, freeEdges));
    }
    if (turned > 0) {
      model_.warnings.push_back(
          fmt::format("{} turned to agree with the neighbours: look on which side of the sheet the "
                      "result lies, the other has the other sign",
                      turned == 1 ? "1 face is" : fmt::format("{} faces are", turned)));
    }
    if (sheets > 0) {
      model_.warnings.push_back(fmt::format("read as {} sheet{}: {} free edges", sheets,
                                            sheets == 1 ? "" : "s", freeEdges));
    }
  }

  RepairContext contextOf(const std::string& name) {
    return {loaded_.marks, model_.warnings, options_.sewTolerance,
            label(model_.bodies.size(), name)};
  }

  static std::string label(std::size_t index, const std::string& name) {
    return name.empty() ? fmt::format("body {}", index + 1) : fmt::format("body '{}'", name);
  }

  void add(const RepairedBody& repaired, const std::string& name) {
    Body body;
    body.shape = makeShape(repaired.shape);
    body.kind = repaired.solid ? BodyKind::Solid : BodyKind::Sheet;
    body.name = name;
    body.valid = repaired.valid;
    if (options_.repair) checkTolerance(repaired.shape, name);
    if (options_.repair && !repaired.solid) checkSheet(repaired.shape, name);
    model_.bodies.push_back(std::move(body));
  }

  void checkSheet(const TopoDS_Shape& sheet, const std::string& name) {
    const std::string who = label(model_.bodies.size(), name);
    if (edgeUse(facesOf(sheet)).edges == 0) {
      model_.warnings.push_back(who + " has no edges that bound it: its extent is uncertain");
    } else if (!BRepCheck_Analyzer(sheet).IsValid()) {
      model_.warnings.push_back(who +
                                " is not valid (OpenCASCADE's check): its borders are uncertain");
    }
  }

  // Edges and vertices that miss each other by a large tolerance: a warning, or refusal. Files also
  // claim more than there is: that is lowered first.
  void checkTolerance(const TopoDS_Shape& shape, const std::string& name) {
    const auto largest = [&] { return ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1); };
    Bnd_Box quick;  // too large by the tolerance itself; the tight one takes seconds on freeform
    BRepBndLib::Add(shape, quick, Standard_False);
    if (quick.IsVoid()) return;
    const double quickDiagonal = quick.CornerMin().Distance(quick.CornerMax());
    if (largest() < kQuickLook * kLargeTolerance * quickDiagonal) return;
    const double diagonal = boxDiagonal(shape);
    const double limit = kLargeTolerance * diagonal;
    if (!(largest() > limit)) return;
    lowerTolerances(shape, limit);
    const double tolerance = largest();
    if (!(tolerance > limit)) return;
    const std::string who = label(model_.bodies.size(), name);
    if (tolerance > kAbsurdTolerance * diagonal) {
      defect_ = fmt::format(
          "{}, {:.3g} mm across, has edges that miss each other by up to {:.3g} mm: a point is "
          "probably wrong",
          who, diagonal, tolerance);
      return;
    }
    model_.warnings.push_back(fmt::format(
        "{} has edges or vertices with a tolerance of {:.3g} mm ({:.2g} % of its size): its faces "
        "meet no better than that",
        who, tolerance, 100 * tolerance / diagonal));
  }

  void markFaces(Body& body) const {
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(occtShape(body.shape), TopAbs_FACE, faces);
    for (int i = 1; i <= faces.Extent(); ++i) {
      const Mark mark = loaded_.marks.of(faces(i));
      body.faceNames.push_back(mark.name);
      body.faceColours.push_back(mark.colour);
    }
    const auto coloured = [](const std::optional<Colour>& colour) { return colour.has_value(); };
    if (std::none_of(body.faceColours.begin(), body.faceColours.end(), coloured))
      body.faceColours.clear();
  }

  Loaded loaded_;
  const ReadOptions& options_;
  Model model_;
  std::string defect_;  ///< end of the sentence that refuses the file
};

}  // namespace

Result<Model> makeBodies(Loaded loaded, const ReadOptions& options) {
  return BodyMaker(std::move(loaded), options).make();
}

}  // namespace phront::cad
