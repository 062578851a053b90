#include "rebuild/folds.h"

#include <BRepAdaptor_Surface.hxx>
#include <cmath>

#include "exchange/measures.h"

namespace phront::cad {
namespace {

constexpr double kOff = 0.02;   // of |d|
constexpr double kPitch = 0.5;  // of |d|, as far as the grid allows

}  // namespace

double shareOffFront(const std::vector<JudgedFace>& pieces, double distance,
                     const TrueDistance& phi) {
  double area = 0;
  double areaOff = 0;
  for (const JudgedFace& piece : pieces) {
    if (!piece.live) continue;
    const BRepAdaptor_Surface surface(piece.face, Standard_False);
    double all = 0;
    double off = 0;
    for (const gp_Pnt2d& uv : gridInside(piece.face, kPitch * std::abs(distance))) {
      gp_Pnt p;
      gp_Vec du;
      gp_Vec dv;
      surface.D1(uv.X(), uv.Y(), p, du, dv);
      const double weight = du.Crossed(dv).Magnitude();
      all += weight;
      const double level = phi.foot({p.X(), p.Y(), p.Z()}).distance;
      if (std::abs(level - std::abs(distance)) > kOff * std::abs(distance)) off += weight;
    }
    if (!(all > 0)) continue;
    const double own = areaOf(piece.face);
    area += own;
    areaOff += own * off / all;
  }
  return area > 0 ? areaOff / area : 0;
}

}  // namespace phront::cad
