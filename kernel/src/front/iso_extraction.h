// One extraction of phi = d from one grid: topology, vertices, triangles.
#pragma once

#include <vector>

#include "front/iso_topology.h"
#include "front/iso_triangles.h"
#include "front/iso_vertex.h"
#include "front/level_grid.h"
#include "front/local_foot.h"
#include "phront/iso_surface.h"
#include "phront/progress.h"

namespace phront {

class IsoExtraction {
 public:
  IsoExtraction(const SurfaceDistance& surface, const LocalFoot& local, const LevelGrid& grid,
                int threads);

  /// Fails with Cancelled.
  Result<IsoSurface> run(const Progress& progress);

  /// After run(): cells at creases where the triangles miss the level by more than `tolerance`,
  /// for they hold more than one vertex can show. Chords of smooth faces do not count.
  [[nodiscard]] std::vector<Index> deviatingCells(double tolerance) const;

 private:
  void unfold();
  [[nodiscard]] bool missesLevel(const Triangle& t, double tolerance) const;
  [[nodiscard]] Feature featureOf(const Triangle& t) const;
  [[nodiscard]] IsoSurface assemble() const;

  const SurfaceDistance& surface_;
  const LevelGrid& grid_;
  const int threads_;
  const IsoTopology topology_;
  const VertexPlacer placer_;
  std::vector<IsoVertex> vertices_;
  std::vector<Triangle> triangles_;
};

}  // namespace phront
