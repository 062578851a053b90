#include <fmt/format.h>

#include "cli.h"
#include "phront/picture.h"

namespace phront::cli {
namespace {

// Fine enough for a picture: a pixel or less.
constexpr double kPictureDeflection = 5e-4;

}  // namespace

Result<void> drawMeshes(const TriMesh& in, const std::string& inCaption, const TriMesh& out,
                        const std::string& outCaption, const CommonOptions& options) {
  if (options.picture.empty()) return {};
  std::vector<PictureItem> items;
  items.push_back({.mesh = in, .caption = inCaption});
  if (!out.triangles.empty())
    items.push_back({.mesh = out, .caption = outCaption, .color = {0.86, 0.68, 0.47}});
  return writePicture(items, options.picture);
}

Result<void> drawModels(const cad::Model& in, const std::string& inCaption, const cad::Model& out,
                        const std::string& outCaption, const CommonOptions& options) {
  if (options.picture.empty()) return {};
  if (options.picture.empty()) return {};
  const double deflection = kPictureDeflection * boundingBox(in).diagonal().norm();
  const Result<TriMesh> inMesh = meshOfModel(in, deflection);
  if (!inMesh) return tl::unexpected(inMesh.error());
  const Result<TriMesh> outMesh = meshOfModel(out, deflection);
  if (!outMesh) return tl::unexpected(outMesh.error());
  return drawMeshes(*inMesh, inCaption, *outMesh, outCaption, options);
}

}  // namespace phront::cli
