// Offsetting asks more of a shape than validity does. C0 B-splines have no offset surface: they are
// divided where they are not C1. A closed face or a closed edge meets itself at its seam, where the
// images of its two sides are different curves: both are cut in halves. Faces on one surface
// may be merged first, which takes away the seams between them. A mirrored part has left-handed
// surfaces; no file format has them, and their offset surfaces would be written to the other side.
// Weak spot: a division that OpenCASCADE gets wrong is seen only by area and validity.
#include "heal/heal.h"

#include <fmt/format.h>

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <Geom_ElementarySurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <ShapeCustom.hxx>
#include <ShapeFix_Shape.hxx>
#include <ShapeFix_Wireframe.hxx>
#include <ShapeUpgrade_ShapeDivideClosed.hxx>
#include <ShapeUpgrade_ShapeDivideClosedEdges.hxx>
#include <ShapeUpgrade_ShapeDivideContinuity.hxx>
#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <cmath>

#include "exchange/measures.h"
#include "heal/canonical.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

/// Relative change of area that a step may make: the divisions only cut.
constexpr double kAreaChange = 1e-4;

/// Edges shorter than this share of the tolerance are dropped.
constexpr double kSmallEdge = 0.1;

/// Faces on other surfaces than planes, cylinders, cones, spheres and tori.
int freeformFaces(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  int count = 0;
  for (int i = 1; i <= faces.Extent(); ++i) {
    const BRepAdaptor_Surface surface(TopoDS::Face(faces(i)), Standard_False);
    if (!isElementary(surface)) ++count;
  }
  return count;
}

/// Has a freeform face a pole?
bool hasPole(const TopoDS_Shape& shape) {
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Face& face = TopoDS::Face(it.Current());
    if (!isElementary(BRepAdaptor_Surface(face, Standard_False)) && !poleOf(face).IsNull())
      return true;
  }
  return false;
}

int facesOf(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  return faces.Extent();
}

bool isSame(double area, double other) { return std::abs(other - area) <= kAreaChange * area; }

/// Takes the step's result when it changed something and kept the area.
template <class Step>
void apply(HealedShape& healed, const std::string& name, Step&& step) {
  try {
    const TopoDS_Shape before = healed.shape;
    TopoDS_Shape after = step(before);
    if (after.IsNull() || after.IsSame(before)) return;
    if (!BRepCheck_Analyzer(after).IsValid()) {
      // The divisions leave edges behind whose parameter curves run differently.
      ShapeFix_Shape fix(after);
      fix.Perform();
      after = fix.Shape();
    }
    // The dear look is for divided faces: short edges alone are worth little.
    if (!isSame(areaOf(before), areaOf(after)) &&
        (facesOf(after) == facesOf(before) ||
         !isSame(accurateAreaOf(before), accurateAreaOf(after)))) {
      healed.notes.push_back(name + " changed the shape and was left out");
      return;
    }
    healed.shape = after;
    healed.notes.push_back(name + ": " + std::to_string(facesOf(before)) + " faces become " +
                           std::to_string(facesOf(after)));
  } catch (const Standard_Failure&) {
    healed.notes.push_back(name + " failed and was left out");
  }
}

TopoDS_Shape divideContinuity(const TopoDS_Shape& shape, double tolerance) {
  ShapeUpgrade_ShapeDivideContinuity divide(shape);
  divide.SetTolerance(tolerance);
  divide.SetBoundaryCriterion(GeomAbs_C1);
  divide.SetPCurveCriterion(GeomAbs_C1);
  divide.SetSurfaceCriterion(GeomAbs_C1);
  return divide.Perform() ? divide.Result() : shape;
}

TopoDS_Shape divideClosed(const TopoDS_Shape& shape, int cuts) {
  ShapeUpgrade_ShapeDivideClosed divide(shape);
  divide.SetNbSplitPoints(cuts);
  return divide.Perform() ? divide.Result() : shape;
}

TopoDS_Shape divideClosedEdges(const TopoDS_Shape& shape) {
  ShapeUpgrade_ShapeDivideClosedEdges divide(shape);
  divide.SetNbSplitPoints(1);
  return divide.Perform() ? divide.Result() : shape;
}

