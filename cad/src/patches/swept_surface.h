// Pipe surface round any edge, between the images of the edge in its two faces.
#pragma once

#include <BRepAdaptor_Curve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Surface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>
#include <vector>

#include "patches/pipe.h"

namespace phront::cad {

/// Across it every section is a rational arc, and so an exact circle; along it the poles and
/// weights of the sections are interpolated by quintics, so that few spans reach the tolerance
/// (Piegl & Tiller, The NURBS Book, 1997, ch. 7 and 9). A section runs through the images of the
/// edge in its two faces, which makes them sides of the pipe however well the edge lies on its
/// faces.
class SweptSurface {
 public:
  /// A circle arc from a to b, less than half a turn.
  struct Section {
    gp_Pnt a;  ///< on the image in face 1
    gp_Pnt b;  ///< on that in face 2
    gp_Pnt centre;
    gp_Vec middle;     ///< unit, from the centre
    double angle = 0;  ///< rad
  };

  /// Both images must be there and run as the edge does. Keeps a reference to `frame`.
  explicit SweptSurface(const PipeFrame& frame);

  /// False where a section has no middle: then there is no such surface.
  [[nodiscard]] bool possible() const { return possible_; }

  /// Whether another surface, across in u and along the edge in v, is one.
  [[nodiscard]] bool isMetBy(const Geom_Surface& surface) const;

  /// u in [0, 1] from image 1 to image 2, v the edge's parameter. Null when the tolerance stays out
  /// of reach by far.
  [[nodiscard]] Handle(Geom_BSplineSurface) make() const;

  [[nodiscard]] double first() const { return t0_; }
  [[nodiscard]] double last() const { return t1_; }
  [[nodiscard]] Section section(double t) const;

  /// u of a point on the section at t.
  [[nodiscard]] double across(const gp_Pnt& p, double t) const;

  /// Side of a patch at t along `arc`, from the vertex `from` at u = `start` to its other end at u
  /// = `end`. Degenerated at `from` where the arc is null.
  [[nodiscard]] PatchSide shortSide(double t, const TopoDS_Edge& arc, const TopoDS_Vertex& from,
                                    double start, double end) const;

 private:
  struct Pole {
    gp_Pnt point;
    double weight = 1;
  };
  [[nodiscard]] std::vector<Pole> poles(double t) const;
  [[nodiscard]] Handle(Geom_BSplineSurface)
      interpolated(const TColStd_Array1OfReal& breaks, int each) const;
  [[nodiscard]] double error(const Geom_Surface& surface, int spans) const;

  const PipeFrame& frame_;
  BRepAdaptor_Curve edge_;
  BRepAdaptor_Curve image1_;
  BRepAdaptor_Curve image2_;
  double t0_;
  double t1_;
  bool possible_ = true;
  bool halves_ = false;  ///< a section is made of two arcs
};

}  // namespace phront::cad
