// Numbers side by side, worked on at once: the compiler's vector types.
#pragma once

#include <cmath>
#include <cstring>

namespace phront {

template <class Real, int N>
struct LanesOf {
  typedef Real Type __attribute__((vector_size(N * sizeof(Real))));
};
template <class Real, int N>
using Lanes = typename LanesOf<Real, N>::Type;

// A function marked so exists once for each instruction set; the best is picked at run time. All
// give the same bits: no contraction (a flag of the project), sqrt and division are exact in each.
// PHRONT_ONE_CLONE: none of it, for tests that compare.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(PHRONT_ONE_CLONE)
#define PHRONT_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define PHRONT_CLONES
#endif
// Its parts must become part of each.
#define PHRONT_INLINE inline __attribute__((always_inline))

template <class L, class Real>
PHRONT_INLINE L loadLanes(const Real* from) {
  L lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

template <class L, class Real>
PHRONT_INLINE void storeLanes(Real* to, const L& lanes) {
  std::memcpy(to, &lanes, sizeof lanes);
}

template <class L>
PHRONT_INLINE L minOf(const L& a, const L& b) {
  return a < b ? a : b;
}

template <class L>
PHRONT_INLINE L maxOf(const L& a, const L& b) {
  return a > b ? a : b;
}

template <class Real, int N>
PHRONT_INLINE Lanes<Real, N> sqrtOf(const Lanes<Real, N>& x) {
  Lanes<Real, N> root;
  for (int lane = 0; lane < N; ++lane) root[lane] = std::sqrt(x[lane]);
  return root;
}

}  // namespace phront
