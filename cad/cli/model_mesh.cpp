#include <fmt/format.h>

#include <algorithm>

#include "cli.h"
#include "phront/cad/tessellate.h"
#include "phront/mesh_io.h"

namespace phront::cli {

void appendMesh(TriMesh& all, const TriMesh& part) {
  const auto base = static_cast<Index>(all.points.size());
  Index label = 0;
  for (const Index face : all.faceOf) label = std::max(label, face + 1);
  all.points.insert(all.points.end(), part.points.begin(), part.points.end());
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    const auto& corner = part.triangles[t];
    all.triangles.push_back({corner[0] + base, corner[1] + base, corner[2] + base});
    all.faceOf.push_back(label + part.face(static_cast<Index>(t)));
  }
}

Result<TriMesh> readSurface(const std::filesystem::path& path, const CommonOptions& options) {
  Result<TriMesh> mesh = readMesh(path);
  if (!mesh) return mesh;
  OrientedMesh oriented = orient(std::move(*mesh));
  const MeshDiagnostics found = diagnose(oriented.mesh);
  if (oriented.turned > 0 && !options.quiet)
    fmt::print(stderr,
               "warning: {} triangle(s) disagreed with their neighbours; they were turned\n",
               oriented.turned);
  if (!found.closedManifold() && !options.quiet)
    fmt::print(stderr,
               "warning: the mesh is not a closed surface ({} free, {} non-manifold, {} "
               "misoriented edges, {} degenerate triangles)\n",
               found.freeEdges, found.nonManifoldEdges, found.misorientedEdges,
               found.degenerateTriangles);
  return std::move(oriented.mesh);
}

Result<TriMesh> meshOfModel(const cad::Model& model, double deflection) {
  TriMesh all;
  for (const cad::Body& body : model.bodies) {
    cad::TessellateOptions options;
    options.deflection = deflection;
    const Result<cad::Tessellation> part = cad::tessellate(body, options);
    if (!part) return tl::unexpected(part.error());
    appendMesh(all, part->mesh);
  }
  return all;
}

}  // namespace phront::cli
