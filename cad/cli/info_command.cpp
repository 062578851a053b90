// phront info IN
#include <fmt/format.h>

#include <map>
#include <memory>

#include "cli.h"
#include "phront/cad/exchange.h"
#include "phront/cad/tessellate.h"
#include "phront/mesh_io.h"

namespace phront::cli {
namespace {

// Coarse: areas and counts for a listing, not geometry.
constexpr double kInfoDeflection = 1e-3;

struct InfoArguments {
  std::filesystem::path in;
  CommonOptions common;
};

const char* wordFor(cad::EdgeType type) {
  static constexpr const char* kWords[] = {"smooth", "convex", "concave",
                                           "mixed",  "free",   "non-manifold"};
  return kWords[static_cast<int>(type)];
}

std::string sizeOf(const Box3& box) {
  const Vec3 size = box.sizes();
  return fmt::format("{:.6g} x {:.6g} x {:.6g} mm, diagonal {:.6g} mm", size.x(), size.y(),
                     size.z(), size.norm());
}

int finish(const nlohmann::json& report, const CommonOptions& common) {
  const Result<void> written = writeReport(report, common);
  return written ? kDone : reportError(written.error());
}

int infoOfMesh(const InfoArguments& arguments, bool talk) {
  const Result<TriMesh> mesh = readMesh(arguments.in);
  if (!mesh) return reportError(mesh.error());
  const MeshDiagnostics found = diagnose(*mesh);
  const Vec3 size = boundingBox(*mesh).sizes();
  if (talk) {
    fmt::print("mesh: {} points, {} triangles, {} component(s), {}\n", mesh->points.size(),
               mesh->triangles.size(), found.components,
               found.closedManifold() ? "closed manifold" : "NOT a closed manifold");
    fmt::print("size {:.6g} x {:.6g} x {:.6g}, area {:.6g}, volume {:.6g}\n", size.x(), size.y(),
               size.z(), area(*mesh), signedVolume(*mesh));
    if (!found.closedManifold())
      fmt::print("{} free, {} non-manifold, {} misoriented edges; {} degenerate triangles\n",
                 found.freeEdges, found.nonManifoldEdges, found.misorientedEdges,
                 found.degenerateTriangles);
  }
  return finish({{"kind", "mesh"},
                 {"points", mesh->points.size()},
                 {"triangles", mesh->triangles.size()},
                 {"components", found.components},
                 {"closed_manifold", found.closedManifold()},
                 {"free_edges", found.freeEdges},
                 {"non_manifold_edges", found.nonManifoldEdges},
                 {"area", area(*mesh)},
                 {"volume", signedVolume(*mesh)}},
                arguments.common);
}

/// The assemblies that the body hangs in, the outermost first.
std::string placeOf(const cad::Model& model, const cad::Body& body) {
  std::string place;
  for (int a = body.assembly; a >= 0;) {
    const cad::AssemblyNode& node = model.assemblies[static_cast<std::size_t>(a)];
    place = node.name + (place.empty() ? "" : "/" + place);
    a = node.parent;
  }
  return place;
}

nlohmann::json infoOfBody(const cad::Model& model, std::size_t index, int& faceNumber,
                          const InfoArguments& arguments, bool talk) {
  const cad::Body& body = model.bodies[index];
  const std::size_t number = index + 1;
  const std::string place = placeOf(model, body);
  const Box3 box = boundingBox(body.shape);
  const char* kind = body.kind == cad::BodyKind::Solid ? "solid" : "sheet";
  nlohmann::json json = {{"name", body.name},
                         {"assembly", place},
                         {"kind", kind},
                         {"faces", nlohmann::json::array()},
                         {"diagonal_mm", box.diagonal().norm()}};
  if (talk)
    fmt::print("body {}: {} {}{}{} faces, {}\n", number, kind,
               body.name.empty() ? "" : "'" + body.name + "', ",
               place.empty() ? "" : "in '" + place + "', ", faceCount(body.shape), sizeOf(box));
  cad::TessellateOptions options;
  options.deflection = kInfoDeflection * box.diagonal().norm();
  const Result<cad::Tessellation> mesh = cad::tessellate(body, options);
  if (!mesh) {
    fmt::print(stderr, "phront: body {}: {}\n", number, mesh.error().message);
    faceNumber += faceCount(body.shape);
    return json;
  }
  std::map<std::string, int> edges;
  for (const cad::EdgeFeature& edge : mesh->features.edges) ++edges[wordFor(edge.type)];
  json["edges"] = edges;
  json["closed"] = diagnose(mesh->mesh).closedManifold();
  json["volume_mm3"] = signedVolume(mesh->mesh);
  std::map<std::string, int> types;
  std::string list;
  for (const cad::FaceFeature& face : mesh->features.faces) {
    ++types[cli::wordFor(face.type)];
    const std::string name = fmt::format("F{}", ++faceNumber);
    json["faces"].push_back({{"id", name},
                             {"type", cli::wordFor(face.type)},
                             {"area_mm2", face.area},
                             {"name", face.name}});
    list += fmt::format("    {:<6}{:<12}{:>14.6g} mm2  {}\n", name, cli::wordFor(face.type),
                        face.area, face.name);
  }
  if (talk) {
    const auto counts = [](const std::map<std::string, int>& words) {
      std::string text;
      for (const auto& [word, count] : words)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, word);
      return text;
    };
    fmt::print("  faces: {}\n  edges: {}\n  {}, volume about {:.6g} mm3\n", counts(types),
               counts(edges), json["closed"].get<bool>() ? "closed" : "not closed",
               json["volume_mm3"].get<double>());
    if (arguments.common.verbose) fmt::print("{}", list);
  }
  return json;
}

int runInfo(const InfoArguments& arguments) {
  const bool talk = arguments.common.report != "-" && !arguments.common.quiet;
  if (isMeshPath(arguments.in)) return infoOfMesh(arguments, talk);
  const Result<cad::Model> model = cad::readModel(arguments.in);
  if (!model) return reportError(model.error());
  for (const std::string& warning : model->warnings) fmt::print(stderr, "warning: {}\n", warning);
  const Box3 box = boundingBox(*model);
  if (talk)
    fmt::print("{}: {} body(ies), unit {} (1 {} = {:g} mm), {}\n", arguments.in.filename().string(),
               model->bodies.size(), model->unit, model->unit, model->unitInMm, sizeOf(box));
  nlohmann::json bodies = nlohmann::json::array();
  int faceNumber = 0;
  for (std::size_t i = 0; i < model->bodies.size(); ++i)
    bodies.push_back(infoOfBody(*model, i, faceNumber, arguments, talk));
  if (talk && !arguments.common.verbose) fmt::print("(-v lists every face)\n");
  if (const Result<void> ok =
          drawModels(*model, arguments.in.filename().string(), cad::Model(), "", arguments.common);
      !ok)
    return reportError(ok.error());
  return finish({{"kind", "model"},
                 {"unit", model->unit},
                 {"unit_in_mm", model->unitInMm},
                 {"diagonal_mm", box.diagonal().norm()},
                 {"bodies", bodies},
                 {"warnings", model->warnings}},
                arguments.common);
}

}  // namespace

void addInfoCommand(CLI::App& app, int& exitCode) {
  CLI::App* command =
      app.add_subcommand("info", "What is in a file: bodies, faces with their names, edges, size");
  auto arguments = std::make_shared<InfoArguments>();
  command->add_option("IN", arguments->in, "Input file")->required();
  addCommonOptions(*command, arguments->common);
  command->callback([arguments, &exitCode] { exitCode = runInfo(*arguments); });
}

}  // namespace phront::cli
