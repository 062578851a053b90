// The foot of x is the vertex V when x - V lies in the normal cone of V, the polar of the cone of
// tangent directions: n.e <= 0 for every edge direction e that leaves V (Rossignac & Requicha 1986;
// do Carmo for the polar). On the sphere that is a convex polygon of great-circle arcs. At a convex
// vertex its arcs are the ends of the pipes; at a mixed vertex a part of some of them. A polygon
// whose sides are not covered by pipe ends stems from the wrong side and is none.
// The axis of the sphere lies across the middle of the patch and the seam opposite to it.
// Where all edges are convex the ends of their pipes close a loop by themselves; that loop is taken
// as it is, since in loosely made models edge directions and face normals disagree by more than any
// fine angular tolerance.
// Poles that open give the loop sides of their own. Weak spot: where one is at a mixed vertex there
// is no patch.
#include "patches/sphere_patch.h"
#include "exchange/tolerances.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <ElSLib.hxx>
#include <Geom_Curve.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax3.hxx>

namespace phront::cad {
namespace {

/// Interpolation points of a parameter curve: a cubic through them stays within 1e-8 of the radius
/// on a quarter circle.
constexpr int kArcPoints = 81;
constexpr double kHalfTurn = 0.1;  // rad: arcs this near to half a turn need their axis

struct Ray {
  gp_Vec direction;  ///< unit, away from the vertex
  bool smooth = false;
  bool pipe = false;
  gp_Vec n1;
  gp_Vec n2;
  int face1 = -1;
  int face2 = -1;
  double angle = 0;  ///< rad, > 0 where convex
  int edge = -1;
  gp_Vec axis;  ///< about which n1 turns to n2
};

/// One side of a patch: a great-circle arc, or the edge given.
struct Side {
  TopoDS_Vertex from;
  TopoDS_Vertex to;
  TopoDS_Edge edge;
};

/// Outline of a patch: its sides, counter-clockwise seen from outside, and directions of points
/// along them.
struct Outline {
  std::vector<Side> sides;
  std::vector<gp_Vec> directions;
};

std::vector<Ray> raysAt(const EdgeTable& table, const std::vector<int>& edges, int vertex) {
  std::vector<Ray> rays;
  for (const int e : edges) {
    const EdgeInfo& info = table.edges[static_cast<std::size_t>(e)];
    if (info.samples.empty()) continue;
    TopoDS_Vertex first;
    TopoDS_Vertex last;
    TopExp::Vertices(info.edge, first, last);
    for (const bool atFirst : {true, false}) {
      const TopoDS_Vertex& end = atFirst ? first : last;
      if (table.vertexIndex.FindIndex(end) - 1 != vertex) continue;
      const EdgeSample& s = atFirst ? info.samples.front() : info.samples.back();
      rays.push_back({atFirst ? s.tangent : s.tangent.Reversed(), info.smooth, info.pipe, s.n1,
                      s.n2, info.face1, info.face2, s.angle, e, s.axis()});
    }
  }
  return rays;
}

/// Corners of the polygon {n : n.e <= 0}, in order about their mean; fewer than three: no polygon.
std::vector<gp_Vec> polarPolygon(const std::vector<Ray>& rays) {
  std::vector<gp_Vec> corners;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t j = i + 1; j < rays.size(); ++j) {
      gp_Vec n = rays[i].direction.Crossed(rays[j].direction);
      if (rays[i].smooth || rays[j].smooth || n.Magnitude() < kAngularTolerance) continue;
      n.Normalize();
      for (const gp_Vec& candidate : {n, n.Reversed()}) {
        const bool inside = std::all_of(rays.begin(), rays.end(), [&](const Ray& r) {
          return candidate.Dot(r.direction) <= kAngularTolerance;
        });
        const bool known = std::any_of(corners.begin(), corners.end(), [&](const gp_Vec& c) {
          return (c - candidate).Magnitude() < 10 * kAngularTolerance;
        });
        if (inside && !known) corners.push_back(candidate);
      }
    }
  }
  if (corners.size() < 3) return {};
  gp_Vec mean(0, 0, 0);
  for (const gp_Vec& c : corners) mean += c;
  if (mean.Magnitude() < kAngularTolerance) return {};
  mean.Normalize();
  const gp_Vec x = mean.Crossed(corners[0].Crossed(mean)).Normalized();
  const gp_Vec y = mean.Crossed(x);
  std::stable_sort(corners.begin(), corners.end(), [&](const gp_Vec& a, const gp_Vec& b) {
    return std::atan2(a.Dot(y), a.Dot(x)) < std::atan2(b.Dot(y), b.Dot(x));
  });
  return corners;
}

double twiceArea(const std::vector<gp_Vec>& corners, const gp_Vec& axis) {
  gp_Vec sum(0, 0, 0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sum += corners[i].Crossed(corners[(i + 1) % corners.size()]);
  }
  return sum.Dot(axis);
}

