// OpenVDB on the same problems: FastSweeping, and meshToVolume. One thread.
#include <benchmark/benchmark.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/task_arena.h>

#include "band_problems.h"
#include "problems.h"
#include "ratio_reporter.h"

namespace phront::bench {
namespace {

/// The sphere's distance on all nodes as an active grid in units of a voxel.
openvdb::FloatGrid::Ptr denseSphere() {
  const SphereProblem problem(kSweepNodes);
  auto grid = openvdb::FloatGrid::create(std::numeric_limits<float>::max());
  auto access = grid->getAccessor();
  for (std::int32_t k = 0; k < kSweepNodes; ++k) {
    for (std::int32_t j = 0; j < kSweepNodes; ++j) {
      for (std::int32_t i = 0; i < kSweepNodes; ++i) {
        const Vec3 x = problem.grid.position(i, j, k) - Vec3::Constant(0.5);
        access.setValue({i, j, k}, static_cast<float>((x.norm() - 0.3) / problem.grid.spacing));
      }
    }
  }
  return grid;
}

void fastSweeping(benchmark::State& state) {
  tbb::task_arena one(1);
  const auto grid = denseSphere();
  std::int64_t sweeps = 0;
  for (auto _ : state) {
    // One round of eight.
    const auto solved = one.execute([&] { return openvdb::tools::sdfToSdf(*grid, 0.0F, 1); });
    sweeps += 8 * static_cast<std::int64_t>(solved->activeVoxelCount());
  }
  state.SetItemsProcessed(sweeps);
}

void meshToVolume(benchmark::State& state, const BandProblem& p) {
  tbb::task_arena one(1);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3& x : p.mesh.points) points.emplace_back(x[0] / p.h, x[1] / p.h, x[2] / p.h);
  for (const auto& t : p.mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points,
                                                                                        triangles);
  const auto unit = openvdb::math::Transform::createLinearTransform(1.0);
  std::int64_t nodes = 0;
  for (auto _ : state) {
    const auto grid = one.execute(
        [&] { return openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *unit, 3.0F, 3.0F); });
    nodes += static_cast<std::int64_t>(grid->activeVoxelCount());
  }
  state.SetItemsProcessed(nodes);
}

const bool kRegistered = [] {
  openvdb::initialize();
  benchmark::RegisterBenchmark("sweep/solve/openvdb", fastSweeping)
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  for (const BandProblem& p : bandProblems()) {
    benchmark::RegisterBenchmark(("band/" + p.name + "/openvdb").c_str(), meshToVolume,
                                 std::cref(p))
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
  return true;
}();

const DeclareRatio kSweeping({"whole solution, single, to OpenVDB FastSweeping",
                              "sweep/solve/phront_single", "sweep/solve/openvdb", 20});

}  // namespace
}  // namespace phront::bench
