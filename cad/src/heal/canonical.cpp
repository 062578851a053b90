// General Fuse, distances and facets are fast and exact on elementary surfaces and slow or lost on
// B-splines that look the same; many systems write nothing but B-splines.
//
// Each face is sampled inside and along its border and fitted. A recognised face keeps its edges,
// which get new parameter curves. Where the new surface's own normal points to the other side, the
// wires are turned and the face is reversed. Edges change their 3D curve only where every face on
// them is elementary: a new curve would leave the pcurves on a freeform face wrong (parts were seen
// to change their volume by a third). Faces that come out badly are struck off and all is built
// again without them. A pole of the old surface is no pole of the new one, and its degenerated edge
// goes, but for the apex of a cone. Weak spots: a face with a seam is left alone (closed faces are
// divided before); ellipses stay B-splines.
#include "heal/canonical.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopAbs.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "exchange/measures.h"
#include "heal/elementary_fit.h"
#include "heal/face_on_surface.h"
#include "heal/face_samples.h"
#include "heal/line_or_circle.h"
#include "patches/patch_tools.h"

namespace phront::cad {
namespace {

// Relative change of a face's area that a new surface may make.
constexpr double kAreaChange = 1e-4;
constexpr int kRounds = 4;
// Cones nearer than this (rad) to a cylinder or a plane are one or the other by all that can be
// measured on a part. Their apex is far outside or their rulings have no direction, and the
// intersection of two such is lost in round-off (seen: a half-angle of 1e-4, the apex 190 km away).
constexpr double kLeastConicAngle = 1e-3;

Vec3 toVec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

bool hasPole(const TopoDS_Face& face) { return !poleOf(face).IsNull(); }

bool hasSeam(const TopoDS_Face& face) {
  std::set<const void*> seen;
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    if (!seen.insert(it.Current().TShape().get()).second) return true;
  }
  return false;
}

class Recogniser {
 public:
  Recogniser(const TopoDS_Shape& shape, double tolerance)
      : original_(shape), tolerance_(tolerance) {
    copyOriginal();
  }

  CanonicalShape run() {
    CanonicalShape result{original_};
    for (int f = 1; f <= faces_.Extent(); ++f) fit(f);
    for (int round = 0; round < kRounds && !fits_.empty(); ++round) {
      if (round > 0) copyOriginal();
      const std::set<int> bad = build();
      if (!bad.empty()) {
        for (const int f : bad) strikeOff(f);
        continue;
      }
      const TopoDS_Shape renewed = rebuilt(shape_);
      if (!BRepCheck_Analyzer(renewed).IsValid() && BRepCheck_Analyzer(original_).IsValid()) break;
      result.shape = renewed;
      result.edges = static_cast<int>(edges_.size());
      for (const auto& [f, fit] : fits_) {
        if (fit.alreadyElementary) continue;
        ++result.faces;
        result.deviation = std::max(result.deviation, fit.deviation);
      }
      break;
    }
    return result;
  }

 private:
  struct Fit {
    Handle(Geom_Surface) surface;
    double deviation = 0;
    bool turned = false;  ///< the new surface's own normal points to the other side
    bool alreadyElementary = false;
  };

  /// Parameter curves are added to edges: those of the input stay as they are.
  void copyOriginal() {
    shape_ = BRepBuilderAPI_Copy(original_).Shape();
    faces_.Clear();
    facesOfEdge_.Clear();
    TopExp::MapShapes(shape_, TopAbs_FACE, faces_);
    TopExp::MapShapesAndAncestors(shape_, TopAbs_EDGE, TopAbs_FACE, facesOfEdge_);
  }

  void fit(int f) {
    const TopoDS_Face face = TopoDS::Face(faces_(f));
    const BRepAdaptor_Surface surface(face, Standard_False);
    if (isElementary(surface)) {
      elementary_.insert(f);
      return;
    }
    try {
      if (hasSeam(face)) return;
      std::vector<SurfacePoint> points = samplesOf(face);
      std::optional<ElementaryFit> found = fitElementary(points, tolerance_);
      if (!found && hasPole(face)) found = fitUpToApex(face, points);
      if (!found) return;
      Fit fit{found->surface, found->deviation};
      const GeomAdaptor_Surface adaptor(fit.surface);
      const SurfacePoint& s = points[points.size() / 2];
      const gp_Pnt2d uv = parametersOn(adaptor, gp_Pnt(s.point.x(), s.point.y(), s.point.z()));
      gp_Pnt p;
      gp_Vec du;
      gp_Vec dv;
      adaptor.D1(uv.X(), uv.Y(), p, du, dv);
      fit.turned = du.Crossed(dv).Dot(gp_Vec(s.normal.x(), s.normal.y(), s.normal.z())) < 0;
      fits_[f] = fit;
      elementary_.insert(f);
    } catch (const Standard_Failure&) {
      return;  // stays what it is
    }
  }

  /// The cone whose apex is a pole of the face; takes the apex, where no normal is, out of
  /// `points`.
  std::optional<ElementaryFit> fitUpToApex(const TopoDS_Face& face,
                                           std::vector<SurfacePoint>& points) const {
    const TopoDS_Vertex pole = poleOf(face);
    const Vec3 apex = toVec(BRep_Tool::Pnt(pole));
    std::erase_if(points,
                  [&](const SurfacePoint& p) { return (p.point - apex).norm() < tolerance_; });
    std::optional<ElementaryFit> found = fitElementary(points, tolerance_);
    if (!found) return std::nullopt;
    const GeomAdaptor_Surface surface(found->surface);
    if (surface.GetType() != GeomAbs_Cone) return std::nullopt;
    if (!isApex(surface, BRep_Tool::Pnt(pole), tolerance_)) return std::nullopt;
    return found;
  }

