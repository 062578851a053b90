#include "shell/sheet_walls.h"

#include <Adaptor3d_CurveOnSurface.hxx>
#include <Approx_Curve3d.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepFill.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRep_Tool.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_Curve.hxx>
#include <Geom_OffsetSurface.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <cmath>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>

namespace phront::cad {
namespace {

constexpr int kSamples = 17;      // normals along an edge that decide what its wall is
constexpr int kMostPieces = 100;  // of the approximation of a curve, and its degree
constexpr int kDegree = 8;

gp_Pnt toPnt(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
gp_Vec toGpVec(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

class WallBuilder {
 public:
  WallBuilder(const FreeEdge& edge, double from, double to, double tolerance)
      : edge_(edge), from_(from), to_(to), tolerance_(tolerance) {}

  /// Null when there is none.
  TopoDS_Face build() {
    for (int i = 0; i < kSamples; ++i) {
      const double share = static_cast<double>(i) / (kSamples - 1);
      const std::optional<BorderPoint> p =
          edge_.at(edge_.first() + share * (edge_.last() - edge_.first()));
      if (!p) return {};
      samples_.push_back(*p);
    }
    if (normalIsConstant()) return prism();
    if (normalTurnsWithCircle()) return revolved();
    return ruled();
  }

 private:
  [[nodiscard]] double reach() const { return std::max(std::abs(from_), std::abs(to_)); }

  [[nodiscard]] bool normalIsConstant() const {
    for (const BorderPoint& p : samples_)
      if ((p.normal - samples_.front().normal).norm() * reach() > tolerance_) return false;
    return true;
  }

  [[nodiscard]] bool normalTurnsWithCircle() const {
    if (edge_.curve().GetType() != GeomAbs_Circle) return false;
    const gp_Circ circle = edge_.curve().Circle();
    const Vec3 axis(circle.Axis().Direction().X(), circle.Axis().Direction().Y(),
                    circle.Axis().Direction().Z());
    const Vec3 centre(circle.Location().X(), circle.Location().Y(), circle.Location().Z());
    const auto inFrame = [&](const BorderPoint& p) {
      const Vec3 radial = (p.point - centre).normalized();
      return Vec3(p.normal.dot(axis), p.normal.dot(radial), p.normal.dot(p.tangent));
    };
    const Vec3 first = inFrame(samples_.front());
    for (const BorderPoint& p : samples_)
      if ((inFrame(p) - first).norm() * reach() > tolerance_) return false;
    return std::abs(first.z()) * reach() <= tolerance_;
  }

  TopoDS_Face prism() const {
    const gp_Vec normal = toGpVec(samples_.front().normal);
    gp_Trsf move;
    move.SetTranslation(normal * from_);
    const TopoDS_Shape start = edge_.edge().Moved(TopLoc_Location(move));
    const TopoDS_Shape face = BRepPrimAPI_MakePrism(start, normal * (to_ - from_), true).Shape();
    return face.IsNull() ? TopoDS_Face() : TopoDS::Face(face);
  }

  TopoDS_Face revolved() const {
    const gp_Circ circle = edge_.curve().Circle();
    const BorderPoint& p = samples_.front();
    const TopoDS_Edge line =
        BRepBuilderAPI_MakeEdge(toPnt(p.point + from_ * p.normal), toPnt(p.point + to_ * p.normal));
    const double turn = edge_.last() - edge_.first();
    const TopoDS_Shape face = BRepPrimAPI_MakeRevol(line, circle.Axis(), turn).Shape();
    return face.IsNull() ? TopoDS_Face() : TopoDS::Face(face);
  }

  TopoDS_Face ruled() const {
    const TopoDS_Edge low = edgeAt(from_);
    const TopoDS_Edge high = edgeAt(to_);
    if (low.IsNull() || high.IsNull()) return {};
    return BRepFill::Face(low, high);
  }

  /// The edge moved by h along the normals, over the same parameters.
  [[nodiscard]] TopoDS_Edge edgeAt(double h) const {
    if (h == 0) {
      double first = 0;
      double last = 0;
      const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge_.edge(), first, last);
      return curve.IsNull() ? TopoDS_Edge() : BRepBuilderAPI_MakeEdge(curve, first, last).Edge();
    }
    double first = 0;
    double last = 0;
    const Handle(Geom2d_Curve) pcurve =
        BRep_Tool::CurveOnSurface(edge_.edge(), edge_.face(), first, last);
    const double side = edge_.face().Orientation() == TopAbs_REVERSED ? -h : h;
    const Handle(Geom_OffsetSurface) offset =
        new Geom_OffsetSurface(BRep_Tool::Surface(edge_.face()), side);
    const Handle(Adaptor3d_CurveOnSurface) curve = new Adaptor3d_CurveOnSurface(
        new Geom2dAdaptor_Curve(pcurve, first, last), new GeomAdaptor_Surface(offset));
    const Approx_Curve3d fit(curve, tolerance_, GeomAbs_C1, kMostPieces, kDegree);
    if (!fit.HasResult() || fit.MaxError() > 10 * tolerance_) return {};
    return BRepBuilderAPI_MakeEdge(fit.Curve(), first, last);
  }

  const FreeEdge& edge_;
  double from_;
  double to_;
  double tolerance_;
  std::vector<BorderPoint> samples_;
};

/// Flat sector of radius `height` about the end of a ridge, on the side where it is convex.
TopoDS_Face sector(const RidgeEnd& end, double height) {
  const Vec3 n1 = end.convex ? end.normal1 : Vec3(-end.normal1);
  const Vec3 n2 = end.convex ? end.normal2 : Vec3(-end.normal2);
  const Vec3 axis = n1.cross(n2).normalized();
  const gp_Pnt centre = toPnt(end.point);
  const gp_Pnt from = toPnt(end.point + height * n1);
  const gp_Pnt to = toPnt(end.point + height * n2);
  const gp_Circ circle(gp_Ax2(centre, gp_Dir(toGpVec(axis)), gp_Dir(toGpVec(n1))), height);
  const TopoDS_Edge arc = BRepBuilderAPI_MakeEdge(circle, from, to);
  BRepBuilderAPI_MakeWire wire(BRepBuilderAPI_MakeEdge(centre, from), arc,
                               BRepBuilderAPI_MakeEdge(to, centre));
  if (!wire.IsDone()) return {};
  BRepBuilderAPI_MakeFace face(gp_Pln(centre, gp_Dir(toGpVec(axis))), wire.Wire(), true);
  return face.IsDone() ? face.Face() : TopoDS_Face();
}

}  // namespace

Result<std::vector<TopoDS_Face>> sheetWalls(const FreeBorder& border, const ShellWalls& walls,
                                            double tolerance) {
  std::vector<TopoDS_Face> faces;
  // Where walls of different faces meet at a ridge they part at the sheet itself.
  std::vector<std::pair<double, double>> strips{{-walls.inner, walls.outer}};
  if (!border.ridgeEnds().empty() && walls.inner > 0 && walls.outer > 0)
    strips = {{-walls.inner, 0}, {0, walls.outer}};
  for (const FreeEdge& edge : border.edges()) {
    for (const auto& [from, to] : strips) {
      const TopoDS_Face wall = WallBuilder(edge, from, to, tolerance).build();
      if (wall.IsNull()) return fail(ErrorCode::Failed, "a free edge of the sheet gets no wall");
      faces.push_back(wall);
    }
  }
  for (const RidgeEnd& end : border.ridgeEnds()) {
    const double height = end.convex ? walls.outer : walls.inner;
    if (height == 0) continue;
    const TopoDS_Face face = sector(end, height);
    if (face.IsNull()) return fail(ErrorCode::Failed, "the end of an edge gets no sector");
    faces.push_back(face);
  }
  return faces;
}

}  // namespace phront::cad
