// A crossing of two faces that become tangent fades out: the walk along it ends early, and General
// Fuse covers the rest by the tolerance of a vertex, a tenth of a millimetre where the faces are
// micrometres apart. Edges drawn out to one point need the tolerance of the faces only. Weak spot:
// edges with a seam on a face stay as they are.
#include "rebuild/wide_vertices.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <GeomLib.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Surface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "patches/patch_tools.h"
#include "rebuild/cells.h"

namespace phront::cad {
namespace {

constexpr int kSamples = 33;   // of an edge, for its parameter curves
constexpr double kGain = 0.5;  // of the tolerance: worth the change
constexpr double kMargin = 1.1;
constexpr double kTurn = 2;             // of the step: room for an edge to turn to its end
constexpr double kStraightShare = 0.3;  // of an edge: more than this is not drawn out but made up

double distanceTo(const TopoDS_Face& face, const gp_Pnt& point) {
  ShapeAnalysis_Surface surface(BRep_Tool::Surface(face));
  surface.ValueOfUV(point, Precision::Confusion());
  return surface.Gap();
}

/// An edge with other ends than it was made with.
class DrawnEdge {
 public:
  explicit DrawnEdge(const TopoDS_Edge& edge) : edge_(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD))) {
    double first = 0;
    double last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge_, first, last);
    if (curve.IsNull()) return;
    curve_ = new Geom_TrimmedCurve(curve, first, last);
    TopExp::Vertices(edge_, ends_[0], ends_[1]);
  }

  [[nodiscard]] bool isUsable() const {
    return !curve_.IsNull() && !ends_[0].IsNull() && !ends_[1].IsNull() &&
           !ends_[0].IsSame(ends_[1]);
  }
  [[nodiscard]] int endAt(const TopoDS_Vertex& vertex) const {
    return ends_[0].IsSame(vertex) ? 0 : 1;
  }
  [[nodiscard]] gp_Pnt pointAt(int end) const {
    return end == 0 ? curve_->StartPoint() : curve_->EndPoint();
  }

  /// False when the curve cannot be drawn out so far.
  bool drawTo(int end, const gp_Pnt& place) {
    const double step = pointAt(end).Distance(place);
    if (step <= Precision::Confusion()) return true;
    const double chord = pointAt(0).Distance(pointAt(1));
    if (step > kStraightShare * chord) return false;
    takeBack(end, place, kTurn * step / chord);
    if (pointAt(end).Distance(place) <= Precision::Confusion()) return true;
    constexpr int kTangent = 1;
    GeomLib::ExtendCurveToPoint(curve_, place, kTangent, end == 1);
    return pointAt(end).Distance(place) <= Precision::Confusion();
  }

  /// With parameter curves on `faces`; null where one cannot be had. `off`: how far it is off them.
  TopoDS_Edge make(const std::vector<TopoDS_Face>& faces, const std::array<TopoDS_Vertex, 2>& ends,
                   double& off) const {
    const double first = curve_->FirstParameter();
    const double last = curve_->LastParameter();
    const BRep_Builder builder;
    TopoDS_Edge made;
    builder.MakeEdge(made, curve_, Precision::Confusion());
    builder.Add(made, ends[0].Oriented(TopAbs_FORWARD));
    builder.Add(made, ends[1].Oriented(TopAbs_REVERSED));
    builder.Range(made, first, last);
    off = 0;
    for (const TopoDS_Face& face : faces) {
      TopLoc_Location place;
      const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, place);
      const Handle(Geom2d_Curve) image = imageOn(face, surface, place, first, last, off);
      if (image.IsNull()) return {};
      builder.UpdateEdge(made, image, surface, place, Precision::Confusion());
      builder.Range(made, surface, place, first, last);
    }
    builder.UpdateEdge(made, kMargin * off + Precision::Confusion());
    return made;
  }

 private:
  /// A curve that passes the place is cut off before it, so as to turn to it; `share` of its
  /// parameters where the place lies aside.
  void takeBack(int end, const gp_Pnt& place, double share) {
    const double first = curve_->FirstParameter();
    const double last = curve_->LastParameter();
    const GeomAPI_ProjectPointOnCurve nearest(place, curve_, first, last);
    if (nearest.NbPoints() == 0) return;  // ahead of its end
    double t = nearest.LowerDistanceParameter();
    if (nearest.LowerDistance() > Precision::Confusion())
      t += (end == 0 ? share : -share) * (last - first);
    if (!(t > first && t < last)) return;
    curve_ =
        end == 0 ? new Geom_TrimmedCurve(curve_, t, last) : new Geom_TrimmedCurve(curve_, first, t);
  }

  [[nodiscard]] Handle(Geom2d_Curve)
      imageOn(const TopoDS_Face& face, const Handle(Geom_Surface) & surface,
              const TopLoc_Location& place, double first, double last, double& off) const {
    double from = 0;
    double to = 0;
    const Handle(Geom2d_Curve) before = BRep_Tool::CurveOnSurface(edge_, face, from, to);
    if (before.IsNull()) return {};
    ShapeAnalysis_Surface projector(surface);
    std::vector<gp_Pnt2d> points;
    std::vector<double> parameters;
    const gp_Trsf toSurface = place.Transformation().Inverted();
    gp_Pnt2d seed = before->Value(from);
    for (int i = 0; i < kSamples; ++i) {
      const double t = std::lerp(first, last, static_cast<double>(i) / (kSamples - 1));
      const gp_Pnt p = curve_->Value(t).Transformed(toSurface);
      seed = projector.NextValueOfUV(seed, p, Precision::Confusion());
      parameters.push_back(t);
      points.push_back(seed);
    }
    const Handle(Geom2d_Curve) image = pcurveThrough(points, parameters);
    if (image.IsNull()) return {};
    for (int i = 0; i < 2 * kSamples - 1; ++i) {  // between the points, too
      const double t = std::lerp(first, last, static_cast<double>(i) / (2 * kSamples - 2));
      const gp_Pnt2d uv = image->Value(t);
      const gp_Pnt p = curve_->Value(t).Transformed(toSurface);
      off = std::max(off, p.Distance(surface->Value(uv.X(), uv.Y())));
    }
    return image;
  }

  TopoDS_Edge edge_;
  Handle(Geom_BoundedCurve) curve_;
  std::array<TopoDS_Vertex, 2> ends_;
};

