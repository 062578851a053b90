// B-spline basis functions.
#pragma once

#include <array>
#include <cstddef>

#include "phront/nurbs.h"

namespace phront {

inline constexpr int kMaxDegree = 25;  // of OpenCASCADE

/// The functions that are not zero at a parameter, and their derivatives.
struct BasisAt {
  std::size_t first = 0;  ///< number of the first of degree + 1
  std::array<double, kMaxDegree + 1> value{};
  std::array<double, kMaxDegree + 1> slope{};
};

/// `t` is held to the domain.
[[nodiscard]] BasisAt basisAt(const Knots& knots, double t);

}  // namespace phront
