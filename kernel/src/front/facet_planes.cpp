// Plane regions of the working mesh.
//
// The offset of a planar face is planar: n . x = offset + d, known exactly. Triangles whose feet
// lie on that face belong to it; so do neighbours that leave the plane by less than `snap` (around
// a tangent border the surface leaves its plane quadratically, the border has no sharp place
// there). Every point of such triangles is moved into its plane, into the line of two planes or the
// common point of three and more (least displacement, pseudo-inverse). Where the planes of a point
// have no common point nearby, the smallest of them gives its triangles up: they stay ordinary
// triangles. Weak spot: a face whose plane is not known (stored as a B-spline) stays triangles.
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "front/facet_mesh.h"

namespace phront::facet {

namespace {

// Planes that agree to this (radian; of the diagonal) are one: round-off of STEP's decimal digits.
constexpr double kSamePlane = 1e-9;
// Points may miss their planes by this part of the diagonal (round-off of the solve is 1e-15).
constexpr double kOnPlane = 1e-12;
// Singular values below this part of the largest are directions that the planes leave free.
constexpr double kRank = 1e-7;
// A triangle counts as part of a plane when its normal is within 60 degrees of the plane's: larger
// turns within the snap distance are folds.
constexpr double kAligned = 0.5;

/// Offset planes of the faces that occur, coincident ones once; per face its plane or kNone.
std::vector<Index> collectPlanes(WorkMesh& mesh, const Context& context,
                                 std::span<const std::optional<Plane>> planeOfFace,
                                 std::span<const Feature> labels) {
  std::vector<Index> planeOfLabel(labels.size(), kNone);
  for (std::size_t l = 0; l < labels.size(); ++l) {
    const Feature& f = labels[l];
    if (f.kind != FeatureKind::Face || f.id < 0) continue;
    if (static_cast<std::size_t>(f.id) >= planeOfFace.size() || !planeOfFace[f.id]) continue;
    Plane plane = *planeOfFace[f.id];
    plane.offset += context.level;
    const auto same = std::find_if(mesh.planes.begin(), mesh.planes.end(), [&](const Plane& p) {
      return (p.normal - plane.normal).norm() <= kSamePlane &&
             std::abs(p.offset - plane.offset) <= kSamePlane * context.diagonal;
    });
    planeOfLabel[l] = static_cast<Index>(same - mesh.planes.begin());
    if (same == mesh.planes.end()) mesh.planes.push_back(plane);
  }
  return planeOfLabel;
}

bool fits(const WorkMesh& mesh, Index t, Index plane, double snap) {
  const Plane& p = mesh.planes[plane];
  for (int k = 0; k < 3; ++k) {
    if (std::abs(p.normal.dot(mesh.point(t, k)) - p.offset) > snap) return false;
  }
  const Vec3 n = mesh.areaVector(t);
  return n.dot(p.normal) > kAligned * n.norm() && mesh.tangent[t].dot(p.normal) > kAligned;
}

/// Spreads each plane over neighbours that fit it, nearest triangles first.
void growPlanes(WorkMesh& mesh, double snap) {
  std::deque<Index> front;
  for (Index t = 0; t < mesh.triangleCount(); ++t) {
    if (mesh.plane[t] != kNone) front.push_back(t);
  }
  while (!front.empty()) {
    const Index t = front.front();
    front.pop_front();
    for (int k = 0; k < 3; ++k) {
      const Index other = mesh.across(t, k);
      if (other == kNone || mesh.frozen(other) || mesh.plane[other] != kNone) continue;
      if (!fits(mesh, other, mesh.plane[t], snap)) continue;
      mesh.plane[other] = mesh.plane[t];
      front.push_back(other);
    }
  }
}

std::vector<Index> planesAround(const WorkMesh& mesh, Index p) {
  std::vector<Index> planes;
  for (const Index t : mesh.around[p]) {
    if (mesh.plane[t] != kNone) planes.push_back(mesh.plane[t]);
  }
  std::sort(planes.begin(), planes.end());
  planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
  return planes;
}

/// The point of all planes nearest to x; empty when there is none within `snap`.
std::optional<Vec3> commonPoint(const WorkMesh& mesh, std::span<const Index> planes, const Vec3& x,
                                double snap, double onPlane) {
  Eigen::MatrixX3d normals(planes.size(), 3);
  Vec3 y = x;
  for (std::size_t i = 0; i < planes.size(); ++i) normals.row(i) = mesh.planes[planes[i]].normal;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(normals, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd s = svd.singularValues();
  Eigen::VectorXd residual(planes.size());
  for (int round = 0; round < 2; ++round) {  // the second removes the round-off of the first
    for (std::size_t i = 0; i < planes.size(); ++i) {
      residual[i] = mesh.planes[planes[i]].offset - mesh.planes[planes[i]].normal.dot(y);
    }
    const Eigen::VectorXd projected = svd.matrixU().transpose() * residual;
    for (Eigen::Index k = 0; k < s.size(); ++k) {
      if (s[k] > kRank * s[0]) y += svd.matrixV().col(k) * (projected[k] / s[k]);
    }
  }
  if (!((y - x).norm() <= snap)) return std::nullopt;
  for (const Index plane : planes) {
    const Plane& p = mesh.planes[plane];
    if (!(std::abs(p.normal.dot(y) - p.offset) <= onPlane)) return std::nullopt;
  }
  return y;
}

/// Takes the plane with the smallest area around p away from its triangles there.
void demoteSmallest(WorkMesh& mesh, Index p, std::deque<Index>& touched) {
  std::map<Index, double> area;
  for (const Index t : mesh.around[p]) {
    if (mesh.plane[t] != kNone) area[mesh.plane[t]] += mesh.areaVector(t).norm();
  }
  const auto smallest = std::min_element(
      area.begin(), area.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  for (const Index t : mesh.around[p]) {
    if (mesh.plane[t] != smallest->first) continue;
    mesh.plane[t] = kNone;
    for (const Index q : mesh.corners[t]) touched.push_back(q);
  }
}

}  // namespace

void assignPlanes(WorkMesh& mesh, const Context& context, std::span<const Feature> labels,
                  std::span<const std::optional<Plane>> planeOfFace, double snap) {
  const std::vector<Index> planeOfLabel = collectPlanes(mesh, context, planeOfFace, labels);
  for (Index t = 0; t < mesh.triangleCount(); ++t) {
    if (mesh.frozen(t)) continue;
    const Index plane = planeOfLabel[mesh.label[t]];
    if (plane != kNone && fits(mesh, t, plane, snap)) mesh.plane[t] = plane;
  }
  growPlanes(mesh, snap);

  const std::vector<Vec3> start = mesh.points;
  std::deque<Index> todo;
  for (Index p = 0; p < mesh.pointCount(); ++p) todo.push_back(p);
  while (!todo.empty()) {
    const Index p = todo.front();
    todo.pop_front();
    mesh.points[p] = start[p];
    mesh.exactPlanes[p] = planesAround(mesh, p);
    if (mesh.exactPlanes[p].empty()) continue;
    const auto y = commonPoint(mesh, mesh.exactPlanes[p], start[p], mesh.fixed(p) ? 0 : snap,
                               kOnPlane * context.diagonal);
    if (y) {
      mesh.points[p] = *y;
    } else {
      demoteSmallest(mesh, p, todo);
      todo.push_back(p);
    }
  }
  // Moving points may have folded small triangles; these stay outside the polygons.
  for (Index t = 0; t < mesh.triangleCount(); ++t) {
    if (mesh.plane[t] == kNone) continue;
    if (mesh.areaVector(t).dot(mesh.planes[mesh.plane[t]].normal) <= 0) mesh.plane[t] = kNone;
  }
}

}  // namespace phront::facet