/// Points along a side, its end left out.
std::vector<gp_Vec> directionsOf(const Side& side, const gp_Pnt& centre) {
  constexpr int kParts = 8;
  if (side.edge.IsNull()) return {gp_Vec(centre, BRep_Tool::Pnt(side.from)).Normalized()};
  double first = 0;
  double last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(side.edge, first, last);
  if (!TopExp::FirstVertex(side.edge).IsSame(side.from)) std::swap(first, last);
  std::vector<gp_Vec> directions;
  for (int i = 0; i < kParts; ++i)
    directions.push_back(
        gp_Vec(centre, curve->Value(first + (last - first) * i / kParts)).Normalized());
  return directions;
}

/// The end of the pipe of a knife's edge is half a circle, which its ends do not tell from the
/// other half. Null where they tell.
TopoDS_Edge halfCircle(const Ray& ray, const Side& side, const gp_Pnt& centre, double radius,
                       ArcPool& arcs) {
  const gp_Vec from(centre, BRep_Tool::Pnt(side.from));
  const gp_Vec to(centre, BRep_Tool::Pnt(side.to));
  if (from.Angle(to) < M_PI - kHalfTurn) return {};
  return arcs.arc(centre, ray.axis, radius, side.from, side.to);
}

/// The loop that the pipe ends of a convex vertex make, with what poles there have opened into;
/// empty when they make none.
Outline chainedOutline(const std::vector<Ray>& rays, const VertexImages& images, int vertex,
                       const std::vector<TopoDS_Edge>& opened, const gp_Pnt& centre, double radius,
                       ArcPool& arcs) {
  std::vector<Side> sides;
  for (const Ray& ray : rays) {
    Side side{
        images.image(vertex, ray.face1, ray.edge), images.image(vertex, ray.face2, ray.edge), {}};
    if (side.from.IsNull() || side.to.IsNull()) return {};
    if (side.from.IsSame(side.to)) continue;
    if (!ray.pipe || !(ray.angle > 0)) return {};
    side.edge = halfCircle(ray, side, centre, radius, arcs);
    sides.push_back(side);
  }
  for (const TopoDS_Edge& edge : opened)
    sides.push_back({TopExp::FirstVertex(edge), TopExp::LastVertex(edge), edge});
  if (sides.size() < (opened.empty() ? 3U : 2U)) return {};
  Outline outline;
  const TopoDS_Vertex start = sides.front().from;
  TopoDS_Vertex end = start;
  std::vector<char> used(sides.size(), 0);
  for (std::size_t step = 0; step < sides.size(); ++step) {
    std::size_t next = sides.size();
    for (std::size_t i = 0; i < sides.size() && next == sides.size(); ++i) {
      if (!used[i] && (sides[i].from.IsSame(end) || sides[i].to.IsSame(end))) next = i;
    }
    if (next == sides.size()) return {};
    used[next] = 1;
    Side side = sides[next];
    if (!side.from.IsSame(end)) std::swap(side.from, side.to);
    end = side.to;
    outline.sides.push_back(side);
  }
  if (!end.IsSame(start)) return {};
  const auto gather = [&] {
    outline.directions.clear();
    for (const Side& side : outline.sides) {
      const std::vector<gp_Vec> along = directionsOf(side, centre);
      outline.directions.insert(outline.directions.end(), along.begin(), along.end());
    }
  };
  gather();
  gp_Vec mean(0, 0, 0);
  for (const gp_Vec& c : outline.directions) mean += c;
  if (twiceArea(outline.directions, mean) < 0) {
    std::reverse(outline.sides.begin(), outline.sides.end());
    for (Side& side : outline.sides) std::swap(side.from, side.to);
    gather();
  }
  return outline;
}

/// The pipe edge on whose end the side from a to b lies.
const Ray* rayOfSide(const std::vector<Ray>& rays, const gp_Vec& a, const gp_Vec& b) {
  const gp_Vec middle = (a + b).Normalized();
  for (const Ray& ray : rays) {
    if (!ray.pipe || std::abs(ray.direction.Dot(middle)) > 10 * kAngularTolerance ||
        std::abs(ray.direction.Dot(a)) > 10 * kAngularTolerance) {
      continue;
    }
    const double whole = ray.n1.Angle(ray.n2);
    const double parts = ray.n1.Angle(middle) + middle.Angle(ray.n2);
    if (parts < whole + 1e-4) return &ray;  // on the arc from n1 to n2
  }
  return nullptr;
}

/// The image of a face there, else a new vertex.
TopoDS_Vertex cornerVertex(const std::vector<Ray>& rays, const VertexImages& images, int vertex,
                           const gp_Pnt& centre, const gp_Vec& direction, double radius) {
  const gp_Pnt point = centre.Translated(direction * radius);
  for (const Ray& ray : rays) {
    for (const int f : {ray.face1, ray.face2}) {
      const TopoDS_Vertex image = images.image(vertex, f, ray.edge);
      if (!image.IsNull() &&
          BRep_Tool::Pnt(image).Distance(point) <
              std::max(2 * BRep_Tool::Tolerance(image), 10 * kAngularTolerance * radius)) {
        return image;
      }
    }
  }
  return makeVertex(point, Precision::Confusion());
}

