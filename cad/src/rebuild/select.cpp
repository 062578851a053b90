// After the split a piece lies on the offset wholly or not at all, so points inside it decide, by
// distance alone: no orientation, no winding, hence no special case when topology changes. Several
// points and their median guard against a point in a corner where the tolerance is used up.
//
// Patches that cannot be live anywhere are found without intersecting anything: distance is
// 1-Lipschitz, so a parameter cell whose centre is nearer to the input than |d| by more than the
// cell's reach is dead. Weak spot: patches that touch the level tangentially are never proven dead.
#include "rebuild/select.h"

#include <BOPTools_AlgoTools3D.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <Geom2d_Line.hxx>
#include <IntTools_Context.hxx>
#include <Precision.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

#include "patches/patch_tools.h"
#include "rebuild/edge_uses.h"

namespace phront::cad {
namespace {

constexpr int kMaxSamples = 5;
constexpr int kLeastGrid = 10;
constexpr int kMostGrid = 48;
/// Queries spent on proving one patch dead.
constexpr int kMaxQueries = 160;

Vec3 toVec(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void addSample(const TopoDS_Face& face, const gp_Pnt& point, const gp_Pnt2d& uv,
               std::vector<FaceSample>& samples) {
  if (const std::optional<gp_Vec> normal = outwardNormal(face, uv)) {
    samples.push_back({point, *normal});
  }
}

}  // namespace

std::vector<FaceSample> interiorSamples(const TopoDS_Face& face) {
  std::vector<FaceSample> samples;
  const Handle(IntTools_Context) context = new IntTools_Context;
  gp_Pnt point;
  gp_Pnt2d uv;
  if (BOPTools_AlgoTools3D::PointInFace(face, point, uv, context) == 0) {
    addSample(face, point, uv, samples);
  }
  double u0 = 0;
  double u1 = 0;
  double v0 = 0;
  double v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  for (const double share : {0.31, 0.67}) {
    const Handle(Geom2d_Curve) alongV =
        new Geom2d_Line(gp_Pnt2d(u0 + share * (u1 - u0), v0), gp_Dir2d(0, 1));
    const Handle(Geom2d_Curve) alongU =
        new Geom2d_Line(gp_Pnt2d(u0, v0 + share * (v1 - v0)), gp_Dir2d(1, 0));
    for (const Handle(Geom2d_Curve) & line : {alongV, alongU}) {
      if (static_cast<int>(samples.size()) < kMaxSamples &&
          BOPTools_AlgoTools3D::PointInFace(face, line, point, uv, context) == 0) {
        addSample(face, point, uv, samples);
      }
    }
  }
  return samples;
}

std::vector<gp_Pnt2d> gridInside(const TopoDS_Face& face, double pitch) {
  const BRepAdaptor_Surface surface(face, Standard_False);
  const BRepTopAdaptor_FClass2d inside(face, Precision::PConfusion());
  double u0 = 0;
  double u1 = 0;
  double v0 = 0;
  double v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  gp_Pnt p;
  gp_Vec du;
  gp_Vec dv;
  surface.D1((u0 + u1) / 2, (v0 + v1) / 2, p, du, dv);
  const auto cells = [&](double length) {
    return static_cast<int>(std::clamp(length / pitch, double(kLeastGrid), double(kMostGrid)));
  };
  const int nu = cells((u1 - u0) * du.Magnitude());
  const int nv = cells((v1 - v0) * dv.Magnitude());
  std::vector<gp_Pnt2d> points;
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      const gp_Pnt2d uv(u0 + (u1 - u0) * (i + 0.5) / nu, v0 + (v1 - v0) * (j + 0.5) / nv);
      if (inside.Perform(uv) == TopAbs_IN) points.push_back(uv);
    }
  }
  return points;
}