bool hasEdgesBelow(const TopoDS_Shape& shape, double length) {
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(shape, TopAbs_EDGE, edges);
  for (int i = 1; i <= edges.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(edges(i));
    if (BRep_Tool::Degenerated(edge)) continue;
    if (GCPnts_AbscissaPoint::Length(BRepAdaptor_Curve(edge)) < length) return true;
  }
  return false;
}

/// The pipe of an edge of no length is a face of no area, which no file format can carry.
TopoDS_Shape dropSmallEdges(const TopoDS_Shape& shape, double length) {
  ShapeFix_Wireframe fix(shape);
  fix.SetPrecision(length);
  fix.SetMaxTolerance(length);
  fix.ModeDropSmallEdges() = Standard_True;
  return fix.FixSmallEdges() ? fix.Shape() : shape;
}

bool hasLeftHandedSurfaces(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) {
    Handle(Geom_Surface) surface = BRep_Tool::Surface(TopoDS::Face(faces(i)));
    if (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface);
        !trimmed.IsNull())
      surface = trimmed->BasisSurface();
    const auto elementary = Handle(Geom_ElementarySurface)::DownCast(surface);
    if (!elementary.IsNull() && !elementary->Position().Direct()) return true;
  }
  return false;
}

TopoDS_Shape unify(const TopoDS_Shape& shape) {
  ShapeUpgrade_UnifySameDomain unifier(shape, Standard_True, Standard_True, Standard_False);
  unifier.Build();
  return unifier.Shape();
}

/// Closed faces divided by so many cuts, then recognised; without notes where nothing is.
HealedShape recognisedIn(const TopoDS_Shape& body, int cuts, double tolerance) {
  HealedShape divided;
  divided.shape = BRepBuilderAPI_Copy(body).Shape();
  apply(divided, "division of closed faces",
        [&](const TopoDS_Shape& s) { return divideClosed(s, cuts); });
  HealedShape recognised;
  try {
    const CanonicalShape found = recogniseSurfaces(divided.shape, tolerance);
    if (found.faces == 0) return recognised;
    recognised.shape = found.shape;
    recognised.notes.push_back(
        fmt::format("{} of {} freeform faces are planes, cylinders, cones, spheres or tori within "
                    "{:.2g} mm",
                    found.faces, freeformFaces(divided.shape), found.deviation));
  } catch (const Standard_Failure&) {  // stays what it is
  }
  return recognised;
}

}  // namespace

HealedShape makeElementary(const TopoDS_Shape& body, double tolerance) {
  HealedShape best;
  best.shape = body;
  if (freeformFaces(body) == 0) return best;
  // The halves of a sphere have no axis whose poles lie off their border; thirds have.
  for (const int cuts : {1, 2}) {
    if (cuts > 1 && !hasPole(best.shape)) break;
    const HealedShape found = recognisedIn(body, cuts, tolerance);
    if (!found.notes.empty() &&
        (best.notes.empty() || freeformFaces(found.shape) < freeformFaces(best.shape)))
      best = found;
  }
  return best;
}

HealedShape heal(const TopoDS_Shape& body, const HealOptions& options) {
  HealedShape healed;
  healed.shape = BRepBuilderAPI_Copy(body).Shape();
  const double small = kSmallEdge * options.tolerance;
  if (hasEdgesBelow(healed.shape, small)) {
    apply(healed, "removal of small edges",
          [&](const TopoDS_Shape& s) { return dropSmallEdges(s, small); });
  }
  if (hasLeftHandedSurfaces(healed.shape))
    apply(healed, "turning left-handed surfaces", ShapeCustom::DirectFaces);
  if (options.unify) apply(healed, "merging faces", unify);
  apply(healed, "division at kinks",
        [&](const TopoDS_Shape& s) { return divideContinuity(s, options.tolerance); });
  apply(healed, "division of closed faces",
        [](const TopoDS_Shape& s) { return divideClosed(s, 1); });
  apply(healed, "division of closed edges", divideClosedEdges);
  return healed;
}

}  // namespace phront::cad