/// Frame with the patch round u = pi, v = 0 and as little latitude as possible.
gp_Ax3 patchFrame(const gp_Pnt& centre, const std::vector<gp_Vec>& corners) {
  gp_Vec mean(0, 0, 0);
  for (const gp_Vec& c : corners) mean += c;
  const gp_Dir middle(mean);
  const gp_Ax3 start(centre, middle);
  gp_Dir best = start.XDirection();
  double bestLatitude = 2;
  constexpr int kTurns = 12;
  for (int i = 0; i < kTurns; ++i) {
    const double angle = M_PI * i / kTurns;
    const gp_Vec axis =
        gp_Vec(start.XDirection()) * std::cos(angle) + gp_Vec(start.YDirection()) * std::sin(angle);
    double latitude = 0;
    for (const gp_Vec& c : corners) latitude = std::max(latitude, std::abs(c.Dot(axis)));
    if (latitude < bestLatitude - 1e-9) {
      bestLatitude = latitude;
      best = gp_Dir(axis);
    }
  }
  return {centre, best, middle.Reversed()};
}

void addSphereCurve(const TopoDS_Edge& edge, const TopoDS_Face& face,
                    const Handle(Geom_SphericalSurface) & sphere) {
  double first = 0;
  double last = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  std::vector<gp_Pnt2d> points;
  std::vector<double> parameters;
  for (int i = 0; i < kArcPoints; ++i) {
    const double t = first + (last - first) * i / (kArcPoints - 1);
    double u = 0;
    double v = 0;
    ElSLib::Parameters(sphere->Sphere(), curve->Value(t), u, v);
    points.emplace_back(u, v);
    parameters.push_back(t);
  }
  const BRep_Builder builder;
  builder.UpdateEdge(edge, pcurveThrough(points, parameters), face, Precision::Confusion());
  builder.Range(edge, face, first, last);
  raiseTolerance(edge, face);
}

/// The outline where edges of both kinds meet; empty when no pipes lie along it.
Outline polarOutline(const std::vector<Ray>& rays, const VertexImages& images, int vertex,
                     const gp_Pnt& centre, double radius) {
  Outline outline;
  outline.directions = polarPolygon(rays);
  const std::vector<gp_Vec>& corners = outline.directions;
  std::vector<TopoDS_Vertex> vertices;
  for (const gp_Vec& corner : corners)
    vertices.push_back(cornerVertex(rays, images, vertex, centre, corner, radius));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t j = (i + 1) % corners.size();
    if (vertices[i].IsSame(vertices[j])) continue;
    if (rayOfSide(rays, corners[i], corners[j]) == nullptr) return {};
    outline.sides.push_back({vertices[i], vertices[j], {}});
  }
  return outline;
}

}  // namespace

TopoDS_Face spherePatch(const EdgeTable& table, const std::vector<int>& edges,
                        const VertexImages& images, int vertex,
                        const std::vector<TopoDS_Edge>& opened, double radius, double tolerance,
                        ArcPool& arcs) {
  const std::vector<Ray> rays = raysAt(table, edges, vertex);
  const gp_Pnt centre = BRep_Tool::Pnt(TopoDS::Vertex(table.vertexIndex(vertex + 1)));
  Outline outline = chainedOutline(rays, images, vertex, opened, centre, radius, arcs);
  if (outline.sides.empty()) outline = polarOutline(rays, images, vertex, centre, radius);
  const std::vector<gp_Vec>& directions = outline.directions;
  if (directions.size() < 3) return {};

  // Width of the polygon: twice the area over the perimeter, as a length.
  gp_Vec mean(0, 0, 0);
  double perimeter = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    mean += directions[i];
    perimeter += (directions[i] - directions[(i + 1) % directions.size()]).Magnitude();
  }
  if (mean.Magnitude() < kAngularTolerance) return {};
  if (radius * twiceArea(directions, mean.Normalized()) < tolerance * perimeter) return {};

  const Handle(Geom_SphericalSurface) sphere =
      new Geom_SphericalSurface(patchFrame(centre, directions), radius);
  const BRep_Builder builder;
  TopoDS_Face face;
  builder.MakeFace(face, sphere, Precision::Confusion());
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  for (const Side& side : outline.sides) {
    TopoDS_Edge edge = side.edge;
    if (edge.IsNull()) {
      const gp_Vec from(centre, BRep_Tool::Pnt(side.from));
      const gp_Vec to(centre, BRep_Tool::Pnt(side.to));
      edge = arcs.arc(centre, from.Crossed(to), radius, side.from, side.to);
    }
    addSphereCurve(edge, face, sphere);
    // Counter-clockwise seen along the outward normal: a forward wire on the sphere.
    const bool forward = TopExp::FirstVertex(edge).IsSame(side.from);
    builder.Add(wire, edge.Oriented(forward ? TopAbs_FORWARD : TopAbs_REVERSED));
  }
  wire.Closed(Standard_True);
  builder.Add(face, wire);
  BRepTools::Update(face);
  return face;
}

}  // namespace phront::cad
