// The offset of a cone is a cone and that of a torus a torus, but where the face is nearer to its
// axis than |d| the image goes on through the apex to the other side of the axis: second nappe,
// inner part of a spindle. Points there have a nearer foot across the axis, so the image ends
// exactly at the apex. The other way round, the apex of a cone that is convex on the offset side
// opens into a circle, and the sphere round the apex closes it with a cap.
// Handled: faces that are rectangles in (u,v), which is what turning and drilling make. The radius
// about the axis, signed along the profile, decides: rho(v) for the face, rho'(v) for the image.
// Weak spot: faces of other outline are left to the plain image.
#include "patches/axis_trim.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Ax3.hxx>
#include <gp_Circ.hxx>
#include <gp_Cone.hxx>
#include <gp_Torus.hxx>

#include "patches/offset_face.h"

namespace phront::cad {
namespace {

constexpr double kParameterSlack = 1e-6;

enum Side { kLow, kRight, kHigh, kLeft };

/// The face as a rectangle: the edge on each side, or none where it is a pole.
struct Rectangle {
  double u0 = 0;
  double u1 = 0;
  double v0 = 0;
  double v1 = 0;
  std::array<int, 4> edge{-1, -1, -1, -1};
  std::array<bool, 4> degenerated{false, false, false, false};
  std::array<bool, 4> forward{true, true, true, true};  ///< edge runs towards growing u or v
};

std::optional<Rectangle> rectangleOf(const EdgeTable& table, const TopoDS_Face& face) {
  Rectangle r;
  BRepTools::UVBounds(face, r.u0, r.u1, r.v0, r.v1);
  const double slackU = kParameterSlack * std::max(1.0, r.u1 - r.u0);
  const double slackV = kParameterSlack * std::max(1.0, r.v1 - r.v0);
  int sides = 0;
  for (const TopoDS_Edge& edge : edgesOf(face)) {
    double first = 0;
    double last = 0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (curve.IsNull()) return std::nullopt;
    const gp_Pnt2d a = curve->Value(first);
    const gp_Pnt2d m = curve->Value((first + last) / 2);
    const gp_Pnt2d b = curve->Value(last);
    const auto on = [&](double (gp_Pnt2d::*coordinate)() const, double value, double slack) {
      return std::abs((a.*coordinate)() - value) < slack &&
             std::abs((m.*coordinate)() - value) < slack &&
             std::abs((b.*coordinate)() - value) < slack;
    };
    int side = -1;
    if (on(&gp_Pnt2d::Y, r.v0, slackV))
      side = kLow;
    else if (on(&gp_Pnt2d::Y, r.v1, slackV))
      side = kHigh;
    else if (on(&gp_Pnt2d::X, r.u1, slackU))
      side = kRight;
    else if (on(&gp_Pnt2d::X, r.u0, slackU))
      side = kLeft;
    if (side < 0 || r.edge[static_cast<std::size_t>(side)] >= 0) return std::nullopt;
    const auto s = static_cast<std::size_t>(side);
    r.edge[s] = table.edgeIndex.FindIndex(edge) - 1;
    r.degenerated[s] = BRep_Tool::Degenerated(edge);
    r.forward[s] = side == kLow || side == kHigh ? b.X() > a.X() : b.Y() > a.Y();
    ++sides;
  }
  if (sides != 4) return std::nullopt;
  return r;
}

/// A surface of revolution with a straight or circular profile: distance from the axis and height
/// at v, for the face itself and, with other numbers, for its image.
struct Profile {
  gp_Ax3 frame;  ///< origin on the axis; u turns from X to Y
  bool torus = false;
  double radius = 0;  ///< at v = 0 (cone), of the tube's centre (torus)
  double slope = 0;   ///< semi-angle (cone)
  double tube = 0;    ///< tube radius (torus)

