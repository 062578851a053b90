// From a body to one labelled mesh: OpenCASCADE triangulates faces, topology merges them, holes are
// filled, sides halved until they are near enough, labels come from the feature table. All of it
// runs in a guarded child process; the shape of the caller is never touched.
//
// Weak spots: a face whose triangulation fails is replaced by the minimal-area patch over its
// border (counted, refused where it is another shape, else visible in the measured deflection);
// gaps between edges and surfaces of a loose B-Rep stay in the mesh, hence the deflection is
// measured.
#include "phront/cad/tessellate.h"

#include <fmt/format.h>

#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <map>

#include "exchange/guard.h"
#include "phront/cad/shape_occt.h"
#include "tessellate/close_mesh.h"
#include "tessellate/features.h"
#include "tessellate/refine.h"
#include "tessellate/tessellation_bytes.h"

namespace phront::cad {
namespace {

constexpr double kMemoryLimit = 6144;  // MiB
constexpr double kCoarser = 8;  // of the deflection, each time a try takes too long or crashes
constexpr double kDefaultSmoothAngle = 1e-3;   // rad, when no distance is given
constexpr double kPlaneTolerance = 1e-7;       // of the diagonal
constexpr double kLeastDeflection = 2e-7;      // mm; OpenCASCADE refuses 1e-7 and less
constexpr double kOffFilling = 10;             // times the deflection: fillings worth finer sides,
constexpr double kFiner = 4;                   // by so much
constexpr double kWidestFilling = 0.01;        // of the diagonal: farther off it is another shape
constexpr std::size_t kMeasured = 20000;       // triangles measured on the whole body, and
constexpr std::size_t kMeasuredPerFace = 100;  // at least so many on each face

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Box3 boxOf(const ShapeMesh& mesh) {
  Box3 box;
  for (const FaceMesh& face : mesh.faces) {
    for (const Vec3& p : face.nodes) box.extend(p);
  }
  return box;
}

// The face a patch stands for: a face without triangles on its border if there is one, else the
// face met most often around it.
Index faceOfPatch(const HolePatch& patch, const ShapeIndex& index, const ShapeMesh& mesh) {
  std::map<Index, int> votes;
  for (std::size_t i = 0; i < patch.edges.size(); ++i) {
    if (patch.faces[i] != kNone) ++votes[patch.faces[i]];
    if (patch.edges[i] == kNone) continue;
    for (const EdgeUse& use : index.uses[at(patch.edges[i])]) {
      const bool failed =
          std::find(mesh.failed.begin(), mesh.failed.end(), use.faceIndex) != mesh.failed.end();
      if (failed) votes[use.faceIndex] += static_cast<int>(4 * patch.edges.size());
    }
  }
  Index best = 0;
  int most = -1;
  for (const auto& [face, count] : votes) {
    if (count <= most) continue;
    most = count;
    best = face;
  }
  return best;
}

// Parameters of a point on a patch: along the face's own curve where the side lies on one of its
// edges, else by projection.
Eigen::Vector2d patchUv(const Soup& soup, const SoupTriangle& t, std::size_t corner,
                        const ShapeIndex& index) {
  const SideLabel& out = t.side[corner];
  const SideLabel& in = t.side[(corner + 2) % 3];
  for (const auto& [edge, parameter] :
       {std::pair(out.edge, out.first), std::pair(in.edge, in.last)}) {
    if (edge == kNone) continue;
    for (const EdgeUse& use : index.uses[at(edge)]) {
      if (use.faceIndex != t.face) continue;
      double first = 0;
      double last = 0;
      const Handle(Geom2d_Curve) pcurve =
          BRep_Tool::CurveOnSurface(use.edge, use.face, first, last);
      if (pcurve.IsNull()) continue;
      const gp_Pnt2d uv = pcurve->Value(std::clamp(parameter, first, last));
      return {uv.X(), uv.Y()};
    }
  }
  const TopoDS_Face& face = TopoDS::Face(index.maps.faces(t.face + 1));
  ShapeAnalysis_Surface surface(BRep_Tool::Surface(face));
  const gp_Pnt2d uv =
      surface.ValueOfUV(toPnt(soup.points[at(t.corner[corner])]), BRep_Tool::Tolerance(face));
  return {uv.X(), uv.Y()};
}

void labelPatches(Soup& soup, const std::vector<HolePatch>& patches, const ShapeIndex& index,
                  const ShapeMesh& mesh) {
  std::vector<Index> faces;
  for (const HolePatch& patch : patches) faces.push_back(faceOfPatch(patch, index, mesh));
  for (SoupTriangle& t : soup.triangles) {
    if (t.patch == kNone) continue;
    t.face = faces[at(t.patch)];
    for (std::size_t k = 0; k < 3; ++k) t.uv[k] = patchUv(soup, t, k, index);
  }
}

void measureDeflection(const Soup& soup, const ShapeIndex& index, double tolerance,
                       Tessellation& tessellation) {
  std::vector<std::vector<std::size_t>> ofFace(index.surfaces.size());
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    ofFace[at(soup.triangles[t].face)].push_back(t);
  }
  const std::size_t perFace =
      std::max(kMeasuredPerFace, kMeasured / std::max<std::size_t>(1, ofFace.size()));
  for (std::size_t f = 0; f < ofFace.size(); ++f) {
    FaceFeature& feature = tessellation.features.faces[f];
    const std::size_t stride = 1 + ofFace[f].size() / perFace;
    for (std::size_t i = 0; i < ofFace[f].size(); i += stride) {
      const SoupTriangle& t = soup.triangles[ofFace[f][i]];
      const auto p = [&](std::size_t k) { return soup.points[at(t.corner[k % 3])]; };
      const auto sample = [&](const Vec3& weights) {
        const Vec3 x = weights[0] * p(0) + weights[1] * p(1) + weights[2] * p(2);
        const Eigen::Vector2d uv =
            weights[0] * t.uv[0] + weights[1] * t.uv[1] + weights[2] * t.uv[2];
        feature.deflection =
            std::max(feature.deflection, deviation(*index.surfaces[f], x, uv, tolerance));
      };
      sample(Vec3::Constant(1.0 / 3.0));
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3 weights = Vec3::Constant(0.5);
        weights[static_cast<Eigen::Index>(k)] = 0;
        sample(weights);
      }
    }
    tessellation.measuredDeflection = std::max(tessellation.measuredDeflection, feature.deflection);
  }
}