class Narrower {
 public:
  explicit Narrower(const TopoDS_Shape& shape) {
    TopExp::MapShapesAndUniqueAncestors(shape, TopAbs_VERTEX, TopAbs_EDGE, edgesAt_);
    TopExp::MapShapesAndUniqueAncestors(shape, TopAbs_EDGE, TopAbs_FACE, facesAt_);
  }

  /// Returns whether the vertex can do with less.
  bool narrow(const TopoDS_Vertex& vertex) {
    std::vector<TopoDS_Edge> edges;
    std::vector<TopoDS_Face> faces;
    for (const TopoDS_Shape& e : edgesAt_.FindFromKey(vertex)) {
      const TopoDS_Edge edge = TopoDS::Edge(e);
      if (BRep_Tool::Degenerated(edge) || !DrawnEdge(current(edge)).isUsable()) return false;
      edges.push_back(edge);
      for (const TopoDS_Face& face : facesOf(edge)) {
        if (BRep_Tool::IsClosed(edge, face)) return false;
        faces.push_back(face);
      }
    }
    double least = kGain * BRep_Tool::Tolerance(vertex);
    std::vector<TopoDS_Edge> best;
    for (const gp_Pnt& place : candidatesFor(vertex, edges)) {
      const bool near = std::all_of(faces.begin(), faces.end(), [&](const TopoDS_Face& face) {
        return distanceTo(face, place) < least;
      });
      double off = 0;
      std::vector<TopoDS_Edge> drawn;
      if (near) drawn = drawTo(place, vertex, edges, off);
      if (drawn.empty() || off >= least) continue;
      least = off;
      best = std::move(drawn);
    }
    for (std::size_t i = 0; i < best.size(); ++i) current_[edges[i].TShape().get()] = best[i];
    return !best.empty();
  }

