// phront field IN -o OUT.vtu --spacing H
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "cli.h"
#include "phront/cad/exchange.h"
#include "phront/distance_field.h"
#include "phront/mesh_io.h"
#include "phront/surface_distance.h"

namespace phront::cli {
namespace {

// Band on both sides when none is given: the nodes a front needs on its way.
constexpr double kDefaultBandCells = 3;
// Triangles must not be coarser than what the grid can show.
constexpr double kDeflectionOfSpacing = 0.02;

struct FieldArguments {
  std::filesystem::path in;
  std::filesystem::path out;
  std::string spacing;
  std::string band;
  std::string solver = "exact";
  CommonOptions common;
};

Result<TriMesh> surfaceOf(const FieldArguments& arguments, double spacing) {
  if (isMeshPath(arguments.in)) return readSurface(arguments.in, arguments.common);
  const Result<cad::Model> model = cad::readModel(arguments.in);
  if (!model) return tl::unexpected(model.error());
  for (const std::string& warning : model->warnings)
    if (!arguments.common.quiet) fmt::print(stderr, "warning: {}\n", warning);
  return meshOfModel(*model, kDeflectionOfSpacing * spacing);
}

int runField(const FieldArguments& arguments) {
  const CommonOptions& common = arguments.common;
  const Result<double> spacing = parseLength(arguments.spacing, common.unit);
  if (!spacing) return reportError(spacing.error());
  if (!(*spacing > 0)) return reportUsage("the spacing must be positive");
  double band = kDefaultBandCells * *spacing;
  if (!arguments.band.empty()) {
    const Result<double> given = parseLength(arguments.band, common.unit);
    if (!given) return reportError(given.error());
    if (!(*given > 0)) return reportUsage("the band must be positive");
    band = *given;
  }
  const Result<MeshFormat> format = meshFormatOf(arguments.out);
  if (!format || *format != MeshFormat::Vtu)
    return reportUsage("a field is written as .vtu; name the output so");
  if (const Result<void> ok = checkOutputPath(arguments.out, arguments.in); !ok)
    return reportError(ok.error());
  Result<TriMesh> mesh = surfaceOf(arguments, *spacing);
  if (!mesh) return reportError(mesh.error());
  const Result<SurfaceDistance> surface =
      SurfaceDistance::build(std::move(*mesh), SignRule::Topology, *spacing);
  if (!surface) return reportError(surface.error());
  FieldOptions options;
  if (arguments.solver == "godunov") options.solver = FieldSolver::Godunov;
  options.spacing = *spacing;
  options.bandMin = -band;
  options.bandMax = band;
  options.threads = common.threads;
  const Result<DistanceField> field =
      solveDistanceField(*surface, options, makeProgress(common).part(0, 1, "field"));
  endProgress(common);
  if (!field) return reportError(field.error());
  if (field->signRepairs() > 0 && !common.quiet)
    fmt::print(stderr,
               "warning: the surface intersects itself; {} nodes have the sign of its winding "
               "number\n",
               field->signRepairs());
  if (const Result<void> ok = writeField(*field, arguments.out); !ok)
    return reportError(ok.error());
  const std::size_t nodes = field->values().size();
  if (!common.quiet)
    fmt::print(stderr, "{}: {} tiles, {} nodes, band +-{:g} mm, spacing {:g} mm\n",
               arguments.out.string(), field->tiles().size(), nodes, band, *spacing);
  const Result<void> written = writeReport(
      {{"tiles", field->tiles().size()}, {"nodes", nodes}, {"spacing", *spacing}, {"band", band}},
      common);
  return written ? kDone : reportError(written.error());
}

}  // namespace

void addFieldCommand(CLI::App& app, int& exitCode) {
  CLI::App* command =
      app.add_subcommand("field", "Signed distance on sparse grid tiles around the surface");
  auto arguments = std::make_shared<FieldArguments>();
  command->add_option("IN", arguments->in, "Part or mesh")->required();
  command->add_option("-o,--output", arguments->out, "Output .vtu")->required();
  command->add_option("--spacing", arguments->spacing, "Grid spacing h")->required();
  command->add_option("--band", arguments->band, "Half width of the band; default 3 h");
  command
      ->add_option(
          "--solver", arguments->solver,
          "exact: closest triangle of every node; godunov: fast sweeping from exact values "
          "near the surface, first order")
      ->check(CLI::IsMember({"exact", "godunov"}));
  addCommonOptions(*command, arguments->common);
  command->callback([arguments, &exitCode] { exitCode = runField(*arguments); });
}

}  // namespace phront::cli
