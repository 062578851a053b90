// B-Rep shapes as values, without OpenCASCADE in sight. Lengths in millimetres.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "phront/types.h"

namespace phront::cad {

/// A B-Rep shape. Copies share the same immutable geometry. OpenCASCADE's own type is reached
/// through the opt-in header shape_occt.h.
class Shape {
 public:
  Shape() = default;
  [[nodiscard]] bool empty() const { return !impl_; }

  struct Impl;
  explicit Shape(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  [[nodiscard]] const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Red, green and blue in [0, 1], linear.
struct Colour {
  double red = 0;
  double green = 0;
  double blue = 0;
  friend bool operator==(const Colour&, const Colour&) = default;
};

enum class BodyKind { Solid, Sheet };

/// A node of the tree that a file's bodies hang in.
struct AssemblyNode {
  std::string name;
  int parent = -1;  ///< index into Model::assemblies, before its own; -1: none
  friend bool operator==(const AssemblyNode&, const AssemblyNode&) = default;
};

/// One solid or one connected sheet, in its place.
struct Body {
  Shape shape;
  BodyKind kind = BodyKind::Solid;
  std::string name;                    ///< from the file, else empty
  int assembly = -1;                   ///< index into Model::assemblies; -1: in none
  std::vector<std::string> faceNames;  ///< per face in file order; empty strings where unnamed
  std::optional<Colour> colour;        ///< from the file (STEP)
  /// Per face in file order, where its colour is not the body's; empty when no face has its own.
  std::vector<std::optional<Colour>> faceColours;
  bool valid = true;  ///< false: read with faults (OpenCASCADE's check) that could not be healed
};

/// What a file holds. Everything is in mm, whatever the file's unit.
struct Model {
  std::vector<Body> bodies;
  std::vector<AssemblyNode> assemblies;  ///< from the file (STEP), parents first
  std::string unit = "mm";               ///< the file's own length unit
  double unitInMm = 1;                   ///< one unit of the file in mm
  std::vector<std::string> warnings;     ///< one sentence each: what was assumed or repaired
};

/// Bounding box, tight to the geometry.
[[nodiscard]] Box3 boundingBox(const Shape& shape);
[[nodiscard]] Box3 boundingBox(const Model& model);

/// Number of faces.
[[nodiscard]] int faceCount(const Shape& shape);

}  // namespace phront::cad