void fillMesh(const Soup& soup, const ShapeFeatures& features, Tessellation& result) {
  TriMesh& mesh = result.mesh;
  mesh.points = soup.points;
  for (const Index v : soup.vertexOf) {
    mesh.vertexOf.push_back(v != kNone && features.sharpVertex[at(v)] ? v : kNone);
  }
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const SoupTriangle& triangle = soup.triangles[t];
    mesh.triangles.push_back(triangle.corner);
    mesh.faceOf.push_back(triangle.face);
    result.uv.push_back(triangle.uv);
    const auto p = [&](std::size_t k) { return soup.points[at(triangle.corner[k % 3])]; };
    result.features.faces[at(triangle.face)].area += 0.5 * (p(1) - p(0)).cross(p(2) - p(0)).norm();
    for (std::size_t k = 0; k < 3; ++k) {
      const SideLabel& side = triangle.side[k];
      const bool sharp = side.edge != kNone && isSharp(features.table.edges[at(side.edge)].type);
      mesh.edgeOf.push_back(sharp ? side.edge : kNone);
      if (side.edge == kNone) continue;
      result.edgeSides.push_back(
          {static_cast<Index>(t), static_cast<Index>(k), side.edge, side.first, side.last});
    }
  }
}

// Lengths of the edges' polygons, taken from the first face that has one.
void measureLengths(const ShapeMesh& mesh, FeatureTable& table) {
  for (const FaceMesh& face : mesh.faces) {
    for (const EdgePolygon& polygon : face.polygons) {
      EdgeFeature& edge = table.edges[at(polygon.edge)];
      if (edge.length > 0) continue;
      for (std::size_t k = 0; k + 1 < polygon.nodes.size(); ++k) {
        edge.length +=
            (face.nodes[at(polygon.nodes[k + 1])] - face.nodes[at(polygon.nodes[k])]).norm();
      }
    }
  }
}

