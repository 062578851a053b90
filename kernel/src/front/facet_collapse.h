// Edge collapse of the working mesh.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "front/facet_mesh.h"

namespace phront::facet {

/// Squared distances to planes, added up (Garland & Heckbert 1997).
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0;

  void addPlane(const Vec3& normal, const Vec3& point, double weight) {
    const double offset = -normal.dot(point);
    a += weight * normal * normal.transpose();
    b += weight * offset * normal;
    c += weight * offset * offset;
  }
  void add(const Quadric& q) {
    a += q.a;
    b += q.b;
    c += q.c;
  }
  [[nodiscard]] double at(const Vec3& x) const { return x.dot(a * x) + 2 * b.dot(x) + c; }
};

/// Collapses points of `mesh` onto neighbours as long as no facet strays from phi = d by more than
/// the tolerance. Keeps what it learned between calls with rising tolerance.
class Collapser {
 public:
  Collapser(WorkMesh& mesh, const Context& context);
  /// Collapses until nothing more is possible within `tolerance`. Fails with Cancelled.
  [[nodiscard]] Result<void> run(double tolerance, const Progress& progress);

 private:
  struct Candidate {
    double cost = 0;
    Index gone = kNone;  ///< point that disappears
    Index kept = kNone;
    std::uint32_t stamp = 0;
  };

  /// Heap order: cheapest on top, ties by number.
  static bool isLater(const Candidate& a, const Candidate& b);
  void push(Index p, Index q);  ///< p onto q, unless hopeless
  [[nodiscard]] std::vector<Index> neighbours(Index p) const;
  [[nodiscard]] bool tryCollapse(Index gone, Index kept);
  [[nodiscard]] bool linkAllows(Index gone, Index kept) const;
  [[nodiscard]] bool shapesAllow(Index gone, Index kept);
  [[nodiscard]] bool isExact(Index gone, Index kept) const;
  [[nodiscard]] bool deviationAllows(Index gone, Index kept);
  [[nodiscard]]  /// addGone: the vanishing point becomes a witness itself (not where its planes do
                 /// not move).
  [[nodiscard]] bool
  witnessesAllow(Index gone, Index kept, bool addGone);
  void apply(Index gone, Index kept);

  WorkMesh& mesh_;
  const Context& context_;
  double tolerance_ = 0;
  Vec3 origin_ = Vec3::Zero();
  std::vector<Quadric> quadrics_;              ///< per point, about origin_
  std::vector<std::uint32_t> stamps_;          ///< per point: changes of its quadric
  std::vector<char> changed_;                  ///< per point: surroundings changed in this pass
  std::vector<std::vector<Index>> witnesses_;  ///< per triangle: points of phi = d it stands for
  std::vector<Candidate> heap_;

  // Of the collapse being tried.
  std::vector<Index> fan_;                 ///< triangles that change
  std::vector<Index> lost_;                ///< triangles that vanish
  std::vector<Measured> found_;            ///< per fan triangle: at its new centroid
  std::vector<std::vector<Index>> moved_;  ///< per fan triangle: new witnesses
};

}  // namespace phront::facet
