// The grid's gradient is smoothed over a cell: that costs accuracy (use advectPoints() for that),
// and gives one direction at concave edges, which layers need. Near the medial axis the
// interpolated gradient shrinks to zero; a point stops when phi has not risen over a step.
#include "phront/grid_advect.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/parallel.h"

namespace phront {
namespace {

constexpr double kStepOfSpacing = 0.5;   // automatic step
constexpr double kMostTurn = 0.2;        // rad that the direction may turn in a step
constexpr double kLeastStep = 1.0 / 64;  // of the first
constexpr double kLeastGradient = 1e-6;  // below, there is no direction
constexpr double kLeastRise = 1e-3;      // of a step: below, phi does not rise any more
constexpr double kLanding = 1e-12;       // of |d|: arrived
constexpr int kMostLandings = 8;         // linear cuts back to the level
constexpr std::int64_t kGrain = 64;      // points per task

struct Sample {
  double value = 0;
  Vec3 gradient = Vec3::Zero();
};

class GridSampler {
 public:
  GridSampler(const NodeGrid& grid, std::span<const double> values)
      : grid_(grid), values_(values), axes_(grid.planar() ? 2 : 3) {}

  /// Empty outside the grid and next to nodes without a value.
  [[nodiscard]] std::optional<Sample> at(const Vec3& x) const {
    std::array<std::int32_t, 3> low{};
    Vec3 w = Vec3::Zero();
    for (int axis = 0; axis < axes_; ++axis) {
      const std::int32_t last = grid_.nodes[static_cast<std::size_t>(axis)] - 1;
      const double u = (x[axis] - grid_.origin[axis]) / grid_.spacing;
      if (!(u >= 0 && u <= last) || last < 1) return std::nullopt;
      const auto cell = std::min(static_cast<std::int32_t>(u), last - 1);
      low[static_cast<std::size_t>(axis)] = cell;
      w[axis] = u - cell;
    }
    Sample sample;
    for (int corner = 0; corner < 1 << axes_; ++corner) {
      std::array<std::int32_t, 3> node = low;
      double weight = 1;
      for (int axis = 0; axis < axes_; ++axis) {
        const bool far = (corner >> axis & 1) != 0;
        if (far) ++node[static_cast<std::size_t>(axis)];
        weight *= far ? w[axis] : 1 - w[axis];
      }
      sample.value += weight * value(node);
      for (int axis = 0; axis < axes_; ++axis) sample.gradient[axis] += weight * slope(node, axis);
    }
    if (!std::isfinite(sample.value) || !sample.gradient.allFinite()) return std::nullopt;
    return sample;
  }

 private:
  [[nodiscard]] double value(const std::array<std::int32_t, 3>& n) const {
    return values_[static_cast<std::size_t>(grid_.number(n[0], n[1], n[2]))];
  }

  [[nodiscard]] double slope(const std::array<std::int32_t, 3>& node, int axis) const {
    const auto a = static_cast<std::size_t>(axis);
    std::array<std::int32_t, 3> before = node;
    std::array<std::int32_t, 3> after = node;
    if (node[a] > 0) --before[a];
    if (node[a] + 1 < grid_.nodes[a]) ++after[a];
    return (value(after) - value(before)) / ((after[a] - before[a]) * grid_.spacing);
  }

  const NodeGrid& grid_;
  std::span<const double> values_;
  int axes_;
};

struct Landing {
  Vec3 point;
  AdvectStatus status;
  double travelled;
};

class GridWalker {
 public:
  GridWalker(const NodeGrid& grid, std::span<const double> phi, const GridAdvectOptions& options)
      : sampler_(grid, phi),
        sign_(options.distance > 0 ? 1 : -1),
        distance_(std::abs(options.distance)),
        firstStep_(options.step.value_or(kStepOfSpacing * grid.spacing)),
        adaptive_(!options.step) {}

  [[nodiscard]] Landing walk(const Vec3& start) const {
    Landing here{start, AdvectStatus::Border, 0};
    std::optional<Sample> sample = sampler_.at(start);
    if (!sample) return here;
    for (;;) {
      const double level = sign_ * sample->value;
      here.travelled = std::max(0.0, level);
      const double left = distance_ - level;
      if (left <= kLanding * distance_) return ended(here, AdvectStatus::Arrived);
      double step = std::min(firstStep_, left);
      std::optional<Vec3> next = rungeKutta(here.point, *sample, step);
      while (adaptive_ && next && step > kLeastStep * firstStep_ &&
             turn(*sample, *next) > kMostTurn) {
        step /= 2;
        next = rungeKutta(here.point, *sample, step);
      }
      std::optional<Sample> there;
      if (next) there = sampler_.at(*next);
      if (!there) return ended(here, blocked(here.point, *sample, step));
      const double reached = sign_ * there->value;
      if (reached >= distance_) return land(here, level, *next, reached);
      if (reached - level < kLeastRise * step) return ended(here, AdvectStatus::Collided);
      here.point = *next;
      sample = there;
    }
  }

