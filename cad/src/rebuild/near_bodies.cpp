#include "rebuild/near_bodies.h"

#include <fmt/format.h>

#include <BRepExtrema_ShapeProximity.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <numeric>

#include "exchange/guard.h"
#include "patches/patch_tools.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

// Triangles for the question whether two bodies are near: of d; rad. A pair that is as near as 2d
// up to this is put together, which is right for any distance.
constexpr double kDeflection = 0.02;
constexpr double kAngle = 0.5;
constexpr GuardLimits kLimits{10, 2000};

bool boxesNear(const Box3& a, const Box3& b, double gap) {
  return ((a.min().array() - gap) <= b.max().array()).all() &&
         ((b.min().array() - gap) <= a.max().array()).all();
}

// One character a pair of `pairs`: '1' where the two are near.
std::string nearness(const std::vector<Body>& bodies,
                     const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                     double distance) {
  const double deflection = kDeflection * distance;
  std::string near;
  for (const auto& [i, j] : pairs) {
    const TopoDS_Shape& a = occtShape(bodies[i].shape);
    const TopoDS_Shape& b = occtShape(bodies[j].shape);
    BRepMesh_IncrementalMesh(a, deflection, Standard_False, kAngle);
    BRepMesh_IncrementalMesh(b, deflection, Standard_False, kAngle);
    BRepExtrema_ShapeProximity proximity(a, b, 2 * distance + 2 * deflection);
    proximity.Perform();
    near += !proximity.IsDone() || !proximity.OverlapSubShapes1().IsEmpty() ? '1' : '0';
  }
  return near;
}

/// Names and colours of all members' faces, where no two members share a face.
void markJoint(Body& joint, const std::vector<Body>& bodies,
               const std::vector<std::size_t>& members) {
  joint.faceNames.clear();
  joint.faceColours.clear();
  joint.colour.reset();
  bool coloured = false;
  for (const std::size_t i : members) {
    const Body& body = bodies[i];
    const auto count = static_cast<std::size_t>(faceCount(body.shape));
    coloured = coloured || body.colour || !body.faceColours.empty();
    for (std::size_t f = 0; f < count; ++f) {
      const bool own = f < body.faceColours.size() && body.faceColours[f];
      joint.faceNames.push_back(f < body.faceNames.size() ? body.faceNames[f] : std::string());
      joint.faceColours.push_back(own ? body.faceColours[f] : body.colour);
    }
  }
  const bool shared = joint.faceNames.size() != static_cast<std::size_t>(faceCount(joint.shape));
  if (shared) joint.faceNames.clear();
  if (shared || !coloured) joint.faceColours.clear();
}

Body together(const std::vector<Body>& bodies, const std::vector<std::size_t>& members) {
  Body joint = bodies[members.front()];
  BRep_Builder builder;
  TopoDS_Compound compound;
  builder.MakeCompound(compound);
  for (const std::size_t i : members) {
    builder.Add(compound, occtShape(bodies[i].shape));
    joint.valid = joint.valid && bodies[i].valid;
    if (bodies[i].assembly != joint.assembly) joint.assembly = -1;
  }
  joint.shape = makeShape(compound);
  markJoint(joint, bodies, members);
  return joint;
}

}  // namespace

std::vector<Body> joinNearBodies(const std::vector<Body>& bodies, double distance,
                                 std::vector<std::string>& warnings) {
  if (distance < 0 || bodies.size() < 2) return bodies;
  std::vector<Box3> boxes;
  for (const Body& body : bodies) boxes.push_back(boundingBox(body.shape));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (bodies[i].kind == BodyKind::Solid && bodies[j].kind == BodyKind::Solid &&
          boxesNear(boxes[i], boxes[j], 2 * distance))
        pairs.emplace_back(i, j);
    }
  }
  if (pairs.empty()) return bodies;
  const Result<std::string> near =
      runInChild("measuring how near bodies are", kLimits,
                 [&]() -> Result<std::string> { return nearness(bodies, pairs, distance); });

  // Union-find: the least index of a group is its root.
  std::vector<std::size_t> root(bodies.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i];
    return i;
  };
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (near && (*near)[k] == '0') continue;  // unmeasured: boxes decide
    const std::size_t a = find(pairs[k].first);
    const std::size_t b = find(pairs[k].second);
    root[std::max(a, b)] = std::min(a, b);
  }

  std::vector<std::vector<std::size_t>> groups(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) groups[find(i)].push_back(i);
  std::vector<Body> joined;
  for (const std::vector<std::size_t>& members : groups) {
    if (members.empty()) continue;
    joined.push_back(members.size() == 1 ? bodies[members.front()] : together(bodies, members));
    if (members.size() > 1)
      warnings.push_back(fmt::format(
          "{} bodies touch or come nearer than 2d to each other: they grow together and are offset "
          "as one",
          members.size()));
  }
  return joined;
}

}  // namespace phront::cad