Result<Tessellation> tessellateHere(const TopoDS_Shape& shape, bool solid,
                                    const TessellateOptions& options, double deflection) {
  const ShapeIndex index(shape);
  const ShapeMesh mesh =
      meshShape(shape, index.maps, std::max(deflection, kLeastDeflection), options.angle);
  const Box3 box = boxOf(mesh);
  if (box.isEmpty()) {
    return fail(ErrorCode::Failed, "No face of the body can be tessellated.");
  }
  const double diagonal = box.diagonal().norm();

  std::vector<double> edgeTolerance;
  std::vector<bool> mustClose;
  for (int e = 1; e <= index.maps.edges.Extent(); ++e) {
    edgeTolerance.push_back(BRep_Tool::Tolerance(TopoDS::Edge(index.maps.edges(e))));
    mustClose.push_back(solid || index.uses[at(e - 1)].size() > 1);
  }
  Soup soup = mergeNodes(mesh, edgeTolerance, index.maps.vertices.Extent());
  const std::vector<HolePatch> patches = closeMesh(soup, mustClose);
  if (soup.triangles.empty()) {
    return fail(ErrorCode::Failed, "No face of the body can be tessellated.");
  }
  labelPatches(soup, patches, index, mesh);
  refine(soup, index, deflection);

  FeatureOptions featureOptions;
  featureOptions.smoothAngle =
      options.distance > 0 ? options.smoothTolerance / options.distance : kDefaultSmoothAngle;
  featureOptions.planeTolerance = kPlaneTolerance * diagonal;
  ShapeFeatures features = shapeFeatures(index, featureOptions);

  Tessellation result;
  result.features = features.table;
  result.untessellatedFaces = static_cast<int>(mesh.failed.size());
  result.filledHoles = static_cast<int>(patches.size());
  fillMesh(soup, features, result);
  measureLengths(mesh, result.features);
  measureDeflection(soup, index, 1e-3 * deflection, result);
  return result;
}

/// A mesher that loses part of a thin face leaves holes whose filling is far off; finer sides help.
Result<Tessellation> tessellateSoundly(const TopoDS_Shape& shape, bool solid,
                                       const TessellateOptions& options, double deflection) {
  Result<Tessellation> best = tessellateHere(shape, solid, options, deflection);
  const auto isOff = [&] {
    return best && best->filledHoles > 0 && best->measuredDeflection > kOffFilling * deflection;
  };
  for (const double finer : {kFiner, kFiner * kFiner}) {
    if (!isOff()) return best;
    Result<Tessellation> again = tessellateHere(shape, solid, options, deflection / finer);
    if (again && again->measuredDeflection < best->measuredDeflection) best = std::move(again);
  }
  if (!isOff()) return best;
  Box3 box;
  for (const Vec3& p : best->mesh.points) box.extend(p);
  const std::vector<FaceFeature>& faces = best->features.faces;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (faces[f].deflection > kWidestFilling * box.diagonal().norm())
      return fail(ErrorCode::Failed,
                  fmt::format("The triangles of face F{} ({:.3g} mm2) or of one beside it do not "
                              "close, and what fills the hole is {:.3g} mm off its surface.",
                              f + 1, faces[f].area, faces[f].deflection));
  }
  return best;
}

}  // namespace

Result<Tessellation> tessellate(const Body& body, const TessellateOptions& options) {
  if (body.shape.empty()) return fail(ErrorCode::InvalidArgument, "The body has no shape.");
  if (!(options.deflection > 0) || !std::isfinite(options.deflection)) {
    return fail(ErrorCode::InvalidArgument, "The deflection must be a positive length in mm.");
  }
  if (!(options.angle > 0) || !std::isfinite(options.angle)) {
    return fail(ErrorCode::InvalidArgument, "The angle must be positive, in radians.");
  }
  if (!(options.distance >= 0) || !(options.smoothTolerance >= 0)) {
    return fail(ErrorCode::InvalidArgument,
                "The distance and the smooth tolerance must not be negative.");
  }
  Result<std::string> bytes = fail(ErrorCode::Failed, "not tried");
  for (const double factor : {1.0, kCoarser, kCoarser * kCoarser}) {
    bytes =
        runInChild("tessellating", {options.timeLimit, kMemoryLimit}, [&]() -> Result<std::string> {
          return guardOcct("tessellating", [&]() -> Result<std::string> {
            const auto here = tessellateSoundly(occtShape(body.shape), body.kind == BodyKind::Solid,
                                                options, factor * options.deflection);
            if (!here) return tl::unexpected(here.error());
            return bytesOfTessellation(*here);
          });
        });
    if (bytes) break;
  }
  if (!bytes) return tl::unexpected(bytes.error());
  Result<Tessellation> result = tessellationOfBytes(*bytes);
  if (!result) return result;
  for (std::size_t f = 0; f < result->features.faces.size() && f < body.faceNames.size(); ++f) {
    result->features.faces[f].name = body.faceNames[f];
  }
  return result;
}

}  // namespace phront::cad
