#include "rebuild/surface_cells.h"

#include <algorithm>

#include "tessellate/face_surface.h"

namespace phront::cad {

SurfaceCell surfaceCell(const BRepAdaptor_Surface& surface, double u0, double u1, double v0,
                        double v1) {
  SurfaceCell cell{u0, u1, v0, v1, {}, {}, 0};
  cell.centre = toVec3(surface.Value((u0 + u1) / 2, (v0 + v1) / 2).XYZ());
  for (const double u : {u0, (u0 + u1) / 2, u1}) {
    for (const double v : {v0, (v0 + v1) / 2, v1}) {
      const Vec3 p = toVec3(surface.Value(u, v).XYZ());
      cell.box.extend(p);
      cell.reach = std::max(cell.reach, (p - cell.centre).norm());
    }
  }
  return cell;
}

std::array<SurfaceCell, 2> halves(const BRepAdaptor_Surface& surface, const SurfaceCell& c) {
  const double u = (c.u0 + c.u1) / 2;
  const double v = (c.v0 + c.v1) / 2;
  const double sizeU = surface.Value(c.u0, v).Distance(surface.Value(c.u1, v));
  const double sizeV = surface.Value(u, c.v0).Distance(surface.Value(u, c.v1));
  if (sizeU > sizeV) {
    return {surfaceCell(surface, c.u0, u, c.v0, c.v1), surfaceCell(surface, u, c.u1, c.v0, c.v1)};
  }
  return {surfaceCell(surface, c.u0, c.u1, c.v0, v), surfaceCell(surface, c.u0, c.u1, v, c.v1)};
}

Box3 grown(const Box3& box, double by) {
  const Vec3 margin = Vec3::Constant(by);
  return Box3(box.min() - margin, box.max() + margin);
}

}  // namespace phront::cad
