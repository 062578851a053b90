// Where the vertices of an iso-surface lie: on phi = d, on its creases where it has some.
#pragma once

#include <vector>

#include "front/iso_topology.h"
#include "front/local_foot.h"

namespace phront {

struct IsoVertex {
  Vec3 point = Vec3::Zero();
  Vec3 gradient = Vec3::Zero();  ///< unit; on creases that of the feature that holds the foot
  FootPoint foot;
  bool crease = false;  ///< several branches of the distance meet here
  double residual = 0;  ///< |phi - d|
};

/// Places the vertex of a site. Thread safe.
class VertexPlacer {
 public:
  VertexPlacer(const SurfaceDistance& surface, const LevelGrid& grid, const IsoTopology& topology,
               const LocalFoot& local);

  /// On the crease or corner of the level within the site's cell if there is one.
  [[nodiscard]] IsoVertex place(const IsoSite& site) const;
  /// Near the middle of the site's crossings, without looking for creases: never folds.
  [[nodiscard]] IsoVertex placeSafely(const IsoSite& site) const;

 private:
  struct Branch {
    Index triangle = kNone;
    Vec3 foot = Vec3::Zero();
    Vec3 direction = Vec3::Zero();  // unit, from the foot
    double distance = 0;
    Feature feature;
  };
  struct Crossings;
  using Branches = std::vector<Branch>;

  [[nodiscard]] Crossings crossingsOf(const IsoSite& site) const;
  [[nodiscard]] Vec3 crossingOn(const Crossing& ends) const;
  [[nodiscard]] bool walk(Branch& branch, const Vec3& x) const;
  [[nodiscard]] Branches gather(const Crossings& crossings, const Vec3& x) const;
  [[nodiscard]] bool reachable(const Vec3& x, const Crossings& crossings) const;
  [[nodiscard]] bool solveBranches(Branches& branches, double h, Vec3& x) const;
  bool tryCrease(Branches branches, const Vec3& start, const Crossings& crossings,
                 IsoVertex& vertex) const;
  bool creaseVertex(const Branches& branches, const Crossings& crossings, IsoVertex& vertex) const;
  bool project(Vec3 x, Index hint, const Crossings& crossings, IsoVertex& vertex) const;
  [[nodiscard]] IsoVertex bisect(const Crossings& crossings) const;
  [[nodiscard]] IsoVertex vertexAt(const Vec3& x, const FootPoint& foot) const;
  [[nodiscard]] bool distinct(const Branch& a, const Branch& b) const;

  const SurfaceDistance& surface_;
  const LevelGrid& grid_;
  const IsoTopology& topology_;
  const LocalFoot& local_;
  double radius_ = 0;     // |d|
  double diagonal_ = 0;   // of the surface's box
  double tolerance_ = 0;  // accepted |phi - d|
};

}  // namespace phront