 private:
  static Landing ended(Landing landing, AdvectStatus status) {
    landing.status = status;
    return landing;
  }

  /// Cuts the chord from `here` (below the level) to `beyond` where phi takes the level, linearly.
  [[nodiscard]] Landing land(const Landing& here, double level, Vec3 beyond, double reached) const {
    Vec3 low = here.point;
    for (int i = 0; i < kMostLandings && reached - level > 0; ++i) {
      const Vec3 cut = low + (distance_ - level) / (reached - level) * (beyond - low);
      const std::optional<Sample> sample = sampler_.at(cut);
      if (!sample) break;
      const double found = sign_ * sample->value;
      if (std::abs(found - distance_) <= kLanding * distance_) {
        return {cut, AdvectStatus::Arrived, found};
      }
      if (found < distance_) {
        low = cut;
        level = found;
      } else {
        beyond = cut;
        reached = found;
      }
    }
    const Vec3 cut = low + (distance_ - level) / (reached - level) * (beyond - low);
    return {cut, AdvectStatus::Arrived, distance_};
  }

  /// Why no step leads on from x: the grid ends there, or phi has no slope: a medial axis.
  [[nodiscard]] AdvectStatus blocked(const Vec3& x, const Sample& sample, double step) const {
    const std::optional<Vec3> along = direction(sample);
    const bool inside = !along || sampler_.at(x + step * *along);
    return inside ? AdvectStatus::Collided : AdvectStatus::Border;
  }

  [[nodiscard]] std::optional<Vec3> direction(const Sample& sample) const {
    const double size = sample.gradient.norm();
    if (!(size >= kLeastGradient)) return std::nullopt;
    return Vec3(sign_ / size * sample.gradient);
  }

  [[nodiscard]] std::optional<Vec3> directionAt(const Vec3& x) const {
    const std::optional<Sample> sample = sampler_.at(x);
    return sample ? direction(*sample) : std::nullopt;
  }

  [[nodiscard]] std::optional<Vec3> rungeKutta(const Vec3& x, const Sample& sample,
                                               double step) const {
    const auto k1 = direction(sample);
    if (!k1) return std::nullopt;
    const auto k2 = directionAt(x + 0.5 * step * *k1);
    if (!k2) return std::nullopt;
    const auto k3 = directionAt(x + 0.5 * step * *k2);
    if (!k3) return std::nullopt;
    const auto k4 = directionAt(x + step * *k3);
    if (!k4) return std::nullopt;
    return Vec3(x + step / 6 * (*k1 + 2 * *k2 + 2 * *k3 + *k4));
  }

  [[nodiscard]] double turn(const Sample& sample, const Vec3& next) const {
    const auto before = direction(sample);
    const auto after = directionAt(next);
    return before && after ? std::acos(std::clamp(before->dot(*after), -1.0, 1.0)) : 0;
  }

  GridSampler sampler_;
  double sign_;
  double distance_;
  double firstStep_;
  bool adaptive_;
};

}  // namespace

Result<AdvectResult> advectOnGrid(const NodeGrid& grid, std::span<const double> phi,
                                  std::span<const Vec3> start, const GridAdvectOptions& options) {
  if (!std::isfinite(options.distance) || options.distance == 0) {
    return fail(ErrorCode::InvalidArgument, "The distance must be finite and not zero.",
                "distance");
  }
  if (options.step && !(*options.step > 0 && std::isfinite(*options.step))) {
    return fail(ErrorCode::InvalidArgument, "The step must be positive and finite.", "step");
  }
  if (options.threads < 0) {
    return fail(ErrorCode::InvalidArgument, "The number of threads must not be negative.",
                "threads");
  }
  if (auto ok = checkGrid(grid); !ok) return tl::unexpected(ok.error());
  if (phi.size() != static_cast<std::size_t>(grid.nodeCount())) {
    return fail(ErrorCode::InvalidArgument, "There must be one value per node.", "phi");
  }
  for (const Vec3& x : start) {
    if (!x.allFinite()) {
      return fail(ErrorCode::InvalidArgument, "A start point is not finite.", "start");
    }
  }
  const GridWalker walker(grid, phi, options);
  AdvectResult result;
  result.points.resize(start.size());
  result.status.resize(start.size());
  result.travelled.resize(start.size());
  parallelFor(static_cast<std::int64_t>(start.size()), options.threads, kGrain,
              [&](std::int64_t begin, std::int64_t end) {
                for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end);
                     ++i) {
                  const Landing landing = walker.walk(start[i]);
                  result.points[i] = landing.point;
                  result.status[i] = landing.status;
                  result.travelled[i] = landing.travelled;
                }
              });
  return result;
}

}  // namespace phront
