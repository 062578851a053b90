#include "carry_marks.h"

#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "exchange/guard.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/origin.h"
#include "tessellate/body_distance.h"

namespace phront::cad {
namespace {

constexpr double kTessellateSeconds = 10;
constexpr GuardLimits kLimits{.seconds = 20, .memoryMiB = 2000};

bool hasMarks(const Body& body) {
  return !body.faceColours.empty() || std::any_of(body.faceNames.begin(), body.faceNames.end(),
                                                  [](const std::string& n) { return !n.empty(); });
}

class MarkTable {
 public:
  MarkTable(const Body& in, const FeatureTable& features) : in_(in), features_(features) {}

  [[nodiscard]] std::string nameOf(const Feature& f) const {
    if (f.kind != FeatureKind::Face || f.id == kNone) return {};
    const auto i = static_cast<std::size_t>(f.id);
    return i < in_.faceNames.size() ? in_.faceNames[i] : std::string();
  }

  [[nodiscard]] std::optional<Colour> colourOf(const Feature& f) const {
    if (f.id == kNone || f.kind == FeatureKind::Vertex) return std::nullopt;
    if (f.kind == FeatureKind::Face) return ofFace(f.id);
    std::optional<Colour> common;
    bool first = true;
    for (const Index face : features_.edges[static_cast<std::size_t>(f.id)].faces) {
      const std::optional<Colour> colour = ofFace(face);
      if (!first && colour != common) return std::nullopt;
      common = colour;
      first = false;
    }
    return common;
  }

 private:
  [[nodiscard]] std::optional<Colour> ofFace(Index face) const {
    const auto i = static_cast<std::size_t>(face);
    return i < in_.faceColours.size() ? in_.faceColours[i] : std::nullopt;
  }

  const Body& in_;
  const FeatureTable& features_;
};

/// Two numbers a face: kind and id of its origin, all bodies' faces in their order.
Result<std::vector<int>> originsOf(const std::vector<Body>& out, const TrueDistance& phi) {
  const Result<std::string> bytes =
      runInChild("tracing faces back", kLimits, [&]() -> Result<std::string> {
        nlohmann::json json = nlohmann::json::array();
        for (const Body& body : out) {
          TopTools_IndexedMapOfShape faces;
          TopExp::MapShapes(occtShape(body.shape), TopAbs_FACE, faces);
          for (int f = 1; f <= faces.Extent(); ++f) {
            const Feature origin = originOf(TopoDS::Face(faces(f)), phi);
            json.push_back(static_cast<int>(origin.kind));
            json.push_back(origin.id);
          }
        }
        return json.dump();
      });
  if (!bytes) return tl::unexpected(bytes.error());
  return nlohmann::json::parse(*bytes).get<std::vector<int>>();
}

}  // namespace

void carryMarks(const Body& in, double distance, std::vector<Body>& out) {
  for (Body& body : out) {
    body.colour = in.colour;
    body.assembly = in.assembly;
  }
  if (!hasMarks(in)) return;
  const Result<TrueDistance> phi = distanceOf(in, distance, kTessellateSeconds);
  if (!phi) return;
  const Result<std::vector<int>> origins = originsOf(out, *phi);
  if (!origins) return;
  const MarkTable marks(in, phi->tessellation().features);
  std::size_t next = 0;
  for (Body& body : out) {
    const auto count = static_cast<std::size_t>(faceCount(body.shape));
    body.faceNames.assign(count, {});
    body.faceColours.assign(in.faceColours.empty() ? 0 : count, std::nullopt);
    for (std::size_t f = 0; f < count; ++f, next += 2) {
      const Feature origin{static_cast<FeatureKind>((*origins)[next]), (*origins)[next + 1]};
      body.faceNames[f] = marks.nameOf(origin);
      if (!body.faceColours.empty()) body.faceColours[f] = marks.colourOf(origin);
    }
  }
}

}  // namespace phront::cad
