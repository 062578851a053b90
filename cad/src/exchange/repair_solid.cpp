// Order of repair, each step only where the one before left a fault: drop faces listed twice, turn
// faces that disagree with their neighbours, sew open edges, turn the whole by the sign of its
// volume, at last OpenCASCADE's general healer, accepted only if the result is valid and its volume
// and box are those of the input. Weak spots: which of two nested closed shells without a solid is
// a cavity is not asked (the faces alone do not say so); self-intersections are not looked for.
#include "exchange/repair_solid.h"

#include <fmt/format.h>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepLib.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <ShapeBuild_ReShape.hxx>
#include <ShapeFix_Shape.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <cmath>

#include "exchange/measures.h"

namespace phront::cad {
namespace {

// What healing may change: a tenth of what a reader of figures would notice.
constexpr double kHealedVolumeChange = 1e-3;    // of the volume
constexpr double kHealedDiagonalChange = 1e-3;  // of the diagonal

// Sewing distance: files without topology are mostly written to 1e-5 or 1e-6 of their size.
constexpr double kSewShare = 1e-5;
constexpr double kSmallestSewing = 1e-6;  // mm

TopoDS_Solid solidOf(const std::vector<FaceSet>& shells) {
  BRep_Builder builder;
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  for (const FaceSet& faces : shells) builder.Add(solid, shellOf(faces));
  return solid;
}

void turn(FaceSet& faces) {
  for (TopoDS_Face& face : faces) face.Reverse();
}

std::string plural(int count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

// The input face behind each face of a sewn shape.
class SewnOrder {
 public:
  SewnOrder(const FaceSet& faces, const BRepBuilderAPI_Sewing& sewing, ShapeMarks& marks) {
    for (const TopoDS_Face& face : faces) {
      const TopoDS_Shape now = sewing.IsModified(face) ? sewing.Modified(face) : face;
      for (TopExp_Explorer it(now, TopAbs_FACE); it.More(); it.Next()) {
        if (order_.Add(it.Current()) > static_cast<int>(asRead_.size()))
          asRead_.push_back(face.Orientation());
        marks.copy(face, it.Current());
      }
    }
  }
  void sort(FaceSet& faces) const {
    std::stable_sort(faces.begin(), faces.end(), [&](const TopoDS_Face& a, const TopoDS_Face& b) {
      return order_.FindIndex(a) < order_.FindIndex(b);
    });
  }
  // Sewing keeps a face's surface, so that orientations can be compared.
  [[nodiscard]] bool turned(const TopoDS_Face& sewn) const {
    const int index = order_.FindIndex(sewn);
    return index > 0 && asRead_[static_cast<std::size_t>(index - 1)] != sewn.Orientation();
  }

 private:
  TopTools_IndexedMapOfShape order_;
  std::vector<TopAbs_Orientation> asRead_;
};

// Sewing makes faces agree, in the way of the first.
int turnedFaces(const FaceSet& sheet, const SewnOrder& order) {
  return static_cast<int>(std::count_if(
      sheet.begin(), sheet.end(), [&](const TopoDS_Face& face) { return order.turned(face); }));
}

// Shells of the solid after dropping and turning faces. Sets `changed`.
std::vector<FaceSet> agreeingShells(const TopoDS_Shape& solid, RepairContext& context,
                                    bool& changed) {
  std::vector<FaceSet> shells;
  for (TopExp_Explorer it(solid, TopAbs_SHELL); it.More(); it.Next()) {
    FaceSet faces = facesOf(it.Current());
    if (faces.empty()) continue;
    if (const int dropped = dropDuplicates(faces); dropped > 0) {
      changed = true;
      context.warnings.push_back(fmt::format("{} lists {} twice: the repetition is dropped",
                                             context.label, plural(dropped, "face")));
    }
    if (edgeUse(faces).clashingEdges > 0) {
      const int turned = orientAlike(faces);
      if (turned > 0) {
        changed = true;
        context.warnings.push_back(
            fmt::format("{} has {} inside out: turned to agree with the rest", context.label,
                        plural(turned, "face")));
      } else if (turned < 0) {
        context.warnings.push_back(context.label + " has faces that cannot all be turned outwards");
      }
    }
    shells.push_back(std::move(faces));
  }
  return shells;
}

bool allClosed(const std::vector<FaceSet>& shells) {
  return !shells.empty() && std::all_of(shells.begin(), shells.end(), [](const FaceSet& faces) {
    const EdgeUse use = edgeUse(faces);
    return use.freeEdges == 0 && use.edges > 0;
  });
}

// Outer shell outwards, cavities inwards. Returns true when it had to turn any.
bool orientByVolume(std::vector<FaceSet>& shells, RepairContext& context) {
  std::vector<double> volumes;
  for (const FaceSet& faces : shells) volumes.push_back(volumeOf(shellOf(faces)));
  std::size_t outer = 0;
  for (std::size_t s = 1; s < shells.size(); ++s) {
    if (std::abs(volumes[s]) > std::abs(volumes[outer])) outer = s;
  }
  bool turned = false;
  if (volumes[outer] < 0) {
    for (std::size_t s = 0; s < shells.size(); ++s) {
      turn(shells[s]);
      volumes[s] = -volumes[s];
    }
    context.warnings.push_back(context.label + " was inside out: turned to positive volume");
    turned = true;
  }
  Bnd_Box outerBox;
  BRepBndLib::Add(shellOf(shells[outer]), outerBox, Standard_False);
  for (std::size_t s = 0; s < shells.size(); ++s) {
    if (s == outer || volumes[s] < 0) continue;
    Bnd_Box box;
    BRepBndLib::Add(shellOf(shells[s]), box, Standard_False);
    if (box.IsVoid() || outerBox.IsOut(box)) continue;
    turn(shells[s]);
    context.warnings.push_back(context.label + " has a cavity turned inside out: corrected");
    turned = true;
  }
  return turned;
}

// The general healer's solid if it is one, valid, and of the same size; else a null shape.
TopoDS_Shape healed(const TopoDS_Shape& solid, RepairContext& context) {
  ShapeFix_Shape fix(solid);
  fix.Perform();
  TopoDS_Shape result = fix.Shape();
  if (result.IsNull()) return {};
  TopTools_IndexedMapOfShape solids;
  TopExp::MapShapes(result, TopAbs_SOLID, solids);
  if (solids.Extent() != 1 || !BRepCheck_Analyzer(solids(1)).IsValid()) return {};
  result = solids(1);
  if (!edgeUse(facesOf(result)).closed()) return {};
  const double before = volumeOf(solid);
  const double diagonal = boxDiagonal(solid);
  if (std::abs(volumeOf(result) - before) > kHealedVolumeChange * std::abs(before) ||
      std::abs(boxDiagonal(result) - diagonal) > kHealedDiagonalChange * diagonal) {
    return {};
  }
  for (const TopoDS_Face& face : facesOf(solid)) {
    for (const TopoDS_Face& now : facesOf(fix.Context()->Apply(face)))
      context.marks.copy(face, now);
  }
  return result;
}

std::vector<RepairedBody> asSheets(const std::vector<FaceSet>& shells) {
  std::vector<RepairedBody> sheets;
  for (const FaceSet& faces : shells) {
    for (const FaceSet& component : componentsOf(faces)) {
      sheets.push_back({shellOf(component), false});
    }
  }
  return sheets;
}

// An open solid: sewn if that closes it, else sheets.
std::vector<RepairedBody> closeOrOpen(const std::vector<FaceSet>& shells, RepairContext& context) {
  FaceSet all;
  int freeEdges = 0;
  for (const FaceSet& faces : shells) {
    all.insert(all.end(), faces.begin(), faces.end());
    freeEdges += edgeUse(faces).freeEdges;
  }
  if (!context.sewTolerance) context.sewTolerance = sewToleranceOf(shellOf(all));
  std::vector<RepairedBody> sewn = sewFaces(all, context);
  const bool closed = !sewn.empty() && std::all_of(sewn.begin(), sewn.end(),
                                                   [](const RepairedBody& b) { return b.solid; });
  if (closed) {
    context.warnings.push_back(fmt::format("{} had {}: sewn within {:.3g} mm", context.label,
                                           plural(freeEdges, "free edge"), *context.sewTolerance));
    return sewn;
  }
  context.warnings.push_back(fmt::format("{} is not closed: read as a sheet: {}", context.label,
                                         plural(freeEdges, "free edge")));
  return asSheets(shells);
}

}  // namespace

double boxDiagonal(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, Standard_False, Standard_False);
  if (box.IsVoid()) return 0;
  return box.CornerMin().Distance(box.CornerMax());
}

double sewToleranceOf(const TopoDS_Shape& shape) {
  return std::max(kSmallestSewing, kSewShare * boxDiagonal(shape));
}

std::vector<RepairedBody> sewFaces(const FaceSet& faces, RepairContext& context) {
  const double tolerance = context.sewTolerance.value_or(sewToleranceOf(shellOf(faces)));
  BRepBuilderAPI_Sewing sewing(tolerance);
  for (const TopoDS_Face& face : faces) sewing.Add(face);
  sewing.Perform();
  const TopoDS_Shape sewn = sewing.SewedShape();
  if (sewn.IsNull()) return asSheets({faces});
  // A face narrower than the tolerance is sewn to itself: better leave it alone.
  if (faces.size() == 1 && !BRepCheck_Analyzer(sewn).IsValid()) return asSheets({faces});
  const SewnOrder order(faces, sewing, context.marks);
  std::vector<RepairedBody> bodies;
  TopTools_IndexedMapOfShape shells;
  TopExp::MapShapes(sewn, TopAbs_SHELL, shells);
  for (int i = 1; i <= shells.Extent(); ++i) {
    FaceSet set = facesOf(shells(i));
    order.sort(set);
    if (!BRep_Tool::IsClosed(shells(i))) {
      bodies.push_back({shellOf(set), false, true, turnedFaces(set, order)});
      continue;
    }
    TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(shellOf(set)).Solid();
    BRepLib::OrientClosedSolid(solid);
    bodies.push_back({solid, true});
  }
  FaceSet loose;
  for (TopExp_Explorer it(sewn, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) {
    loose.push_back(TopoDS::Face(it.Current()));
  }
  order.sort(loose);
  for (RepairedBody& sheet : asSheets({loose})) bodies.push_back(std::move(sheet));
  return bodies;
}

std::vector<RepairedBody> repairSolid(const TopoDS_Shape& solid, RepairContext& context) {
  bool changed = false;
  std::vector<FaceSet> shells = agreeingShells(solid, context, changed);
  if (!allClosed(shells)) return closeOrOpen(shells, context);
  TopoDS_Shape result = solid;
  if (orientByVolume(shells, context)) changed = true;
  if (changed) result = solidOf(shells);
  if (!BRepCheck_Analyzer(result).IsValid()) {
    const TopoDS_Shape better = healed(result, context);
    context.warnings.push_back(
        better.IsNull()
            ? context.label + " is not valid (OpenCASCADE's check) and could not be healed"
            : context.label + " was not valid (OpenCASCADE's check): healed, its volume unchanged");
    if (better.IsNull()) return {{result, true, false}};
    result = better;
  }
  return {{result, true}};
}

}  // namespace phront::cad