  [[nodiscard]] double rho(double v) const {
    return torus ? radius + tube * std::cos(v) : radius + v * std::sin(slope);
  }
  [[nodiscard]] double height(double v) const {
    return torus ? tube * std::sin(v) : v * std::cos(slope);
  }
  [[nodiscard]] gp_Pnt point(double u, double v) const {
    const gp_Vec radial =
        gp_Vec(frame.XDirection()) * std::cos(u) + gp_Vec(frame.YDirection()) * std::sin(u);
    return frame.Location().Translated(radial * rho(v) + gp_Vec(frame.Direction()) * height(v));
  }
};

std::optional<Profile> profileOf(const BRepAdaptor_Surface& surface, double vMiddle) {
  Profile p;
  if (surface.GetType() == GeomAbs_Cone) {
    const gp_Cone cone = surface.Cone();
    p.frame = cone.Position();
    p.radius = cone.RefRadius();
    p.slope = cone.SemiAngle();
    if (p.rho(vMiddle) < 0) return std::nullopt;  // second nappe
  } else if (surface.GetType() == GeomAbs_Torus) {
    const gp_Torus torus = surface.Torus();
    p.frame = torus.Position();
    p.torus = true;
    p.radius = torus.MajorRadius();
    p.tube = torus.MinorRadius();
    if (p.rho(vMiddle) < 0) return std::nullopt;
  } else {
    return std::nullopt;
  }
  return p;
}

/// Profile of the image over the same v.
Profile offsetProfile(const Profile& p, double normalSign, double distance) {
  Profile image = p;
  if (p.torus) {
    image.tube = p.tube + normalSign * distance;
  } else {
    const double shift = normalSign * distance;
    image.radius = p.radius + shift * std::cos(p.slope);
    image.frame.SetLocation(
        p.frame.Location().Translated(gp_Vec(p.frame.Direction()) * (-shift * std::sin(p.slope))));
  }
  return image;
}

struct Range {
  double low = 0;
  double high = 0;
  bool poleLow = false;
  bool poleHigh = false;
};

/// Parts of [low, high] where the image is on the original side of the axis.
std::vector<Range> aliveRanges(const Profile& image, double low, double high) {
  std::vector<double> roots;
  if (image.torus) {
    if (image.tube > image.radius) {
      const double apex = std::acos(-image.radius / image.tube);
      for (int k = -2; k <= 2; ++k) {
        roots.push_back(2 * M_PI * k - apex);
        roots.push_back(2 * M_PI * k + apex);
      }
    }
  } else if (std::abs(std::sin(image.slope)) > Precision::Angular()) {
    roots.push_back(-image.radius / std::sin(image.slope));
  }
  std::vector<double> cuts{low, high};
  const double slack = kParameterSlack * std::max(1.0, high - low);
  const auto isRoot = [&](double v) {
    return std::any_of(roots.begin(), roots.end(),
                       [&](double root) { return std::abs(root - v) < slack; });
  };
  for (const double root : roots) {
    if (root > low + slack && root < high - slack) cuts.push_back(root);
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<Range> ranges;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (image.rho((cuts[i] + cuts[i + 1]) / 2) <= 0) continue;
    ranges.push_back({cuts[i], cuts[i + 1], isRoot(cuts[i]), isRoot(cuts[i + 1])});
  }
  return ranges;
}

Handle(Geom_Surface) surfaceOf(const Profile& image, double vReference, double& vShift) {
  vShift = 0;
  if (image.torus) return new Geom_ToroidalSurface(image.frame, image.radius, image.tube);
  // A cone's reference radius must not be negative: count v from inside the living part.
  gp_Ax3 frame = image.frame;
  frame.SetLocation(
      frame.Location().Translated(gp_Vec(frame.Direction()) * image.height(vReference)));
  vShift = -vReference;
  return new Geom_ConicalSurface(frame, image.slope, image.rho(vReference));
}

class Trimmer {
 public:
  Trimmer(const EdgeTable& table, int face, const VertexImages& vertices, double distance,
          double tolerance, const std::map<int, TopoDS_Edge>& known, ArcPool& arcs,
          PointPool& points)
      : table_(table),
        faceNumber_(face),
        face_(table.faces[static_cast<std::size_t>(face)]),
        vertices_(vertices),
        distance_(distance),
        tolerance_(tolerance),
        known_(known),
        arcs_(arcs),
        points_(points) {}

