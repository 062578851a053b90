#include "phront/eikonal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace phront {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// The scheme as the textbook has it (Zhao 2005): sorted neighbours, one root after the other.
double textbookUpdate(std::array<double, 3> a, double step) {
  std::sort(a.begin(), a.end());
  double u = a[0] + step;
  if (u > a[1]) {
    u = 0.5 * (a[0] + a[1] + std::sqrt(2 * step * step - (a[1] - a[0]) * (a[1] - a[0])));
  }
  if (u > a[2]) {
    const double sum = a[0] + a[1] + a[2];
    const double squares = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
    u = (sum + std::sqrt(sum * sum - 3 * (squares - step * step))) / 3;
  }
  return u;
}

std::vector<double> textbookSweeps(const NodeGrid& grid, const std::vector<double>& known,
                                   const std::vector<double>& speed, int sweeps) {
  std::vector<double> u = known;
  const auto [nx, ny, nz] = grid.nodes;
  const auto value = [&](int i, int j, int k) {
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i < nx && j < ny && k < nz;
    return inside ? u[static_cast<std::size_t>(grid.number(i, j, k))] : kUnknown;
  };
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int c = 0; c < nz; ++c) {
      for (int b = 0; b < ny; ++b) {
        for (int a = 0; a < nx; ++a) {
          const int i = (sweep & 1) != 0 ? nx - 1 - a : a;
          const int j = (sweep & 2) != 0 ? ny - 1 - b : b;
          const int k = (sweep & 4) != 0 ? nz - 1 - c : c;
          const auto n = static_cast<std::size_t>(grid.number(i, j, k));
          if (known[n] < kUnknown || speed[n] == 0) continue;
          const std::array<double, 3> near{std::min(value(i - 1, j, k), value(i + 1, j, k)),
                                           std::min(value(i, j - 1, k), value(i, j + 1, k)),
                                           std::min(value(i, j, k - 1), value(i, j, k + 1))};
          if (*std::min_element(near.begin(), near.end()) == kUnknown) continue;
          u[n] = std::min(u[n], textbookUpdate(near, grid.spacing / speed[n]));
        }
      }
    }
  }
  return u;
}

struct Problem {
  NodeGrid grid;
  std::vector<double> known;
  std::vector<double> speed;
};

Problem randomProblem(std::array<std::int32_t, 3> nodes, unsigned seed) {
  Problem p{{nodes, 0.1, Vec3::Zero()}, {}, {}};
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::int64_t n = 0; n < p.grid.nodeCount(); ++n) {
    p.known.push_back(unit(rng) < 0.01 ? unit(rng) : kUnknown);
    p.speed.push_back(unit(rng) < 0.1 ? 0 : 0.3 + unit(rng));
  }
  p.known.front() = 0;
  return p;
}

/// Distance to a circle or sphere of radius 0.15 around the middle of the unit square or cube;
/// exact on nodes within `cells` of it.
Problem ballProblem(std::int32_t cells, int dim, double exactCells) {
  const std::int32_t n = cells + 1;
  Problem p{{{n, n, dim == 2 ? 1 : n}, 1.0 / cells, Vec3::Zero()}, {}, {}};
  for (std::int32_t k = 0; k < p.grid.nodes[2]; ++k) {
    for (std::int32_t j = 0; j < n; ++j) {
      for (std::int32_t i = 0; i < n; ++i) {
        const Vec3 centre(0.5, 0.5, dim == 2 ? 0 : 0.5);
        const double distance = std::abs((p.grid.position(i, j, k) - centre).norm() - 0.15);
        p.known.push_back(distance <= exactCells / cells ? distance : kUnknown);
      }
    }
  }
  return p;
}

/// Largest error outside the ball, where the distance is smooth.
double ballError(const Problem& p, const EikonalOptions& options) {
  const Result<EikonalSolution> solved = solveEikonal(p.grid, p.known, p.speed, options);
  EXPECT_TRUE(solved) << solved.error().message;
  if (!solved) return kUnknown;
  double worst = 0;
  for (std::int32_t k = 0; k < p.grid.nodes[2]; ++k) {
    for (std::int32_t j = 0; j < p.grid.nodes[1]; ++j) {
      for (std::int32_t i = 0; i < p.grid.nodes[0]; ++i) {
        const Vec3 centre(0.5, 0.5, p.grid.planar() ? 0 : 0.5);
        const double distance = (p.grid.position(i, j, k) - centre).norm() - 0.15;
        if (distance < 0) continue;
        const double t = solved->times[static_cast<std::size_t>(p.grid.number(i, j, k))];
        worst = std::max(worst, std::abs(t - distance));
      }
    }
  }
  return worst;
}

