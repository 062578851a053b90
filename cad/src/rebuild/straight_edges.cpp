#include "rebuild/straight_edges.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Line.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <optional>

#include "exchange/tolerances.h"
#include "patches/patch_tools.h"
#include "rebuild/edge_uses.h"

namespace phront::cad {
namespace {

constexpr int kSamples = 17;       // of a line, on the face
constexpr int kMostDivisions = 8;  // of an edge, by halving
constexpr double kShortest = 4;    // times the distance of the curve's ends from its vertices

/// Lines along one edge of one face.
class Straightener {
 public:
  Straightener(const TopoDS_Edge& edge, const TopoDS_Face& face, const StraightenOptions& options)
      : edge_(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD))),
        face_(face),
        options_(options),
        curve_(edge_) {
    TopExp::Vertices(edge_, ends_[0], ends_[1]);
    image_ = BRep_Tool::CurveOnSurface(edge_, face_, first_, last_);
  }

  /// A wire of lines; empty where there is none, or one of them leaves the face.
  std::optional<TopoDS_Wire> run() {
    if (image_.IsNull() || ends_[0].IsNull() || ends_[1].IsNull()) return std::nullopt;
    const gp_Pnt from = BRep_Tool::Pnt(ends_[0]);
    const gp_Pnt to = BRep_Tool::Pnt(ends_[1]);
    shortest_ = kShortest * std::max(from.Distance(at(0)), to.Distance(at(1)));
    divide(0, 1, from, to, ends_[0].IsSame(ends_[1]) ? 2 : 0);
    shares_.push_back(1);
    const BRep_Builder builder;
    TopoDS_Wire wire;
    builder.MakeWire(wire);
    TopoDS_Vertex before = ends_[0];
    double begin = 0;
    for (const double end : shares_) {
      const TopoDS_Vertex after = end == 1 ? ends_[1] : makeVertex(at(end), Precision::Confusion());
      const TopoDS_Edge line = lineBetween(begin, end, before, after);
      if (line.IsNull()) return std::nullopt;
      builder.Add(wire, line);
      before = after;
      begin = end;
    }
    return wire;
  }

 private:
  /// Point of the edge's curve at a share of its range.
  [[nodiscard]] gp_Pnt at(double share) const {
    return curve_.Value(curve_.FirstParameter() +
                        share * (curve_.LastParameter() - curve_.FirstParameter()));
  }

  /// Collects shares at which the edge is divided, at least `least` times over.
  void divide(double a, double b, const gp_Pnt& pa, const gp_Pnt& pb, int least, int depth = 0) {
    double off = 0;
    double length = 0;
    gp_Pnt last = pa;
    constexpr int kParts = 8;
    for (int i = 1; i < kParts; ++i) {
      const gp_Pnt p = at(a + (b - a) * i / kParts);
      const gp_Vec along(pa, pb);
      const gp_Vec arm(pa, p);
      const double chord = along.Magnitude();
      off = std::max(off, chord > 0 ? along.Crossed(arm).Magnitude() / chord : arm.Magnitude());
      length += last.Distance(p);
      last = p;
    }
    const bool straight = off <= options_.chord && pa.Distance(pb) <= options_.longest;
    if (depth >= kMostDivisions || (depth >= least && (straight || length < 2 * shortest_))) return;
    const double m = (a + b) / 2;
    const gp_Pnt pm = at(m);
    divide(a, m, pa, pm, least, depth + 1);
    shares_.push_back(m);
    divide(m, b, pm, pb, least, depth + 1);
  }

  [[nodiscard]] TopoDS_Edge lineBetween(double begin, double end, const TopoDS_Vertex& before,
                                        const TopoDS_Vertex& after) const {
    const gp_Pnt from = BRep_Tool::Pnt(before);
    const gp_Pnt to = BRep_Tool::Pnt(after);
    const double length = from.Distance(to);
    if (length <= Precision::Confusion()) return {};
    const gp_Dir direction(gp_Vec(from, to));
    const BRep_Builder builder;
    TopoDS_Edge line;
    builder.MakeEdge(line, new Geom_Line(from, direction), Precision::Confusion());
    builder.Add(line, before.Oriented(TopAbs_FORWARD));
    builder.Add(line, after.Oriented(TopAbs_REVERSED));
    builder.Range(line, 0, length);
    // On a plane the line is its own image.
    if (BRepAdaptor_Surface(face_, Standard_False).GetType() != GeomAbs_Plane) {
      const Handle(Geom2d_Curve) image = imageOf(begin, end, from, direction, length);
      if (image.IsNull()) return {};
      TopLoc_Location place;
      const Handle(Geom_Surface) surface = BRep_Tool::Surface(face_, place);
      builder.UpdateEdge(line, image, surface, place, Precision::Confusion());
      builder.Range(line, surface, place, 0, length);
    }
    return raiseTolerance(line, face_) <= options_.tolerance ? line : TopoDS_Edge();
  }

  /// The part of the edge's curve on the face, by the parameter of the line; null where the edge
  /// does not run along the line.
  [[nodiscard]] Handle(Geom2d_Curve) imageOf(double begin, double end, const gp_Pnt& from,
                                             const gp_Dir& direction, double length) const {
    TColgp_Array1OfPnt2d poles(1, kSamples);
    TColStd_Array1OfReal knots(1, kSamples);
    TColStd_Array1OfInteger multiplicities(1, kSamples);
    multiplicities.Init(1);
    multiplicities(1) = multiplicities(kSamples) = 2;
    for (int i = 1; i <= kSamples; ++i) {
      const double share = begin + (end - begin) * (i - 1) / (kSamples - 1);
      poles(i) = image_->Value(first_ + share * (last_ - first_));
      knots(i) = i == 1          ? 0
                 : i == kSamples ? length
                                 : gp_Vec(from, at(share)).Dot(gp_Vec(direction));
      if (i > 1 && !(knots(i) > knots(i - 1) + Precision::PConfusion())) return {};
    }
    constexpr int kDegree = 1;
    return new Geom2d_BSplineCurve(poles, knots, multiplicities, kDegree);
  }

  const TopoDS_Edge edge_;
  const TopoDS_Face& face_;
  const StraightenOptions& options_;
  const BRepAdaptor_Curve curve_;
  TopoDS_Vertex ends_[2];
  Handle(Geom2d_Curve) image_;
  double first_ = 0;
  double last_ = 0;
  double shortest_ = 0;
  std::vector<double> shares_;
};

}  // namespace

std::vector<std::size_t> straightenOpenEdges(std::vector<TopoDS_Face>& faces,
                                             const StraightenOptions& options) {
  const EdgeUses uses(faces);
  const Handle(BRepTools_ReShape) reshape = new BRepTools_ReShape;
  std::vector<std::size_t> left;
  for (std::size_t e = 0; e < uses.faces.size(); ++e) {
    if (uses.faces[e].size() != 1) continue;
    const std::size_t f = uses.faces[e][0];
    const std::optional<TopoDS_Wire> lines = Straightener(uses.edge(e), faces[f], options).run();
    if (lines)
      reshape->Replace(uses.edge(e).Oriented(TopAbs_FORWARD), *lines);
    else
      left.push_back(f);
  }
  for (TopoDS_Face& face : faces) face = TopoDS::Face(reshape->Apply(face));
  return left;
}

}  // namespace phront::cad
