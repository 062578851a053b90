#include "phront/cad/select_faces.h"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <charconv>
#include <gp_Dir.hxx>
#include <gp_Pln.hxx>
#include <optional>
#include <string_view>

#include "exchange/measures.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

constexpr double kNormalAngle = 1e-3;  // rad, between a face's normal and the axis asked for

struct NamedFace {
  FaceId id;
  TopoDS_Face face;
  std::string name;
};

std::vector<NamedFace> facesOfModel(const Model& model) {
  std::vector<NamedFace> faces;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Body& body = model.bodies[b];
    TopTools_IndexedMapOfShape map;
    TopExp::MapShapes(occtShape(body.shape), TopAbs_FACE, map);
    for (int f = 0; f < map.Extent(); ++f) {
      const auto i = static_cast<std::size_t>(f);
      faces.push_back({{b, f},
                       TopoDS::Face(map(f + 1)),
                       i < body.faceNames.size() ? body.faceNames[i] : std::string()});
    }
  }
  return faces;
}

/// '*' stands for any characters, none included.
bool matches(std::string_view pattern, std::string_view text) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == text;
  if (text.substr(0, star) != pattern.substr(0, star)) return false;
  const std::string_view rest = pattern.substr(star + 1);
  for (std::size_t skip = star; skip <= text.size(); ++skip)
    if (matches(rest, text.substr(skip))) return true;
  return false;
}

std::optional<gp_Dir> axisOf(std::string_view word) {
  if (word.size() != 2 || (word[0] != '+' && word[0] != '-')) return std::nullopt;
  const double sign = word[0] == '+' ? 1 : -1;
  if (word[1] == 'x') return gp_Dir(sign, 0, 0);
  if (word[1] == 'y') return gp_Dir(0, sign, 0);
  if (word[1] == 'z') return gp_Dir(0, 0, sign);
  return std::nullopt;
}

bool faces(const TopoDS_Face& face, const gp_Dir& axis) {
  const BRepAdaptor_Surface surface(face);
  if (surface.GetType() != GeomAbs_Plane) return false;
  const gp_Pln plane = surface.Plane();
  gp_Dir normal = plane.Axis().Direction();
  if (!plane.Direct()) normal.Reverse();
  if (face.Orientation() == TopAbs_REVERSED) normal.Reverse();
  return normal.Angle(axis) < kNormalAngle;
}

/// Marks what one term names; false when it is not understood.
bool mark(std::string_view term, const std::vector<NamedFace>& all, std::vector<bool>& chosen) {
  const std::size_t colon = term.find(':');
  const std::string_view key = term.substr(0, colon);
  const std::string_view value = colon == std::string_view::npos ? "" : term.substr(colon + 1);
  if (colon == std::string_view::npos && term.size() > 1 && term[0] == 'F') {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(term.data() + 1, term.data() + term.size(), number);
    if (error != std::errc() || end != term.data() + term.size()) return false;
    if (number >= 1 && number <= all.size()) chosen[number - 1] = true;
    return true;
  }
  if (key == "name") {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (!all[i].name.empty() && matches(value, all[i].name)) chosen[i] = true;
    return true;
  }
  if (key == "normal") {
    const std::optional<gp_Dir> axis = axisOf(value);
    if (!axis) return false;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (faces(all[i].face, *axis)) chosen[i] = true;
    return true;
  }
  if (term == "area:max") {
    std::optional<std::size_t> largest;
    double most = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double area = areaOf(all[i].face);
      if (largest && area <= most) continue;
      largest = i;
      most = area;
    }
    if (largest) chosen[*largest] = true;
    return true;
  }
  return false;
}

}  // namespace

Result<std::vector<FaceId>> selectFaces(const Model& model, const std::string& terms) {
  const std::vector<NamedFace> all = facesOfModel(model);
  std::vector<bool> chosen(all.size());
  for (std::size_t begin = 0; begin <= terms.size();) {
    const std::size_t end = std::min(terms.find(',', begin), terms.size());
    const std::string term = terms.substr(begin, end - begin);
    begin = end + 1;
    std::vector<bool> named(all.size());
    if (!mark(term, all, named)) {
      return fail(
          ErrorCode::InvalidArgument,
          fmt::format("'{}' names no faces: write F<number> as `phront info -v` lists them, "
                      "name:TEXT, normal:+z or area:max",
                      term));
    }
    if (std::find(named.begin(), named.end(), true) == named.end()) {
      return fail(
          ErrorCode::InvalidArgument,
          fmt::format("no face of the model is '{}'; it has {} faces, `phront info -v` lists "
                      "them",
                      term, all.size()));
    }
    for (std::size_t i = 0; i < all.size(); ++i)
      if (named[i]) chosen[i] = true;
  }
  std::vector<FaceId> ids;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (chosen[i]) ids.push_back(all[i].id);
  return ids;
}

}  // namespace phront::cad
