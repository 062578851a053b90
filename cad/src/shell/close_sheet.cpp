#include "shell/close_sheet.h"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>

#include "exchange/face_set.h"
#include "rebuild/cells.h"
#include "rebuild/fuse.h"
#include "rebuild/select.h"
#include "tessellate/face_surface.h"

namespace phront::cad {
namespace {

constexpr double kStep = 1e-3;  // of the thickness: into a cell, to see whether it is the material

class Closer {
 public:
  Closer(const ThickSheetPieces& pieces, const TrueDistance& phi, const FreeBorder& border)
      : pieces_(pieces), phi_(phi), thick_(phi, border, pieces.walls) {}

  Result<TopoDS_Shape> run(const ClosingWay& way) {
    FaceSet faces = pieces_.faces;
    if (way.cut) {
      const Result<FaceSet> cut = splitFaces(faces, way.fuzzy);
      if (!cut) return tl::unexpected(cut.error());
      faces.clear();
      for (const TopoDS_Face& piece : *cut)
        if (onBoundary(piece)) faces.push_back(piece);
    }
    if (!edgeUse(faces).closed()) faces = sewn(faces, way.sewing);
    const EdgeUse use = edgeUse(faces);
    if (!use.closed())
      return fail(ErrorCode::Failed, std::to_string(use.freeEdges + use.overusedEdges) +
                                         " edges of the thickened sheet stay open");
    return solidsOf(faces);
  }

 private:
  [[nodiscard]] bool onBoundary(const TopoDS_Face& piece) const {
    std::vector<double> errors;
    for (const FaceSample& s : interiorSamples(piece))
      errors.push_back(thick_.offBoundary(toVec3(s.point.XYZ())).error);
    if (errors.empty()) return false;
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle <= pieces_.tolerance;
  }

  static FaceSet sewn(const FaceSet& faces, double tolerance) {
    BRepBuilderAPI_Sewing sewing(tolerance);
    for (const TopoDS_Face& face : faces) sewing.Add(face);
    sewing.Perform();
    return facesOf(sewing.SewedShape());
  }

  /// Do most faces of a cell say that material lies on its side of them? Walls are not asked: a
  /// step from them leads along the border, where the sheet's triangles are not exact enough.
  [[nodiscard]] bool isMaterial(const TopoDS_Shape& cell) const {
    int yes = 0;
    int no = 0;
    const double step = kStep * pieces_.walls.thickness();
    for (const TopoDS_Face& face : facesOf(cell)) {
      const std::vector<FaceSample> samples = interiorSamples(face);
      if (samples.empty()) continue;
      const FaceSample& s = samples.front();
      if (!thick_.offBoundary(toVec3(s.point.XYZ())).farSide) continue;
      const TrueDistance::Foot foot =
          phi_.foot(toVec3(s.point.XYZ()) - step * toVec3(s.normal.Normalized().XYZ()));
      const double height = foot.sign * foot.distance;
      const bool within =
          !foot.beyondBorder && height > -pieces_.walls.inner && height < pieces_.walls.outer;
      ++(within ? yes : no);
    }
    return yes > no;
  }

  Result<TopoDS_Shape> solidsOf(const FaceSet& faces) const {
    const BRep_Builder builder;
    TopoDS_Compound solids;
    builder.MakeCompound(solids);
    int count = 0;
    for (const TopoDS_Shape& cell :
         cellsOf(std::vector<TopoDS_Shape>(faces.begin(), faces.end()))) {
      if (!isMaterial(cell)) continue;
      builder.Add(solids, cell);
      ++count;
    }
    if (count == 0) return fail(ErrorCode::Failed, "the thickened sheet encloses nothing");
    return solids;
  }

  const ThickSheetPieces& pieces_;
  const TrueDistance& phi_;
  const ThickSheet thick_;
};

}  // namespace

Result<TopoDS_Shape> closeSheet(const ThickSheetPieces& pieces, const TrueDistance& phi,
                                const FreeBorder& border, const ClosingWay& way) {
  return Closer(pieces, phi, border).run(way);
}

}  // namespace phront::cad