TEST(Eikonal, IsTheTextbookScheme) {
  for (const std::array<std::int32_t, 3> nodes :
       {std::array{37, 29, 1}, std::array{19, 8, 22}, std::array{9, 17, 33}}) {
    const Problem p = randomProblem(nodes, 7);
    const auto solved = solveEikonal(p.grid, p.known, p.speed, {.tolerance = 0, .threads = 1});
    ASSERT_TRUE(solved) << solved.error().message;
    const std::vector<double> textbook = textbookSweeps(p.grid, p.known, p.speed, solved->sweeps);
    int reached = 0;
    for (std::size_t n = 0; n < textbook.size(); ++n) {
      if (textbook[n] == kUnknown) {
        EXPECT_EQ(solved->times[n], kUnknown);
        continue;
      }
      ++reached;
      EXPECT_NEAR(solved->times[n], textbook[n], 1e-13);  // other order of operations
    }
    EXPECT_GT(reached, static_cast<int>(textbook.size() / 2));
  }
}

TEST(Eikonal, SinglePrecisionIsTheSameScheme) {
  for (const Problem& p : {ballProblem(50, 3, 1), ballProblem(200, 2, 1),
                           randomProblem({37, 29, 1}, 5), randomProblem({19, 8, 22}, 6)}) {
    const auto full = solveEikonal(p.grid, p.known, p.speed, {});
    const auto single =
        solveEikonal(p.grid, p.known, p.speed, {.precision = EikonalPrecision::Single});
    ASSERT_TRUE(full && single);
    for (std::size_t n = 0; n < full->times.size(); ++n) {
      if (full->times[n] == kUnknown) {
        EXPECT_EQ(single->times[n], kUnknown);
      } else {
        EXPECT_NEAR(single->times[n], full->times[n], 1e-6 * (full->times[n] + p.grid.spacing));
      }
    }
  }
}

TEST(Eikonal, SameBitsAtAnyThreadCount) {
  for (const EikonalOrder order : {EikonalOrder::First, EikonalOrder::Second}) {
    const Problem p = ballProblem(50, 3, 2);
    const auto one = solveEikonal(p.grid, p.known, p.speed, {.order = order, .threads = 1});
    ASSERT_TRUE(one) << one.error().message;
    for (const int threads : {2, 4}) {
      const auto more =
          solveEikonal(p.grid, p.known, p.speed, {.order = order, .threads = threads});
      ASSERT_TRUE(more);
      EXPECT_EQ(more->sweeps, one->sweeps);
      EXPECT_EQ(more->times, one->times);
    }
  }
}

TEST(Eikonal, OneRoundAndAQuietSweepDoForDistances) {
  const Problem p = ballProblem(64, 2, 1);
  const auto solved = solveEikonal(p.grid, p.known, p.speed, {});
  ASSERT_TRUE(solved);
  EXPECT_LE(solved->sweeps, 2 * 4 + 1);
}

TEST(Eikonal, FirstOrderConverges) {
  for (const int dim : {2, 3}) {
    const int cells = dim == 2 ? 80 : 32;
    const double coarse = ballError(ballProblem(cells, dim, 1), {});
    const double fine = ballError(ballProblem(2 * cells, dim, 1), {});
    EXPECT_LT(coarse, 2.0 / cells);
    EXPECT_GT(std::log2(coarse / fine), 0.85) << coarse << " -> " << fine;
  }
}

TEST(Eikonal, SecondOrderConverges) {
  for (const int dim : {2, 3}) {
    const int cells = dim == 2 ? 80 : 60;
    const EikonalOptions second{.order = EikonalOrder::Second};
    const double coarse = ballError(ballProblem(cells, dim, 2), second);
    const double fine = ballError(ballProblem(2 * cells, dim, 2), second);
    EXPECT_LT(coarse, 0.3 * ballError(ballProblem(cells, dim, 2), {}));
    EXPECT_GT(std::log2(coarse / fine), 1.8) << coarse << " -> " << fine;
  }
}

// Speed 1 + y in the half plane: rays from a point are arcs of circles, and the time is known in
// closed form, cosh T = 1 + |x - x0|^2 / (2 F(x) F(x0)).
TEST(Eikonal, SmoothSpeedSecondOrder) {
  const auto worst = [](std::int32_t cells, EikonalOrder order) {
    const std::int32_t n = cells + 1;
    Problem p{{{n, n, 1}, 1.0 / cells, Vec3::Zero()}, {}, {}};
    const Vec3 source(0.5, 0.5, 0);
    std::vector<double> exact;
    for (std::int32_t j = 0; j < n; ++j) {
      for (std::int32_t i = 0; i < n; ++i) {
        const Vec3 x = p.grid.position(i, j);
        const double f = 1 + x.y();
        exact.push_back(std::acosh(1 + (x - source).squaredNorm() / (2 * f * (1 + source.y()))));
        p.speed.push_back(f);
        p.known.push_back((x - source).norm() < 0.1 ? exact.back() : kUnknown);
      }
    }
    const auto solved = solveEikonal(p.grid, p.known, p.speed, {.order = order});
    EXPECT_TRUE(solved) << solved.error().message;
    double error = 0;
    for (std::size_t k = 0; solved && k < exact.size(); ++k) {
      error = std::max(error, std::abs(solved->times[k] - exact[k]));
    }
    return error;
  };
  EXPECT_GT(std::log2(worst(80, EikonalOrder::First) / worst(160, EikonalOrder::First)), 0.9);
  EXPECT_GT(std::log2(worst(80, EikonalOrder::Second) / worst(160, EikonalOrder::Second)), 1.8);
}