  std::optional<TrimmedImage> run() {
    const BRepAdaptor_Surface surface(face_, Standard_False);
    if (surface.GetType() != GeomAbs_Cone && surface.GetType() != GeomAbs_Torus) {
      return std::nullopt;
    }
    const std::optional<Rectangle> rectangle = rectangleOf(table_, face_);
    if (!rectangle) return std::nullopt;
    r_ = *rectangle;
    const double um = (r_.u0 + r_.u1) / 2;
    const double vm = (r_.v0 + r_.v1) / 2;
    const std::optional<Profile> profile = profileOf(surface, vm);
    const std::optional<gp_Vec> normal = outwardNormal(face_, gp_Pnt2d(um, vm));
    if (!profile || !normal || r_.u1 - r_.u0 > 2 * M_PI - kParameterSlack) return std::nullopt;
    original_ = *profile;
    image_ = offsetProfile(original_, normalSign(*normal, um, vm), distance_);
    if (image_.torus && image_.tube < tolerance_) return std::nullopt;

    const std::vector<Range> ranges = aliveRanges(image_, r_.v0, r_.v1);
    const bool whole = ranges.size() == 1 && !ranges[0].poleLow && !ranges[0].poleHigh &&
                       ranges[0].low == r_.v0 && ranges[0].high == r_.v1;
    const bool apex = r_.degenerated[kLow] || r_.degenerated[kHigh];
    if (whole && !apex) return std::nullopt;
    for (const Range& range : ranges) addFace(range);
    return result_;
  }

 private:
  /// +1 when the outward normal points away from the axis (cone) or from the tube's centre (torus).
  double normalSign(const gp_Vec& normal, double u, double v) const {
    const gp_Vec radial = gp_Vec(original_.frame.XDirection()) * std::cos(u) +
                          gp_Vec(original_.frame.YDirection()) * std::sin(u);
    const gp_Vec up(original_.frame.Direction());
    const gp_Vec away = original_.torus
                            ? radial * std::cos(v) + up * std::sin(v)
                            : radial * std::cos(original_.slope) - up * std::sin(original_.slope);
    return normal.Dot(away) > 0 ? 1 : -1;
  }

  TopoDS_Vertex corner(Side side, bool atRight, double v) {
    const gp_Pnt point = image_.point(atRight ? r_.u1 : r_.u0, v);
    // An original corner keeps the shared image of its vertex.
    const int e = r_.edge[static_cast<std::size_t>(side)];
    if (e >= 0 && !r_.degenerated[static_cast<std::size_t>(side)]) {
      TopoDS_Vertex ends[2];
      TopExp::Vertices(table_.edges[static_cast<std::size_t>(e)].edge, ends[0], ends[1]);
      for (const TopoDS_Vertex& end : ends) {
        const TopoDS_Vertex shared = vertices_.image(end, faceNumber_, e);
        if (!shared.IsNull() && BRep_Tool::Pnt(shared).Distance(point) <
                                    std::max(tolerance_, 2 * BRep_Tool::Tolerance(shared))) {
          return shared;
        }
      }
    }
    return points_.at(point, tolerance_);
  }

  /// Low or high side of a range: the known or a new circle, or a pole.
  PatchSide acrossSide(Side side, double v, bool pole, const TopoDS_Vertex& left,
                       const TopoDS_Vertex& right, double vShift) {
    const gp_Pnt2d a(r_.u0, v + vShift);
    const gp_Pnt2d b(r_.u1, v + vShift);
    if (pole) return {{}, a, b, true, left};
    const auto s = static_cast<std::size_t>(side);
    const int e = r_.edge[s];
    const bool original = e >= 0 && !r_.degenerated[s];
    const auto found = original ? known_.find(e) : known_.end();
    TopoDS_Edge edge;
    bool forward = true;
    if (found != known_.end()) {
      edge = found->second;
      forward = r_.forward[s];
    } else if (original) {
      // Same parameters as the edge it is the image of: pipes rely on it.
      edge = imageCircle(s, v, left, right);
      forward = r_.forward[s];
    } else {
      const gp_Vec up(image_.frame.Direction());
      const gp_Pnt centre = image_.frame.Location().Translated(up * image_.height(v));
      edge =
          arcs_.arc(centre, image_.frame.Direct() ? up : up.Reversed(), image_.rho(v), left, right);
      forward = TopExp::FirstVertex(edge).IsSame(left);
      openArcs_.push_back(edge);
    }
    if (original) result_.edges[e] = edge;
    return {edge, forward ? a : b, forward ? b : a, false, {}};
  }

