#include "phront/cad/move_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "move/move_group.h"
#include "patches/edge_table.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

constexpr GuardLimits kLimits{.seconds = 30, .memoryMiB = 3000};

using Distances = std::map<int, double>;  ///< by 0-based face

Result<std::vector<Distances>> byBody(const Model& model, const std::vector<FaceMove>& moves) {
  std::vector<Distances> all(model.bodies.size());
  for (const FaceMove& move : moves) {
    const FaceId& id = move.face;
    if (id.body >= model.bodies.size() || id.face < 0 ||
        id.face >= faceCount(model.bodies[id.body].shape))
      return fail(ErrorCode::InvalidArgument, "a face to be moved is not in the model");
    if (model.bodies[id.body].kind != BodyKind::Solid)
      return fail(ErrorCode::InvalidArgument,
                  "a face to be moved belongs to a sheet; only faces of solids can be");
    if (!std::isfinite(move.distance))
      return fail(ErrorCode::InvalidArgument, "the distance of a face must be a number");
    const auto [known, isNew] = all[id.body].emplace(id.face, move.distance);
    if (!isNew && known->second != move.distance)
      return fail(ErrorCode::InvalidArgument, "a face is given two distances");
  }
  for (Distances& body : all)
    std::erase_if(body, [](const auto& move) { return move.second == 0; });
  return all;
}

/// Faces of one distance that go on smoothly into one another.
std::vector<std::vector<int>> smoothGroups(const TopoDS_Shape& solid, const Distances& distances) {
  std::map<int, int> root;
  for (const auto& [face, distance] : distances) root[face] = face;
  const auto rootOf = [&](int face) {
    while (root[face] != face) face = root[face];
    return face;
  };
  for (const EdgeInfo& edge : makeEdgeTable(solid, 1, kSmoothNeighbours).edges) {
    const auto first = distances.find(edge.face1);
    const auto second = distances.find(edge.face2);
    if (!edge.smooth || first == distances.end() || second == distances.end()) continue;
    if (first->second != second->second) continue;
    const int a = rootOf(edge.face1);
    const int b = rootOf(edge.face2);
    root[std::max(a, b)] = std::min(a, b);
  }
  std::map<int, std::vector<int>> groups;
  for (const auto& [face, distance] : distances) groups[rootOf(face)].push_back(face);
  std::vector<std::vector<int>> all;
  for (auto& [first, faces] : groups) all.push_back(std::move(faces));
  return all;
}

/// One group after the other: each finds the neighbours as those before have left them.
Result<MovedSolid> moveAll(const TopoDS_Shape& solid, const Distances& distances, int firstNumber) {
  MovedSolid now{solid, {}};
  now.origins.resize(static_cast<std::size_t>(faceCount(makeShape(solid))));
  std::iota(now.origins.begin(), now.origins.end(), 0);
  for (const std::vector<int>& group : smoothGroups(solid, distances)) {
    GroupMove move;
    move.distance = distances.at(group.front());
    const std::set<int> wanted(group.begin(), group.end());
    for (std::size_t f = 0; f < now.origins.size(); ++f) {
      if (wanted.count(now.origins[f]) > 0) move.faces.push_back(static_cast<int>(f));
      move.numbers.push_back(firstNumber + now.origins[f]);
    }
    if (move.faces.empty())
      return fail(ErrorCode::NotSupported,
                  fmt::format("face F{} cannot be moved: moving the others leaves nothing of it",
                              firstNumber + group.front()));
    Result<MovedSolid> next = moveGroup(now.solid, move);
    if (!next) return next;
    for (int& origin : next->origins) origin = now.origins[static_cast<std::size_t>(origin)];
    now = std::move(*next);
  }
  return now;
}

// Across the process border: origins as JSON, a line end, the shape.
Result<MovedSolid> moveInChild(const TopoDS_Shape& solid, const Distances& distances,
                               int firstNumber) {
  const Result<std::string> bytes =
      runInChild("moving faces", kLimits, [&]() -> Result<std::string> {
        const Result<MovedSolid> moved = moveAll(solid, distances, firstNumber);
        if (!moved) return tl::unexpected(moved.error());
        return nlohmann::json(moved->origins).dump() + "\n" + bytesOfShape(moved->solid);
      });
  if (!bytes) return tl::unexpected(bytes.error());
  const std::size_t end = bytes->find('\n');
  const Result<TopoDS_Shape> shape = shapeOfBytes(std::string_view(*bytes).substr(end + 1));
  if (!shape) return tl::unexpected(shape.error());
  return MovedSolid{*shape, nlohmann::json::parse(bytes->substr(0, end)).get<std::vector<int>>()};
}

template <class Mark>
std::vector<Mark> carried(const std::vector<Mark>& marks, const std::vector<int>& origins) {
  if (marks.empty()) return {};
  std::vector<Mark> moved;
  for (const int origin : origins) moved.push_back(marks[static_cast<std::size_t>(origin)]);
  return moved;
}

}  // namespace

Result<MovedModel> moveFaces(const Model& model, const std::vector<FaceMove>& moves) {
  const Result<std::vector<Distances>> distances = byBody(model, moves);
  if (!distances) return tl::unexpected(distances.error());
  MovedModel result{model, {}};
  int firstNumber = 1;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Body& body = model.bodies[b];
    const int faces = faceCount(body.shape);
    std::vector<int> origins(static_cast<std::size_t>(faces));
    std::iota(origins.begin(), origins.end(), 0);
    if (!(*distances)[b].empty()) {
      Result<MovedSolid> moved = moveInChild(occtShape(body.shape), (*distances)[b], firstNumber);
      if (!moved) return tl::unexpected(moved.error());
      origins = std::move(moved->origins);
      Body& target = result.model.bodies[b];
      target.shape = makeShape(moved->solid);
      target.faceNames = carried(body.faceNames, origins);
      target.faceColours = carried(body.faceColours, origins);
    }
    result.origins.push_back(std::move(origins));
    firstNumber += faces;
  }
  return result;
}

}  // namespace phront::cad