// Fronts that meet head on in planes of nodes, and speeds that jump: the choice of stencils must
// not flip for ever.
TEST(Eikonal, SecondOrderEndsAtTies) {
  Problem box{{{41, 41, 41}, 0.025, Vec3::Zero()}, {}, {}};
  for (std::int32_t k = 0; k < 41; ++k) {
    for (std::int32_t j = 0; j < 41; ++j) {
      for (std::int32_t i = 0; i < 41; ++i) {
        const Vec3 a =
            (box.grid.position(i, j, k) - Vec3::Constant(0.5)).cwiseAbs() - Vec3::Constant(0.3);
        const double distance = std::abs(a.cwiseMax(0).norm() + std::min(a.maxCoeff(), 0.0));
        box.known.push_back(distance < 0.06 ? distance : kUnknown);
      }
    }
  }
  for (const Problem& p : {box, randomProblem({31, 25, 17}, 2), randomProblem({90, 70, 1}, 4)}) {
    const auto solved = solveEikonal(p.grid, p.known, p.speed, {.order = EikonalOrder::Second});
    ASSERT_TRUE(solved) << solved.error().message;
    EXPECT_LT(solved->sweeps, 200);
  }
}

// A wall with a door: the way leads through the door, and behind it spreads from there.
TEST(Eikonal, FrontsGoAroundWalls) {
  const std::int32_t n = 101;
  Problem p{{{n, n, 1}, 0.01, Vec3::Zero()}, {}, {}};
  p.known.assign(static_cast<std::size_t>(p.grid.nodeCount()), kUnknown);
  p.speed.assign(p.known.size(), 1);
  for (std::int32_t j = 0; j < n - 1; ++j) {
    p.speed[static_cast<std::size_t>(p.grid.number(50, j))] = 0;
  }
  p.known[static_cast<std::size_t>(p.grid.number(0, 0))] = 0;
  const auto solved = solveEikonal(p.grid, p.known, p.speed, {});
  ASSERT_TRUE(solved);
  const double door = std::hypot(0.5, 1.0);
  EXPECT_EQ(solved->times[static_cast<std::size_t>(p.grid.number(50, 3))], kUnknown);
  EXPECT_NEAR(solved->times[static_cast<std::size_t>(p.grid.number(100, 0))], 2 * door, 0.08);
}

// Twice the speed, half the time: exactly, as the factor is a power of two.
TEST(Eikonal, SpeedScalesTime) {
  Problem p = randomProblem({23, 31, 12}, 3);
  for (double& value : p.known) value = value < kUnknown ? 0 : kUnknown;
  const auto slow = solveEikonal(p.grid, p.known, p.speed, {.tolerance = 0});
  for (double& value : p.speed) value *= 2;
  const auto fast = solveEikonal(p.grid, p.known, p.speed, {.tolerance = 0});
  ASSERT_TRUE(slow && fast);
  for (std::size_t n = 0; n < slow->times.size(); ++n) {
    EXPECT_EQ(slow->times[n], 2 * fast->times[n]);
  }
}

TEST(Eikonal, RefusesBadInput) {
  const NodeGrid grid{{4, 4, 1}, 1, Vec3::Zero()};
  std::vector<double> known(16, kUnknown);
  const auto where = [&](const NodeGrid& g, const std::vector<double>& k,
                         const std::vector<double>& s, const EikonalOptions& o) {
    const auto solved = solveEikonal(g, k, s, o);
    return solved ? std::string("solved") : solved.error().where;
  };
  EXPECT_EQ(where(grid, known, {}, {}), "known");  // nothing known
  known[5] = 0;
  EXPECT_EQ(where(grid, known, {}, {}), "solved");
  EXPECT_EQ(where({{4, 0, 1}, 1, Vec3::Zero()}, {}, {}, {}), "nodes");
  EXPECT_EQ(where({{4, 4, 1}, 0, Vec3::Zero()}, known, {}, {}), "spacing");
  EXPECT_EQ(where({{4, 5, 1}, 1, Vec3::Zero()}, known, {}, {}), "known");
  EXPECT_EQ(where(grid, known, std::vector<double>(3, 1), {}), "speed");
  EXPECT_EQ(where(grid, known, std::vector<double>(16, -1), {}), "speed");
  EXPECT_EQ(where(grid, known, {}, {.tolerance = -1}), "tolerance");
  EXPECT_EQ(where(grid, known, {}, {.maxSweeps = 0}), "maxSweeps");
  EXPECT_EQ(where(grid, known, {}, {.threads = -1}), "threads");
  EXPECT_EQ(where(grid, known, {},
                  {.order = EikonalOrder::Second, .precision = EikonalPrecision::Single}),
            "precision");
  known[3] = std::nan("");
  EXPECT_EQ(where(grid, known, {}, {}), "known");
  known[3] = -1;
  EXPECT_EQ(where(grid, known, {}, {}), "known");
}

}  // namespace
}  // namespace phront