  TopoDS_Edge imageCircle(std::size_t side, double v, const TopoDS_Vertex& left,
                          const TopoDS_Vertex& right) {
    double t0 = 0;
    double t1 = 0;
    BRep_Tool::Range(table_.edges[static_cast<std::size_t>(r_.edge[side])].edge, t0, t1);
    const bool forward = r_.forward[side];
    const gp_Vec up(image_.frame.Direction());
    const gp_Pnt centre = image_.frame.Location().Translated(up * image_.height(v));
    // At t0 the curve stands at u0 (forward) or at u1, turning the other way.
    const double uStart = forward ? r_.u0 : r_.u1;
    const double sense = forward ? 1 : -1;
    const double zero = uStart - sense * t0;
    const gp_Vec x = gp_Vec(image_.frame.XDirection()) * std::cos(zero) +
                     gp_Vec(image_.frame.YDirection()) * std::sin(zero);
    const gp_Vec turned = (image_.frame.Direct() ? up : up.Reversed()) * sense;
    const gp_Ax2 position(centre, gp_Dir(turned), gp_Dir(x));
    const BRep_Builder builder;
    TopoDS_Edge edge;
    builder.MakeEdge(edge, new Geom_Circle(position, image_.rho(v)), Precision::Confusion());
    builder.Add(edge, (forward ? left : right).Oriented(TopAbs_FORWARD));
    builder.Add(edge, (forward ? right : left).Oriented(TopAbs_REVERSED));
    builder.Range(edge, t0, t1);
    return edge;
  }

  /// Left or right side: the known edge, else a straight line (cone) or an arc of the tube (torus).
  /// Where the image ends at the axis, its side is only a part of what the neighbour has there.
  PatchSide alongSide(bool right, const Range& range, const TopoDS_Vertex& low,
                      const TopoDS_Vertex& high, double vShift) {
    const double u = right ? r_.u1 : r_.u0;
    const auto s = static_cast<std::size_t>(right ? kRight : kLeft);
    const int e = r_.edge[s];
    const bool whole = e >= 0 && range.low == r_.v0 && range.high == r_.v1;
    const auto found = whole ? known_.find(e) : known_.end();
    TopoDS_Edge edge;
    bool upward = r_.forward[s];
    if (found != known_.end()) {
      edge = found->second;
    } else {
      // The way of the edge it is the image of: neighbours and pipes rely on it.
      edge = upward ? newAlongSide(u, low, high, 1) : newAlongSide(u, high, low, -1);
      upward = TopExp::FirstVertex(edge).IsSame(low);
    }
    if (whole) result_.edges[e] = edge;
    const gp_Pnt2d a(u, range.low + vShift);
    const gp_Pnt2d b(u, range.high + vShift);
    return {edge, upward ? a : b, upward ? b : a, false, {}};
  }

  /// `sense`: +1 towards growing v, -1 the other way.
  TopoDS_Edge newAlongSide(double u, const TopoDS_Vertex& from, const TopoDS_Vertex& to,
                           double sense) {
    if (!image_.torus) return arcs_.line(from, to);
    const gp_Vec radial = gp_Vec(image_.frame.XDirection()) * std::cos(u) +
                          gp_Vec(image_.frame.YDirection()) * std::sin(u);
    const gp_Pnt centre = image_.frame.Location().Translated(radial * image_.radius);
    const gp_Vec axis = radial.Crossed(gp_Vec(image_.frame.Direction()));
    return arcs_.arc(centre, axis * sense, image_.tube, from, to);
  }

