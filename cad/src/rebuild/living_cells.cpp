// Where a live part of a patch ends, a second patch is live too: the point has two feet, and both
// patches pass through it. So only crossings on the level matter, and a pair of patches has none
// unless a living cell of one meets a living cell of the other. Cells die by the 1-Lipschitz bound.
// Neighbours by construction are tangent along their shared edge, where intersecting them is slow
// and ill-conditioned. Near it they hardly ever cross on the level: that would be a ridge within
// |d| of a smooth front (seen where a pipe turns back into itself). Cells away from the edge tell
// whether they come together once more elsewhere. Weak spot: cells are boxes of sampled points with
// a margin; a patch that bulges out of it between the samples could lose a crossing, which the
// check of the result would show.
#include "rebuild/living_cells.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

#include "patches/patch_tools.h"
#include "rebuild/surface_cells.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

// Cells of one patch, and the reach in |d| below which a cell is not divided further.
constexpr std::size_t kMostCells = 192;
constexpr double kSmallReach = 0.1;
constexpr int kEdgePoints = 65;
// Cells within this many |d| of a shared edge are near it. Larger values save time and lose
// crossings of short patches.
constexpr double kNearEdge = 0.3;

/// What a cell may reach, bulges included.
double reachOf(const SurfaceCell& cell) { return (1 + kBulge) * cell.reach; }

Box3 boxOf(const SurfaceCell& cell) { return grown(cell.box, kBulge * reachOf(cell)); }

/// The largest cells are divided first; what is proven dead goes.
std::vector<Box3> livingCells(const TopoDS_Face& face, double distance, double tolerance,
                              const TrueDistance& phi) {
  const BRepAdaptor_Surface surface(face, Standard_False);
  const double error = phi.tessellation().measuredDeflection + tolerance;
  const auto dead = [&](const SurfaceCell& cell) {
    const FootPoint foot = phi.surface().foot(cell.centre);
    return std::abs(std::abs(foot.distance) - std::abs(distance)) > reachOf(cell) + 2 * error;
  };
  double u0 = 0;
  double u1 = 0;
  double v0 = 0;
  double v1 = 0;
  BRepTools::UVBounds(face, u0, u1, v0, v1);
  std::priority_queue<SurfaceCell> open;
  std::vector<Box3> done;
  const SurfaceCell whole = surfaceCell(surface, u0, u1, v0, v1);
  if (!dead(whole)) open.push(whole);
  while (!open.empty() && open.size() + done.size() < kMostCells) {
    const SurfaceCell cell = open.top();
    open.pop();
    if (reachOf(cell) < kSmallReach * std::abs(distance)) {
      done.push_back(boxOf(cell));
      continue;
    }
    for (const SurfaceCell& half : halves(surface, cell)) {
      if (!dead(half)) open.push(half);
    }
  }
  for (; !open.empty(); open.pop()) done.push_back(boxOf(open.top()));
  return done;
}

/// Points along the edges that both faces use, and how far apart they lie.
std::vector<std::pair<Vec3, double>> sharedPoints(const TopoDS_Face& a, const TopoDS_Face& b) {
  std::vector<std::pair<Vec3, double>> points;
  const std::vector<TopoDS_Edge> edges = edgesOf(b);
  for (const TopoDS_Edge& edge : edgesOf(a)) {
    if (BRep_Tool::Degenerated(edge)) continue;
    if (std::none_of(edges.begin(), edges.end(),
                     [&](const TopoDS_Edge& other) { return other.IsSame(edge); })) {
      continue;
    }
    const BRepAdaptor_Curve curve(edge);
    const double t0 = curve.FirstParameter();
    const double t1 = curve.LastParameter();
    std::vector<Vec3> along;
    double step = 0;
    for (int i = 0; i < kEdgePoints; ++i) {
      along.push_back(toVec3(curve.Value(t0 + (t1 - t0) * i / (kEdgePoints - 1)).XYZ()));
      if (i > 0) step = std::max(step, (along[i] - along[i - 1]).norm());
    }
    for (const Vec3& p : along) points.emplace_back(p, step);
  }
  return points;
}

}  // namespace

LivingCells::LivingCells(const std::vector<TopoDS_Face>& patches, double distance, double tolerance,
                         const TrueDistance& phi)
    : near_(kNearEdge * std::abs(distance)) {
  for (const TopoDS_Face& face : patches) {
    Patch patch{face, livingCells(face, distance, tolerance, phi), {}};
    for (const Box3& cell : patch.cells) patch.box.extend(cell);
    patches_.push_back(std::move(patch));
  }
}

bool LivingCells::mayCross(std::size_t first, std::size_t second) const {
  const Patch& a = patches_[first];
  const Patch& b = patches_[second];
  if (!a.box.intersects(b.box)) return false;
  const auto shared = sharedPoints(a.face, b.face);
  const auto nearShared = [&](const Box3& cell) {
    return std::any_of(shared.begin(), shared.end(), [&](const auto& p) {
      return cell.exteriorDistance(p.first) <= std::max(p.second, near_);
    });
  };
  std::vector<char> atEdge;
  for (const Box3& cell : b.cells) atEdge.push_back(!shared.empty() && nearShared(cell));
  for (const Box3& cell : a.cells) {
    if (!cell.intersects(b.box)) continue;
    const bool here = !shared.empty() && nearShared(cell);
    for (std::size_t j = 0; j < b.cells.size(); ++j) {
      if ((!here || !atEdge[j]) && cell.intersects(b.cells[j])) return true;
    }
  }
  return false;
}

bool LivingCells::mayMeet(std::size_t first, std::size_t second) const {
  const Patch& a = patches_[first];
  const Patch& b = patches_[second];
  return a.box.intersects(b.box) &&
         std::any_of(a.cells.begin(), a.cells.end(), [&](const Box3& cell) {
           return std::any_of(b.cells.begin(), b.cells.end(),
                              [&](const Box3& other) { return cell.intersects(other); });
         });
}

}  // namespace phront::cad