  void strikeOff(int f) {
    if (!fits_.at(f).alreadyElementary) elementary_.erase(f);
    // An elementary face cannot be given back its old edges: keep its neighbours as they were.
    if (fits_.at(f).alreadyElementary) frozen_.insert(f);
    fits_.erase(f);
    for (auto it = fits_.begin(); it != fits_.end();) {
      it = it->second.alreadyElementary ? fits_.erase(it) : std::next(it);
    }
  }

  /// Makes edges and faces; returns the faces that come out badly.
  std::set<int> build() {
    edges_.clear();
    built_.clear();
    for (int e = 1; e <= facesOfEdge_.Extent(); ++e) renewEdge(e);
    std::set<int> bad;
    for (const auto& [f, fit] : fits_) {
      try {
        const TopoDS_Face face = TopoDS::Face(faces_(f));
        const TopoDS_Face renewed =
            faceOnSurface(face, fit.surface, fit.turned, edges_, tolerance_);
        const double area = accurateAreaOf(face);
        if (std::abs(accurateAreaOf(renewed) - area) > kAreaChange * area ||
            !BRepCheck_Analyzer(renewed).IsValid()) {
          bad.insert(f);
        }
        built_[f] = renewed;
      } catch (const Standard_Failure&) {
        bad.insert(f);
      }
    }
    return bad;
  }

  /// A line or circle instead of the edge, where all its faces allow it.
  void renewEdge(int e) {
    const TopoDS_Edge edge = TopoDS::Edge(facesOfEdge_.FindKey(e).Oriented(TopAbs_FORWARD));
    if (BRep_Tool::Degenerated(edge)) return;
    bool touched = false;
    bool all = true;
    for (const TopoDS_Shape& user : facesOfEdge_(e)) {
      const int f = faces_.FindIndex(user);
      touched = touched || (fits_.contains(f) && !fits_.at(f).alreadyElementary);
      all = all && elementary_.contains(f) && !frozen_.contains(f);
    }
    if (!touched || !all) return;
    const std::optional<CurveFit> found = fitLineOrCircle(edge, tolerance_);
    if (!found) return;
    const auto& [curve, last, off] = *found;
    for (const TopoDS_Shape& user : facesOfEdge_(e)) {
      const TopoDS_Face& face = TopoDS::Face(user);
      if (hasSeam(face) || (hasPole(face) && !fits_.contains(faces_.FindIndex(face)))) return;
    }
    const BRep_Builder builder;
    TopoDS_Edge renewed;
    builder.MakeEdge(renewed, curve, std::max(1.1 * off, Precision::Confusion()));
    TopoDS_Vertex ends[2];
    TopExp::Vertices(edge, ends[0], ends[1]);
    builder.Add(renewed, ends[0].Oriented(TopAbs_FORWARD));
    builder.Add(renewed, ends[1].Oriented(TopAbs_REVERSED));
    builder.Range(renewed, 0, last);
    const double gap = std::max(curve->Value(0).Distance(BRep_Tool::Pnt(ends[0])),
                                curve->Value(last).Distance(BRep_Tool::Pnt(ends[1])));
    for (const TopoDS_Vertex& end : ends) {
      builder.UpdateVertex(end, std::max(1.1 * gap, BRep_Tool::Tolerance(end)));
    }
    edges_[edge.TShape().get()] = renewed;
    for (const TopoDS_Shape& user : facesOfEdge_(e)) {
      const int f = faces_.FindIndex(user);
      if (fits_.contains(f)) continue;
      Fit same;
      same.surface = BRep_Tool::Surface(TopoDS::Face(user));
      same.alreadyElementary = true;
      fits_[f] = same;
    }
  }

  /// The shape with its renewed faces, all placements spelt out.
  TopoDS_Shape rebuilt(const TopoDS_Shape& shape) const {
    if (shape.ShapeType() == TopAbs_FACE) {
      const int f = faces_.FindIndex(shape);
      const auto renewed = built_.find(f);
      if (renewed == built_.end()) return shape;
      const TopAbs_Orientation turn = fits_.at(f).turned ? TopAbs_REVERSED : TopAbs_FORWARD;
      return renewed->second.Oriented(TopAbs::Compose(shape.Orientation(), turn));
    }
    const BRep_Builder builder;
    TopoDS_Shape copy = shape.EmptyCopied();
    copy.Location(TopLoc_Location());
    for (TopoDS_Iterator it(shape, Standard_False, Standard_True); it.More(); it.Next()) {
      builder.Add(copy, rebuilt(it.Value()));
    }
    if (shape.ShapeType() == TopAbs_SHELL) copy.Closed(shape.Closed());
    return copy;
  }

  TopoDS_Shape original_;
  TopoDS_Shape shape_;
  double tolerance_;
  TopTools_IndexedMapOfShape faces_;
  TopTools_IndexedDataMapOfShapeListOfShape facesOfEdge_;
  std::map<int, Fit> fits_;
  std::set<int> elementary_;
  std::set<int> frozen_;  ///< elementary as read, and not to be given new edges
  RenewedEdges edges_;
  std::map<int, TopoDS_Face> built_;
};

}  // namespace

bool isElementary(const BRepAdaptor_Surface& surface) {
  switch (surface.GetType()) {
    case GeomAbs_Plane:
    case GeomAbs_Cylinder:
    case GeomAbs_Sphere:
    case GeomAbs_Torus:
      return true;
    case GeomAbs_Cone:
      return std::abs(std::remainder(surface.Cone().SemiAngle(), M_PI / 2)) > kLeastConicAngle;
    default:
      return false;
  }
}

CanonicalShape recogniseSurfaces(const TopoDS_Shape& shape, double tolerance) {
  return Recogniser(shape, tolerance).run();
}

}  // namespace phront::cad
