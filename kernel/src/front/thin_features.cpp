// A sheet, rod or crumb between the nodes makes the gradients at the corners of its cells oppose
// one another. Such cells are searched by subgradient descent of +-(phi - d) with geometrically
// falling steps (Goffin 1977), kept in the cell; a point of the other sign is a proof. Tips of
// wedges that poke through a cell's face do the same without harm: vertices reach them from the
// next cell. So a proof counts only where the extracted mesh misses it by more than kMissed cells.
// Weak spots: features that touch no kept block's cell pairwise opposed (regular tetrahedra smaller
// than a cell seen from one side) may stay hidden.
#include "front/thin_features.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace phront {

namespace {

constexpr std::int64_t kGrain = 64;
constexpr int kSteps = 24;
constexpr double kFirstStep = 0.5;
constexpr double kStepRatio = 0.8;
constexpr double kMissed = 0.5;
// Directions that include more than about 80 degrees oppose (wedges of a right angle lie at 90).
constexpr double kOpposed = 0.2;

bool gradientsOppose(const LevelGrid& grid, const GridCell& cell) {
  std::array<Vec3, 8> n;
  for (std::size_t c = 0; c < 8; ++c) {
    const GridNode& node = grid.nodes()[static_cast<std::size_t>(cell.node[c])];
    const Vec3 gap = grid.positionOf(cell.node[c]) - node.foot;
    const double length = gap.norm();
    if (!(length > 0)) return false;
    n[c] = std::copysign(1 / length, node.phi) * gap;
    for (std::size_t other = 0; other < c; ++other) {
      if (n[c].dot(n[other]) < kOpposed) return true;
    }
  }
  return false;
}

struct Proof {
  bool found = false;
  Vec3 point = Vec3::Zero();
};

/// A point of the sign that no corner has.
Proof search(const SurfaceDistance& surface, const LevelGrid& grid, const GridCell& cell,
             double depth) {
  const double h = grid.sideOf(cell);
  // Seen as a height over the level, positive at all corners.
  const double side = cell.inside == 0 ? 1 : -1;
  double least = std::abs(grid.nodes()[static_cast<std::size_t>(cell.node[0])].phi - grid.level());
  std::size_t lowest = 0;
  for (std::size_t c = 1; c < 8; ++c) {
    const double height =
        std::abs(grid.nodes()[static_cast<std::size_t>(cell.node[c])].phi - grid.level());
    if (height < least) {
      least = height;
      lowest = c;
    }
  }
  if (least > 0.5 * std::sqrt(3.0) * h || !gradientsOppose(grid, cell)) return {};
  const Vec3 lower = grid.position(cell.lower);
  const Vec3 upper = lower + Vec3::Constant(h);
  Index hint = grid.nodes()[static_cast<std::size_t>(cell.node[lowest])].triangle;
  Vec3 x = 0.5 * (lower + upper);
  double step = kFirstStep * h;
  for (int i = 0; i < kSteps; ++i) {
    const FootPoint foot = surface.footFrom(x, hint);
    if (foot.beyondBorder) return {};
    if (side * (foot.phi() - grid.level()) < -depth) return {true, x};
    hint = foot.triangle;
    x = (x - side * step * surface.gradient(x, foot)).cwiseMax(lower).cwiseMin(upper);
    step *= kStepRatio;
  }
  return {};
}

}  // namespace

std::vector<ThinFeature> findThinFeatures(const SurfaceDistance& surface, LevelGrid& grid,
                                          double depth, SearchIn in, int threads) {
  const auto& cells = grid.quietCells();
  std::vector<Index> wanted;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const GridCell::Search search = cells[i].search;
    const bool again = search == GridCell::Search::Feature && in == SearchIn::AllCells;
    if (search == GridCell::Search::Pending || again) wanted.push_back(static_cast<Index>(i));
  }
  std::vector<Proof> proofs(wanted.size());
  parallelFor(static_cast<std::int64_t>(wanted.size()), threads, kGrain,
              [&](std::int64_t begin, std::int64_t end) {
                for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                     ++i) {
                  const auto cell = static_cast<std::size_t>(wanted[i]);
                  proofs[i] = search(surface, grid, cells[cell], depth);
                }
              });
  std::vector<ThinFeature> features;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const bool found = proofs[i].found;
    grid.setSearch(wanted[i], found ? GridCell::Search::Feature : GridCell::Search::Nothing);
    if (found) features.push_back({wanted[i], proofs[i].point});
  }
  return features;
}

Result<std::vector<ThinFeature>> missedFeatures(const SurfaceDistance& surface,
                                                const LevelGrid& grid, const TriMesh& mesh,
                                                std::vector<ThinFeature> features, int threads) {
  if (features.empty() || mesh.triangles.empty()) return features;
  const auto extracted = SurfaceDistance::build(mesh);
  if (!extracted) return tl::unexpected(extracted.error());
  std::vector<char> missed(features.size(), 0);
  parallelFor(
      static_cast<std::int64_t>(features.size()), threads, kGrain,
      [&](std::int64_t begin, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
          const GridCell& cell = grid.quietCells()[static_cast<std::size_t>(features[i].quietCell)];
          const Vec3& x = features[i].point;
          const FootPoint foot = extracted->foot(x);
          const bool inside = surface.signedDistance(x) < grid.level();
          // Slivers beside creases have no normal to trust: the winding number decides.
          missed[i] = foot.distance > kMissed * grid.sideOf(cell) &&
                      inside != (extracted->windingNumber(x) > 0.5);
        }
      });
  std::vector<ThinFeature> out;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (missed[i] != 0) out.push_back(features[i]);
  }
  return out;
}

}  // namespace phront
