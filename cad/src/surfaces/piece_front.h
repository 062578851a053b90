// Where a surface that stands off a shape by |d| is on the front, and where it has crossed it.
#pragma once

#include <BRepTopAdaptor_FClass2d.hxx>
#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <array>
#include <vector>

#include "surfaces/contour.h"
#include "surfaces/nurbs_geom.h"
#include "surfaces/parameter_plane.h"
#include "tessellate/true_distance.h"

namespace phront::cad {

struct TrimRequest {
  bool solid = true;     ///< phi has a sign
  double distance = 0;   ///< d, mm, along the outward normals
  double tolerance = 0;  ///< mm: where the offset is nearer than |d| by more it is cut off
};

/// One offset surface over the domain of a face. Points are those of a plane() that resembles the
/// surface. The clearance is negative where the shape is nearer than |d|: there the surface has
/// crossed another part of the front, or itself.
class PieceFront {
 public:
  /// `domain`: a face whose loops bound the parameters; `box`: those of the surface that count.
  PieceFront(const TopoDS_Face& domain, const Handle(Geom_Surface) & surface,
             const ParameterBox& box, const TrimRequest& request, const TrueDistance& phi);

  PieceFront(const PieceFront&) = delete;
  PieceFront& operator=(const PieceFront&) = delete;

  [[nodiscard]] const ParameterPlane& plane() const { return plane_; }
  [[nodiscard]] const Vec2& low() const { return low_; }
  [[nodiscard]] const Vec2& high() const { return high_; }
  [[nodiscard]] double chord() const;  ///< mm, of the lines from the true ones
  [[nodiscard]] double cut() const;  ///< mm: the lines lie where the shape is nearer than |d| by it

  /// Distance from the shape on the side where the offset belongs.
  [[nodiscard]] double level(const Vec2& x) const;
  [[nodiscard]] Clearance clearance(const Vec2& x) const;
  [[nodiscard]] bool inFace(const Vec2& x);
  [[nodiscard]] bool inBox(const Vec2& x) const;

  /// Cells for a length, by |d|, at least so many.
  [[nodiscard]] int cellsFor(double length, int least) const;

  /// Middles of `count` parts of a range of the plane's axis (0 for u, 1 for v), and the knots of
  /// the original there: creases and ripples lie along those, narrower than the parts.
  [[nodiscard]] std::vector<double> middles(Eigen::Index axis, const Interval& range,
                                            int count) const;

  /// Look for points of the domain, and of its loops, between which the front ends: seeds of lines.
  /// `beyond`: one of two points may lie outside the domain.
  void sampleInside(int least, bool beyond = true);
  void sampleLoops();
  [[nodiscard]] int validSamples() const { return valid_; }
  [[nodiscard]] std::vector<ContourSeed>& seeds() { return seeds_; }

  /// Adds the lines through the seeds that are not there yet; or all lines, by a grid.
  void traceLines(std::vector<Contour>& lines) const;
  [[nodiscard]] std::vector<Contour> gridLines(int cells) const;

 private:
  [[nodiscard]] Vec3 pointAt(const Vec2& x) const;
  [[nodiscard]] bool valid(const Vec2& x) const;
  [[nodiscard]] std::vector<double> withKnots(Eigen::Index axis, const Interval& range,
                                              std::vector<double> values) const;
  void seedInwards(const Vec2& x, const Vec2& inward);
  [[nodiscard]] ContourOptions lineOptions() const;

  TopoDS_Face face_;
  BRepTopAdaptor_FClass2d inFace_;
  Handle(Geom_Surface) surface_;
  TrimRequest request_;
  const TrueDistance& phi_;
  ParameterPlane plane_;
  ClearanceAt clearance_ = [this](const Vec2& x) { return clearance(x); };
  Vec2 low_, high_;
  std::array<std::vector<double>, 2> knots_;  ///< of the original, inside, on the plane's axes
  double meshSlack_ = 0;
  std::vector<ContourSeed> seeds_;
  int valid_ = 0;
};

}  // namespace phront::cad
