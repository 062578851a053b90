// Marching squares (Lorensen & Cline 1987, in the plane) with crossings found by bisection.
#include <array>
#include <map>

#include "surfaces/contour.h"

namespace phront::cad {
namespace {

constexpr int kBisections = 30;
constexpr double kOnLine = 0.1;  // of the chord

/// Sides of the grid's cells, numbered: those along x first.
class GridLines {
 public:
  GridLines(const ClearanceAt& clearance, double chord, std::span<const double> us,
            std::span<const double> vs)
      : clearance_(clearance),
        chord_(chord),
        us_(us),
        vs_(vs),
        columns_(static_cast<int>(us.size()) - 1),
        rows_(static_cast<int>(vs.size()) - 1) {
    for (int j = 0; j <= rows_; ++j) {
      for (int i = 0; i <= columns_; ++i) valid_.push_back(clearance(node(i, j)).value >= 0);
    }
  }

  std::vector<Contour> run() {
    for (int j = 0; j < rows_; ++j) {
      for (int i = 0; i < columns_; ++i) lookAt(i, j);
    }
    return chained();
  }

 private:
  [[nodiscard]] Vec2 node(int i, int j) const {
    return {us_[static_cast<std::size_t>(i)], vs_[static_cast<std::size_t>(j)]};
  }
  [[nodiscard]] bool valid(int i, int j) const {
    return valid_[static_cast<std::size_t>(i + j * (columns_ + 1))];
  }
  [[nodiscard]] int along(int i, int j) const { return i + j * columns_; }
  [[nodiscard]] int across(int i, int j) const {
    return columns_ * (rows_ + 1) + i + j * (columns_ + 1);
  }

  /// Sides of a cell where validity changes, joined in pairs.
  void lookAt(int i, int j) {
    struct Side {
      int number;
      std::array<int, 4> ends;
    };
    const std::array<Side, 4> sides{
        Side{along(i, j), {i, j, i + 1, j}}, Side{across(i + 1, j), {i + 1, j, i + 1, j + 1}},
        Side{along(i, j + 1), {i + 1, j + 1, i, j + 1}}, Side{across(i, j), {i, j + 1, i, j}}};
    std::vector<int> crossed;
    for (const Side& side : sides) {
      const auto& [i0, j0, i1, j1] = side.ends;
      if (valid(i0, j0) == valid(i1, j1)) continue;
      crossed.push_back(side.number);
      if (!points_.contains(side.number))
        points_[side.number] = valid(i0, j0) ? crossing(node(i1, j1), node(i0, j0))
                                             : crossing(node(i0, j0), node(i1, j1));
    }
    // Four: corners of a kind lie across from one another. The valid ones are kept apart.
    if (crossed.size() == 4 && !valid(i, j)) std::swap(crossed[1], crossed[3]);
    if (crossed.size() == 4) {
      join(crossed[3], crossed[0]);
      join(crossed[1], crossed[2]);
    } else if (crossed.size() == 2) {
      join(crossed[0], crossed[1]);
    }
  }

  void join(int a, int b) {
    next_[a].push_back(b);
    next_[b].push_back(a);
  }

  [[nodiscard]] Vec2 crossing(Vec2 without, Vec2 with) const {
    for (int k = 0; k < kBisections && (with - without).norm() > kOnLine * chord_; ++k) {
      const Vec2 middle = 0.5 * (with + without);
      (clearance_(middle).value >= 0 ? with : without) = middle;
    }
    return with;
  }

  std::vector<Contour> chained() {
    std::vector<Contour> lines;
    // Open lines from their ends, then what is closed.
    for (const bool open : {true, false}) {
      for (const auto& [side, neighbours] : next_) {
        if (done_.contains(side) || (open && neighbours.size() != 1)) continue;
        Contour line;
        line.closed = !open;
        for (int here = side; here >= 0;) {
          done_[here] = true;
          line.points.push_back(points_[here]);
          int to = -1;
          for (const int other : next_[here])
            if (!done_.contains(other)) to = other;
          here = to;
        }
        lines.push_back(std::move(line));
      }
    }
    return lines;
  }

  const ClearanceAt& clearance_;
  double chord_;
  std::span<const double> us_, vs_;
  int columns_, rows_;
  std::vector<bool> valid_;
  std::map<int, Vec2> points_;
  std::map<int, std::vector<int>> next_;
  std::map<int, bool> done_;
};

}  // namespace

std::vector<Contour> gridContours(const ClearanceAt& clearance, double chord,
                                  std::span<const double> us, std::span<const double> vs) {
  return GridLines(clearance, chord, us, vs).run();
}

}  // namespace phront::cad
