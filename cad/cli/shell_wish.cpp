#include "shell_wish.h"

#include "body_reports.h"
#include "phront/cad/select_faces.h"

namespace phront::cli {

CLI::Option* addShellWish(CLI::App& command, ShellWish& wish) {
  command.add_option("--open", wish.open,
                     "Shell: faces left open: F3,F7 (see info -v), name:lid*, normal:+z, "
                     "area:max");
  command
      .add_option(
          "--side", wish.side,
          "Shell: where the wall lies: inside of the faces (of a sheet: against its normals), "
          "outside, half on either side")
      ->check(CLI::IsMember({"in", "out", "both"}))
      ->capture_default_str();
  return command.add_option("-t,--thickness", wish.thickness, "Shell: thickness of the wall");
}

Result<cad::ShellOptions> resolve(const ShellWish& wish, const FaceWish& faces,
                                  const cad::Model& model, const CommonOptions& common) {
  cad::ShellOptions options;
  const Result<double> thickness = parseLength(wish.thickness, common.unit);
  if (!thickness) return tl::unexpected(thickness.error());
  const Result<std::optional<double>> tolerance = toleranceOf(common);
  if (!tolerance) return tl::unexpected(tolerance.error());
  options.thickness = *thickness;
  options.tolerance = *tolerance;
  options.threads = common.threads;
  if (wish.side == "out") options.side = cad::ShellSide::Out;
  if (wish.side == "both") options.side = cad::ShellSide::Both;
  const Result<std::vector<FaceLength>> own = resolve(faces, model, common);
  if (!own) return tl::unexpected(own.error());
  for (const FaceLength& face : *own) options.thicknessOf.push_back({face.face, face.length});
  if (wish.open.empty()) return options;
  Result<std::vector<cad::FaceId>> open = cad::selectFaces(model, wish.open);
  if (!open) return tl::unexpected(open.error());
  options.open = std::move(*open);
  return options;
}

}  // namespace phront::cli