std::vector<JudgedFace> judgeFaces(const std::vector<TopoDS_Face>& faces, bool solid,
                                   double distance, double tolerance, const TrueDistance& phi) {
  std::vector<JudgedFace> judged;
  judged.reserve(faces.size());
  for (const TopoDS_Face& face : faces) {
    JudgedFace j;
    j.face = face;
    j.samples = interiorSamples(face);
    std::vector<double> deviations;
    std::vector<double> levels;
    for (const FaceSample& s : j.samples) {
      const TrueDistance::Foot foot = phi.foot(toVec(s.point));
      const double level = foot.sign * foot.distance;
      const bool beyond = !solid && foot.beyondBorder;
      deviations.push_back(beyond ? std::abs(distance) : std::abs(level - distance));
      levels.push_back(level);
    }
    if (!deviations.empty()) {
      const auto on = std::count_if(deviations.begin(), deviations.end(),
                                    [&](double deviation) { return deviation <= tolerance; });
      j.mixed = on > 0 && on < static_cast<std::ptrdiff_t>(deviations.size());
      j.deviation = median(deviations);
      j.largest = *std::max_element(deviations.begin(), deviations.end());
      j.level = median(levels);
      j.live = j.deviation <= tolerance;
    }
    judged.push_back(std::move(j));
  }
  return judged;
}

std::vector<TopoDS_Edge> openEdges(const std::vector<JudgedFace>& faces) {
  std::vector<TopoDS_Face> live;
  for (const JudgedFace& j : faces)
    if (j.live) live.push_back(j.face);
  const EdgeUses uses(live);
  std::vector<TopoDS_Edge> open;
  for (std::size_t e = 0; e < uses.faces.size(); ++e)
    if (uses.faces[e].size() != 2) open.push_back(uses.edge(e));
  return open;
}

bool facesOutward(const FaceSample& sample, const gp_Vec& normal, double step,
                  const TrueDistance& phi) {
  return phi.signedDistance(toVec(sample.point.Translated(normal * step))) >
         phi.signedDistance(toVec(sample.point.Translated(normal * -step)));
}

bool provenDead(const TopoDS_Face& face, double distance, double tolerance,
                const TrueDistance& phi) {
  const BRepAdaptor_Surface surface(face, Standard_False);
  struct Cell {
    double u0, u1, v0, v1;
  };
  Cell whole{};
  BRepTools::UVBounds(face, whole.u0, whole.u1, whole.v0, whole.v1);
  std::vector<Cell> open{whole};
  for (int queries = 0; !open.empty(); ++queries) {
    if (queries >= kMaxQueries) return false;
    const Cell c = open.back();
    open.pop_back();
    const double u = (c.u0 + c.u1) / 2;
    const double v = (c.v0 + c.v1) / 2;
    const gp_Pnt centre = surface.Value(u, v);
    // Reach of the cell from its centre, by its corners and side middles; a quarter more for what
    // bulges between them.
    double reach = 0;
    for (const double pu : {c.u0, u, c.u1}) {
      for (const double pv : {c.v0, v, c.v1}) {
        reach = std::max(reach, centre.Distance(surface.Value(pu, pv)));
      }
    }
    reach *= 1.25;
    const double slack = std::abs(distance) - std::abs(phi.signedDistance(toVec(centre)));
    if (slack > reach + tolerance) continue;
    if (slack <= tolerance) return false;  // live, or so near that it cannot be proven dead
    const double sizeU = surface.Value(c.u0, v).Distance(surface.Value(c.u1, v));
    const double sizeV = surface.Value(u, c.v0).Distance(surface.Value(u, c.v1));
    if (sizeU > sizeV) {
      open.push_back({c.u0, u, c.v0, c.v1});
      open.push_back({u, c.u1, c.v0, c.v1});
    } else {
      open.push_back({c.u0, c.u1, c.v0, v});
      open.push_back({c.u0, c.u1, v, c.v1});
    }
  }
  return true;
}

}  // namespace phront::cad
