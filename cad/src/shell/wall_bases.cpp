#include "shell/wall_bases.h"

#include <fmt/format.h>

#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <string>
#include <utility>

#include "patches/patch_tools.h"
#include "phront/cad/move_faces.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

constexpr double kBeyondOpening = 1.5;  // of the thickest wall: so far the part goes on

/// As the user counts faces: through the whole file.
std::string numberOf(const Model& model, const FaceId& id) {
  int number = id.face + 1;
  for (std::size_t b = 0; b < id.body; ++b) number += faceCount(model.bodies[b].shape);
  return fmt::format("F{}", number);
}

std::vector<FaceId> curvedOpenings(const Model& model, const ShellOptions& options) {
  std::vector<FaceId> curved;
  for (const FaceId& id : options.open) {
    const TopoDS_Shape& solid = occtShape(model.bodies[id.body].shape);
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(solid, TopAbs_FACE, faces);
    if (!isPlanar(TopoDS::Face(faces(id.face + 1)), diagonalOf(solid))) curved.push_back(id);
  }
  return curved;
}

/// The part with faces moved by what their walls on one side are thicker than the others'.
/// `share`: of all walls on that side; `outwards`: the side. Inwards it goes on beyond openings
/// that are not planar (`curved`): its neighbours are the walls that the cavity ends at there.
Result<MovedModel> baseModel(const Model& model, const ShellOptions& options,
                             const std::vector<FaceId>& curved, double share, bool outwards) {
  std::vector<FaceMove> moves;
  double thickest = options.thickness;
  for (const FaceThickness& own : options.thicknessOf) {
    const double more = share * (own.thickness - options.thickness);
    moves.push_back({own.face, outwards ? more : -more});
    thickest = std::max(thickest, own.thickness);
  }
  if (!outwards)
    for (const FaceId& id : curved) moves.push_back({id, kBeyondOpening * thickest});
  return moveFaces(model, moves);
}

/// Whether any face of the body moves.
bool hasOwnBase(const ShellOptions& options, const std::vector<FaceId>& curved, std::size_t body) {
  return std::any_of(curved.begin(), curved.end(),
                     [&](const FaceId& id) { return id.body == body; }) ||
         std::any_of(options.thicknessOf.begin(), options.thicknessOf.end(),
                     [&](const FaceThickness& own) { return own.face.body == body; });
}

}  // namespace

ShellWalls wallsOf(const ShellOptions& options) {
  switch (options.side) {
    case ShellSide::In:
      return {options.thickness, 0};
    case ShellSide::Out:
      return {0, options.thickness};
    case ShellSide::Both:
      break;
  }
  return {0.5 * options.thickness, 0.5 * options.thickness};
}

std::vector<int> openFacesOf(const ShellOptions& options, std::size_t body) {
  std::vector<int> faces;
  for (const FaceId& id : options.open)
    if (id.body == body) faces.push_back(id.face);
  return faces;
}

Result<std::vector<WallBases>> wallBasesOf(const Model& model, const ShellOptions& options) {
  std::vector<WallBases> all(model.bodies.size());
  const ShellWalls walls = wallsOf(options);
  const std::vector<FaceId> curved = curvedOpenings(model, options);
  if (!curved.empty() && walls.outer > 0)
    return fail(ErrorCode::NotSupported,
                fmt::format("face {} is left open and not planar: hollow inwards",
                            numberOf(model, curved.front())));
  if (options.thicknessOf.empty() && curved.empty()) return all;
  for (const bool outwards : {false, true}) {
    const double wall = outwards ? walls.outer : walls.inner;
    if (wall == 0) continue;
    Result<MovedModel> moved =
        baseModel(model, options, curved, wall / options.thickness, outwards);
    if (!moved) {
      Error error = moved.error();
      if (!curved.empty())
        error.message = fmt::format(
            "face {} is left open and not planar, and the part is to go on beyond it: {}",
            numberOf(model, curved.front()), error.message);
      return tl::unexpected(error);
    }
    for (std::size_t b = 0; b < all.size(); ++b) {
      if (!hasOwnBase(options, curved, b)) continue;
      const std::vector<int> open = openFacesOf(options, b);
      WallBase base{std::move(moved->model.bodies[b]), {}};
      const std::vector<int>& origins = moved->origins[b];
      for (std::size_t f = 0; f < origins.size(); ++f)
        if (std::find(open.begin(), open.end(), origins[f]) != open.end())
          base.open.push_back(static_cast<int>(f));
      (outwards ? all[b].outer : all[b].inner) = std::move(base);
    }
  }
  for (const FaceThickness& own : options.thicknessOf) {
    double& thickest = all[own.face.body].thickest;
    thickest = std::max(thickest, own.thickness);
  }
  return all;
}

}  // namespace phront::cad