  void addFace(const Range& range) {
    double vShift = 0;
    const Handle(Geom_Surface) surface = surfaceOf(image_, (range.low + range.high) / 2, vShift);
    const auto poleAt = [&](double v) { return points_.at(image_.point(r_.u0, v), tolerance_); };
    const TopoDS_Vertex ll = range.poleLow ? poleAt(range.low) : corner(kLow, false, range.low);
    const TopoDS_Vertex lr = range.poleLow ? ll : corner(kLow, true, range.low);
    const TopoDS_Vertex hl = range.poleHigh ? poleAt(range.high) : corner(kHigh, false, range.high);
    const TopoDS_Vertex hr = range.poleHigh ? hl : corner(kHigh, true, range.high);
    openArcs_.clear();
    const std::vector<PatchSide> sides{
        acrossSide(kLow, range.low, range.poleLow, ll, lr, vShift),
        alongSide(true, range, lr, hr, vShift),
        acrossSide(kHigh, range.high, range.poleHigh, hl, hr, vShift),
        alongSide(false, range, ll, hl, vShift)};
    result_.faces.push_back(faceFromSides(surface, sides, Precision::Confusion()));
    for (const TopoDS_Edge& arc : openArcs_) addCap(arc);
  }

  /// Piece of the sphere round the apex above an opened arc.
  void addCap(const TopoDS_Edge& arc) {
    const double vApex = r_.degenerated[kLow] ? r_.v0 : r_.v1;
    const gp_Pnt apex = original_.point(r_.u0, vApex);
    const double rho = image_.rho(vApex);
    const gp_Vec toCircle(apex, image_.frame.Location().Translated(
                                    gp_Vec(image_.frame.Direction()) * image_.height(vApex)));
    const gp_Vec up = gp_Vec(image_.frame.Direction()) *
                      (toCircle.Dot(gp_Vec(image_.frame.Direction())) > 0 ? 1 : -1);
    const double radius = std::abs(distance_);
    const double latitude = std::acos(std::min(1.0, rho / radius));
    double t0 = 0;
    double t1 = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(arc, t0, t1);
    const gp_Ax3 frame(apex, gp_Dir(up),
                       gp_Dir(gp_Vec(apex, curve->Value((t0 + t1) / 2)).Reversed()));
    const Handle(Geom_SphericalSurface) sphere = new Geom_SphericalSurface(frame, radius);
    const TopoDS_Vertex pole = points_.at(apex.Translated(up * radius), tolerance_);
    const TopoDS_Vertex first = TopExp::FirstVertex(arc);
    const TopoDS_Vertex last = TopExp::LastVertex(arc);
    const Handle(Geom_Circle) circle = Handle(Geom_Circle)::DownCast(curve);
    const double sense = gp_Vec(circle->Axis().Direction()).Dot(up) > 0 ? 1 : -1;
    const double half = (t1 - t0) / 2;
    const double ua = M_PI - sense * half;
    const double ub = M_PI + sense * half;
    const auto meridian = [&](const TopoDS_Vertex& vertex, double u) -> PatchSide {
      const gp_Vec out(apex, BRep_Tool::Pnt(vertex));
      const TopoDS_Edge edge = arcs_.arc(apex, out.Crossed(up), radius, vertex, pole);
      const bool upward = TopExp::FirstVertex(edge).IsSame(vertex);
      const gp_Pnt2d a(u, latitude);
      const gp_Pnt2d b(u, M_PI / 2);
      return {edge, upward ? a : b, upward ? b : a, false, {}};
    };
    const std::vector<PatchSide> sides{
        {arc, gp_Pnt2d(ua, latitude), gp_Pnt2d(ub, latitude), false, {}},
        meridian(last, ub),
        {{}, gp_Pnt2d(ua, M_PI / 2), gp_Pnt2d(ub, M_PI / 2), true, pole},
        meridian(first, ua)};
    result_.caps.push_back(faceFromSides(sphere, sides, Precision::Confusion()));
  }

  const EdgeTable& table_;
  int faceNumber_;
  TopoDS_Face face_;
  const VertexImages& vertices_;
  double distance_;
  double tolerance_;
  const std::map<int, TopoDS_Edge>& known_;
  ArcPool& arcs_;
  PointPool& points_;
  Rectangle r_;
  Profile original_;
  Profile image_;
  std::vector<TopoDS_Edge> openArcs_;
  TrimmedImage result_;
};

}  // namespace

std::optional<TrimmedImage> trimAtAxis(const EdgeTable& table, int face,
                                       const VertexImages& vertices, double distance,
                                       double tolerance, const std::map<int, TopoDS_Edge>& known,
                                       ArcPool& arcs, PointPool& points) {
  return Trimmer(table, face, vertices, distance, tolerance, known, arcs, points).run();
}

}  // namespace phront::cad
