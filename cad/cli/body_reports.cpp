#include "body_reports.h"

#include <fmt/format.h>

namespace phront::cli {
namespace {

const char* wordFor(cad::OffsetKind kind) {
  switch (kind) {
    case cad::OffsetKind::Exact:
      return "exact";
    case cad::OffsetKind::Faceted:
      return "faceted";
    case cad::OffsetKind::Empty:
      return "empty";
    case cad::OffsetKind::Failed:
      break;
  }
  return "failed";
}

}  // namespace

nlohmann::json jsonOf(const std::vector<cad::BodyReport>& bodies) {
  nlohmann::json json = nlohmann::json::array();
  for (const cad::BodyReport& body : bodies)
    json.push_back({{"name", body.name},
                    {"kind", wordFor(body.kind)},
                    {"input_faces", body.inputFaces},
                    {"exact_faces", body.exactFaces},
                    {"fitted_faces", body.fittedFaces},
                    {"faceted_faces", body.facetedFaces},
                    {"rounded_faces", body.roundedFaces},
                    {"solids", body.solids},
                    {"setting", body.setting},
                    {"attempts", body.attempts},
                    {"check", cli::jsonOf(body.check)}});
  return json;
}

nlohmann::json jsonOf(const std::vector<cad::StageTime>& times) {
  nlohmann::json json = nlohmann::json::object();
  for (const cad::StageTime& time : times) json[time.stage] = time.seconds;
  return json;
}

std::string facesOf(const std::vector<cad::BodyReport>& bodies, bool solid) {
  int exact = 0;
  int fitted = 0;
  int faceted = 0;
  for (const cad::BodyReport& body : bodies) {
    exact += body.exactFaces;
    fitted += body.fittedFaces;
    faceted += body.facetedFaces;
  }
  std::string text = fmt::format("{} exact faces", exact);
  if (fitted > 0)
    text += fmt::format(", {} fitted faces{}", fitted, solid ? " where exact ones left a gap" : "");
  if (faceted > 0) text += fmt::format(", {} planar facets in place of curved faces", faceted);
  return text;
}

void say(const CommonOptions& options, const std::string& sentence) {
  if (!options.quiet) fmt::print(stderr, "{}\n", sentence);
}

void sayDetails(const CommonOptions& options, const std::vector<cad::BodyReport>& bodies,
                const std::vector<cad::StageTime>& times) {
  if (!options.verbose) return;
  for (const cad::BodyReport& body : bodies)
    for (const std::string& attempt : body.attempts) say(options, "  " + attempt);
  for (const cad::StageTime& time : times)
    say(options, fmt::format("  {:<16}{:8.2f} s", time.stage, time.seconds));
}

Result<std::optional<double>> toleranceOf(const CommonOptions& options) {
  if (options.tolerance.empty()) return std::optional<double>();
  const Result<double> tolerance = parseLength(options.tolerance, options.unit);
  if (!tolerance) return tl::unexpected(tolerance.error());
  if (!(*tolerance > 0)) return fail(ErrorCode::InvalidArgument, "the tolerance must be positive");
  return std::optional<double>(*tolerance);
}

}  // namespace phront::cli