  [[nodiscard]] TopoDS_Shape apply(const TopoDS_Shape& shape) const {
    BRepTools_ReShape change;
    for (const TopoDS_Shape& edge : partsOf(shape, TopAbs_EDGE)) {
      const auto drawn = current_.find(edge.TShape().get());
      if (drawn != current_.end()) change.Replace(edge.Oriented(TopAbs_FORWARD), drawn->second);
    }
    return change.Apply(shape);
  }

 private:
  /// The edge as it is by now.
  [[nodiscard]] TopoDS_Edge current(const TopoDS_Edge& edge) const {
    const auto drawn = current_.find(edge.TShape().get());
    return drawn == current_.end() ? TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)) : drawn->second;
  }

  [[nodiscard]] std::vector<TopoDS_Face> facesOf(const TopoDS_Edge& edge) const {
    std::vector<TopoDS_Face> faces;
    for (const TopoDS_Shape& face : facesAt_.FindFromKey(edge)) faces.push_back(TopoDS::Face(face));
    return faces;
  }

  /// The vertex and the ends of its edges.
  [[nodiscard]] std::vector<gp_Pnt> candidatesFor(const TopoDS_Vertex& vertex,
                                                  const std::vector<TopoDS_Edge>& edges) const {
    std::vector<gp_Pnt> candidates{BRep_Tool::Pnt(vertex)};
    for (const TopoDS_Edge& edge : edges) {
      const DrawnEdge drawn(current(edge));
      candidates.push_back(drawn.pointAt(drawn.endAt(vertex)));
    }
    return candidates;
  }

  /// The edges with a vertex at `place` instead; empty where one cannot be drawn so far. `off`: how
  /// far they are off their faces.
  [[nodiscard]] std::vector<TopoDS_Edge> drawTo(const gp_Pnt& place, const TopoDS_Vertex& vertex,
                                                const std::vector<TopoDS_Edge>& edges,
                                                double& off) const {
    const TopoDS_Vertex narrow = makeVertex(place, Precision::Confusion());
    std::vector<TopoDS_Edge> drawn;
    for (const TopoDS_Edge& edge : edges) {
      DrawnEdge draw(current(edge));
      std::array<TopoDS_Vertex, 2> ends;
      TopExp::Vertices(current(edge), ends[0], ends[1]);
      const int end = draw.endAt(vertex);
      if (!draw.drawTo(end, place)) return {};
      ends[static_cast<std::size_t>(end)] = narrow;
      double edgeOff = 0;
      drawn.push_back(draw.make(facesOf(edge), ends, edgeOff));
      if (drawn.back().IsNull()) return {};
      off = std::max(off, edgeOff);
    }
    BRep_Builder().UpdateVertex(narrow, kMargin * off + Precision::Confusion());
    return drawn;
  }

  TopTools_IndexedDataMapOfShapeListOfShape edgesAt_;
  TopTools_IndexedDataMapOfShapeListOfShape facesAt_;
  std::map<const void*, TopoDS_Edge> current_;  ///< edges drawn out, by the edge they were
};

}  // namespace

TopoDS_Shape withNarrowVertices(const TopoDS_Shape& shape, double limit) {
  try {
    Narrower narrower(shape);
    bool any = false;
    for (const TopoDS_Shape& v : partsOf(shape, TopAbs_VERTEX)) {
      const TopoDS_Vertex vertex = TopoDS::Vertex(v);
      if (BRep_Tool::Tolerance(vertex) > limit && narrower.narrow(vertex)) any = true;
    }
    if (!any) return shape;
    const TopoDS_Shape narrow = narrower.apply(shape);
    const bool sound = !narrow.IsNull() && BRepCheck_Analyzer(narrow).IsValid() &&
                       countOpenEdges(narrow) <= countOpenEdges(shape);
    return sound ? narrow : shape;
  } catch (const Standard_Failure&) {
    return shape;
  }
}

}  // namespace phront::cad
