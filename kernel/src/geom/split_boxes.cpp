// Faces with holes are triangulated by slivers from rim to rim, and the boxes of oblique slivers
// overlap all over the face: a query near it opens hundreds. Their boxes are cut, the worst first,
// at the middle of the longest side (Ernst & Greiner, "Early split clipping for bounding volume
// hierarchies", 2007), until what is left is ordinary or the boxes are twice as many. Weak spot:
// the measure of air is taken along the axes, so a part that stands askew keeps more of it.
#include "geom/split_boxes.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

namespace phront {

namespace {

// Cut where the air in a box is more than this many mean triangles: none of a regular mesh.
constexpr double kOrdinaryAir = 8;
constexpr std::size_t kSpareBoxes = 64;
// Boxes of pieces reach over the cut: of the largest coordinate, far more than a foot is rounded.
constexpr double kOverlap = 1e-12;

using Polygon = std::vector<Vec3>;

struct Piece {
  Polygon polygon;
  Index triangle = kNone;
};

Box3 boxOf(const Polygon& polygon) {
  Box3 box;
  for (const Vec3& p : polygon) box.extend(p);
  return box;
}

// Area of the shadows on the three coordinate planes.
double shadow(const Polygon& polygon) {
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i)
    normal += (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]);
  return normal.cwiseAbs().sum() / 2;
}

double air(const Polygon& polygon) {
  const Vec3 s = boxOf(polygon).sizes();
  return s[0] * s[1] + s[1] * s[2] + s[2] * s[0] - shadow(polygon);
}

std::pair<Polygon, Polygon> cut(const Polygon& polygon, int axis, double at) {
  Polygon low;
  Polygon high;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& p = polygon[i];
    const Vec3& q = polygon[(i + 1) % polygon.size()];
    if (p[axis] <= at) low.push_back(p);
    if (p[axis] >= at) high.push_back(p);
    if ((p[axis] < at && q[axis] > at) || (p[axis] > at && q[axis] < at)) {
      Vec3 crossing = p + (at - p[axis]) / (q[axis] - p[axis]) * (q - p);
      crossing[axis] = at;
      low.push_back(crossing);
      high.push_back(crossing);
    }
  }
  return {low, high};
}

}  // namespace

TriangleBoxes splitBoxes(const TriMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<Piece> pieces(count);
  double shadows = 0;
  for (std::size_t t = 0; t < count; ++t) {
    pieces[t].triangle = static_cast<Index>(t);
    for (const Index p : mesh.triangles[t])
      pieces[t].polygon.push_back(mesh.points[static_cast<std::size_t>(p)]);
    shadows += shadow(pieces[t].polygon);
  }
  const double ordinary =
      kOrdinaryAir * shadows / static_cast<double>(std::max<std::size_t>(1, count));

  std::vector<std::pair<double, std::size_t>> heap;  // air, piece
  for (std::size_t t = 0; t < count; ++t) {
    const double a = air(pieces[t].polygon);
    if (a > ordinary) heap.emplace_back(a, t);
  }
  std::make_heap(heap.begin(), heap.end());
  const std::size_t most = 2 * count + kSpareBoxes;
  while (!heap.empty() && pieces.size() < most) {
    std::pop_heap(heap.begin(), heap.end());
    const std::size_t worst = heap.back().second;
    heap.pop_back();
    const Box3 box = boxOf(pieces[worst].polygon);
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    auto [low, high] = cut(pieces[worst].polygon, axis, box.center()[axis]);
    if (low.size() < 3 || high.size() < 3) continue;
    pieces.push_back({std::move(high), pieces[worst].triangle});
    pieces[worst].polygon = std::move(low);
    for (const std::size_t half : {worst, pieces.size() - 1}) {
      const double a = air(pieces[half].polygon);
      if (!(a > ordinary)) continue;
      heap.emplace_back(a, half);
      std::push_heap(heap.begin(), heap.end());
    }
  }

  TriangleBoxes cover;
  const bool whole = pieces.size() == count;
  for (const Piece& piece : pieces) {
    Box3 box = boxOf(piece.polygon);
    if (!whole) {
      const Vec3 margin =
          Vec3::Constant(kOverlap * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff());
      box = Box3(box.min() - margin, box.max() + margin);
    }
    cover.boxes.push_back(box);
    cover.triangle.push_back(piece.triangle);
  }
  return cover;
}

}  // namespace phront
