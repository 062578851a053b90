// Bounding-volume hierarchy over boxes in one flat array.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "phront/types.h"

namespace phront {

/// Binary tree of axis-aligned boxes. Children of an inner node lie side by side, so one index
/// names both. Node 0 is the root; an empty tree has no nodes.
class Bvh {
 public:
  struct Node {
    Vec3 low, high;
    Index first = 0;  ///< leaf: first item (into order()); inner: left child, right is first + 1
    Index count = 0;  ///< items of a leaf; 0 for inner nodes
  };

  /// No path from the root is longer: the builder halves ranges when it gets near.
  static constexpr int kMaxDepth = 96;

  Bvh() = default;
  /// Surface-area heuristic, 16 bins (Wald 2007). Items are the numbers in `items`, whose boxes are
  /// boxes[item].
  Bvh(std::span<const Box3> boxes, std::vector<Index> items);

  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  [[nodiscard]] const std::vector<Index>& order() const { return order_; }

  /// Squared distance from x to the box of a node. Every point f inside the box, component by
  /// component, has (x - f).squaredNorm() >= this value in floating point too: subtraction,
  /// product and sum are monotone and the sum runs in the same order.
  [[nodiscard]] static double squaredDistance(const Node& node, const Vec3& x) {
    const Vec3 gap = (node.low - x).cwiseMax(x - node.high).cwiseMax(0.0);
    return gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2];
  }

  /// Visits leaves nearest first; `visit(position)` gets a position in order() and `bound()`
  /// returns the squared distance beyond which nothing matters any more. Boxes at exactly the bound
  /// are still opened, so that ties are seen.
  template <class Visit, class Bound>
  void nearest(const Vec3& x, Visit&& visit, Bound&& bound) const {
    if (nodes_.empty()) return;
    struct Entry {
      Index node;
      double squared;
    };
    std::array<Entry, kMaxDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, squaredDistance(nodes_[0], x)};
    while (size > 0) {
      const Entry entry = stack[--size];
      if (entry.squared > bound()) continue;
      const Node& node = nodes_[static_cast<std::size_t>(entry.node)];
      if (node.count > 0) {
        for (Index i = 0; i < node.count; ++i) visit(node.first + i);
        continue;
      }
      const auto left = static_cast<std::size_t>(node.first);
      const double dl = squaredDistance(nodes_[left], x);
      const double dr = squaredDistance(nodes_[left + 1], x);
      const bool leftNearer = dl <= dr;
      const double limit = bound();
      const Entry far{node.first + (leftNearer ? 1 : 0), leftNearer ? dr : dl};
      const Entry near{node.first + (leftNearer ? 0 : 1), leftNearer ? dl : dr};
      if (far.squared <= limit) stack[size++] = far;
      if (near.squared <= limit) stack[size++] = near;
    }
  }

 private:
  std::vector<Node> nodes_;
  std::vector<Index> order_;
};

}  // namespace phront
