// Distance to a mesh and its winding number by plain loops over triangles: what fields are audited
// against. Nothing of the kernel is used but the mesh itself. Distances are taken in long double,
// so that what an audit finds is the error of the kernel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "phront/tri_mesh.h"

namespace phront::test {

using LongVec3 = Eigen::Matrix<long double, 3, 1>;

/// Distance of x to the segment from p to q, which may be a point.
inline long double segmentDistance(const LongVec3& p, const LongVec3& q, const LongVec3& x) {
  const LongVec3 e = q - p;
  const long double length = e.squaredNorm();
  const long double w = length > 0 ? std::clamp(e.dot(x - p) / length, 0.0L, 1.0L) : 0.0L;
  return (x - p - w * e).norm();
}

/// Distance of x to a triangle by the regions of Ericson ("Real-Time Collision Detection", 2005,
/// 5.1.5). A triangle without area is its three sides.
inline long double triangleDistance(const std::array<Vec3, 3>& corners, const Vec3& query) {
  const LongVec3 x = query.cast<long double>();
  const LongVec3 a = corners[0].cast<long double>();
  const LongVec3 b = corners[1].cast<long double>();
  const LongVec3 c = corners[2].cast<long double>();
  const LongVec3 ab = b - a;
  const LongVec3 ac = c - a;
  const long double d1 = ab.dot(x - a);
  const long double d2 = ac.dot(x - a);
  if (d1 <= 0 && d2 <= 0) return (x - a).norm();
  const long double d3 = ab.dot(x - b);
  const long double d4 = ac.dot(x - b);
  if (d3 >= 0 && d4 <= d3) return (x - b).norm();
  const long double d5 = ab.dot(x - c);
  const long double d6 = ac.dot(x - c);
  if (d6 >= 0 && d5 <= d6) return (x - c).norm();
  const long double va = d3 * d6 - d5 * d4;
  const long double vb = d5 * d2 - d1 * d6;
  const long double vc = d1 * d4 - d3 * d2;
  if (va > 0 && vb > 0 && vc > 0) {
    const LongVec3 normal = ab.cross(ac);
    return std::abs(normal.dot(x - a)) / normal.norm();
  }
  return std::min({segmentDistance(a, b, x), segmentDistance(b, c, x), segmentDistance(c, a, x)});
}

/// Every triangle lies in all cells of a uniform grid that its bounding box touches, so each of its
/// points lies in a cell that lists it. A point nearer to x than r cells lies at most r cells from
/// that of x along each axis: when the rings 0..r are searched and the least distance found is no
/// more than r cells, nothing nearer is left. Cells, and triangles by the balls around them, are
/// skipped when they are farther than the least distance found.
class ReferenceDistance {
 public:
  explicit ReferenceDistance(const TriMesh& mesh) : box_(boundingBox(mesh)) {
    for (const auto& t : mesh.triangles) {
      Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        triangle.corners[k] = mesh.points[static_cast<std::size_t>(t[k])];
      }
      const auto& c = triangle.corners;
      triangle.centre = (c[0] + c[1] + c[2]) / 3;
      for (const Vec3& p : c) {
        triangle.radius = std::max(triangle.radius, (p - triangle.centre).norm());
      }
      triangles_.push_back(triangle);
    }
    cell_ = box_.diagonal().norm() / kCellsPerDiagonal;
    for (int axis = 0; axis < 3; ++axis) count_[axis] = cellOf(box_.max())[axis] + 1;
    lists_.resize(static_cast<std::size_t>(count_.prod()));
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      Box3 bounds;
      for (const Vec3& p : triangles_[t].corners) bounds.extend(p);
      forCells(cellOf(bounds.min()), cellOf(bounds.max()),
               [&](const Cell& cell) { lists_[number(cell)].push_back(t); });
    }
  }

  /// Least distance over all triangles.
  [[nodiscard]] double distance(const Vec3& x) const {
    const Cell home = cellOf(x);
    long double least = std::numeric_limits<long double>::infinity();
    for (int ring = 0;; ++ring) {
      forRing(home, ring, [&](const Cell& cell) {
        if (gapTo(cell, x) > least) return;
        for (const std::size_t t : lists_[number(cell)]) least = lesser(least, triangles_[t], x);
      });
      // A millionth of a cell for the rounding of cell numbers.
      if (least <= (ring - 1e-6) * cell_) break;
      const Cell reach = home.cwiseMax(count_ - Cell::Ones() - home);
      if (ring >= reach.maxCoeff()) break;  // all cells seen
    }
    return static_cast<double>(least);
  }

  /// The same without grid or balls: for a few points, to check the search above.
  [[nodiscard]] double distanceByLoop(const Vec3& x) const {
    long double least = std::numeric_limits<long double>::infinity();
    for (const Triangle& t : triangles_) least = std::min(least, triangleDistance(t.corners, x));
    return static_cast<double>(least);
  }

  /// Solid angles of all triangles over 4 pi: 1 inside a closed mesh, 0 outside.
  [[nodiscard]] double windingNumber(const Vec3& x) const {
    double sum = 0;
    for (const Triangle& t : triangles_) {
      const Vec3 a = t.corners[0] - x;
      const Vec3 b = t.corners[1] - x;
      const Vec3 c = t.corners[2] - x;
      const double la = a.norm();
      const double lb = b.norm();
      const double lc = c.norm();
      sum += std::atan2(a.dot(b.cross(c)),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return sum / (2 * std::numbers::pi);
  }

 private:
  using Cell = Eigen::Vector3i;
  static constexpr double kCellsPerDiagonal = 96;  // less than a million cells

  struct Triangle {
    std::array<Vec3, 3> corners;
    Vec3 centre = Vec3::Zero();
    double radius = 0;
  };

  [[nodiscard]] Cell cellOf(const Vec3& x) const {
    return ((x - box_.min()) / cell_).array().floor().matrix().cast<int>();
  }

  [[nodiscard]] std::size_t number(const Cell& cell) const {
    return static_cast<std::size_t>((cell[2] * count_[1] + cell[1]) * count_[0] + cell[0]);
  }

  template <class Body>
  void forCells(const Cell& low, const Cell& high, const Body& body) const {
    for (int k = low[2]; k <= high[2]; ++k) {
      for (int j = low[1]; j <= high[1]; ++j) {
        for (int i = low[0]; i <= high[0]; ++i) body(Cell(i, j, k));
      }
    }
  }

  /// Cells of the grid that lie `ring` cells from home along one axis and no more along the others.
  template <class Body>
  void forRing(const Cell& home, int ring, const Body& body) const {
    const Cell low = (home.array() - ring).max(0);
    const Cell high = (home.array() + ring).min(count_.array() - 1);
    for (int k = low[2]; k <= high[2]; ++k) {
      for (int j = low[1]; j <= high[1]; ++j) {
        if (std::max(std::abs(k - home[2]), std::abs(j - home[1])) == ring) {
          for (int i = low[0]; i <= high[0]; ++i) body(Cell(i, j, k));
        } else {
          for (const int i : {home[0] - ring, home[0] + ring}) {
            if (i >= 0 && i < count_[0]) body(Cell(i, j, k));
          }
        }
      }
    }
  }

  /// No point in the cell is nearer to x; a millionth of a cell for the rounding of its walls.
  [[nodiscard]] double gapTo(const Cell& cell, const Vec3& x) const {
    const Vec3 low = box_.min() + cell_ * cell.cast<double>();
    return (low - x).cwiseMax(x - low - Vec3::Constant(cell_)).cwiseMax(0).norm() - 1e-6 * cell_;
  }

  /// The lesser of `least` and the distance of x to t.
  [[nodiscard]] long double lesser(long double least, const Triangle& t, const Vec3& x) const {
    // A millionth of a cell for the rounding of balls.
    const double bound = (x - t.centre).norm() - t.radius - 1e-6 * cell_;
    return bound > least ? least : std::min(least, triangleDistance(t.corners, x));
  }

  Box3 box_;
  double cell_ = 0;
  Cell count_ = Cell::Zero();
  std::vector<Triangle> triangles_;
  std::vector<std::vector<std::size_t>> lists_;  // triangles per cell
};

}  // namespace phront::test
