// Which points of the plane a face holds, by polygons along its loops.
#pragma once

#include <Eigen/Core>
#include <TopoDS_Face.hxx>
#include <vector>

namespace phront::cad {

/// Of a face in the plane z = 0. OpenCASCADE's classifiers ask the curves themselves where a face
/// has edges inside, a thousand times slower. Right but for points within `chord` of a loop.
class LoopPolygons {
 public:
  LoopPolygons(const TopoDS_Face& face, double chord);

  [[nodiscard]] bool contains(const Eigen::Vector2d& x) const;

 private:
  struct Side {
    Eigen::Vector2d low, high;  ///< by y
  };
  [[nodiscard]] std::size_t rowOf(double y) const;

  double bottom_ = 0;
  double rowHeight_ = 0;
  std::vector<std::vector<Side>> rows_;  ///< sides that reach into equal ranges of y
};

}  // namespace phront::cad
