// What OpenCASCADE's readers give: placed shapes with names. Call in a guarded child.
#pragma once

#include <NCollection_DataMap.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Shape.hxx>
#include <optional>
#include <string>
#include <vector>

#include "exchange/file_text.h"
#include "exchange/step_scan.h"
#include "phront/cad/shape.h"
#include "phront/status.h"

namespace phront::cad {

struct NamedShape {
  TopoDS_Shape shape;
  std::string name;
  int assembly = -1;  ///< index into Loaded::assemblies
};

/// What a file says of a face or solid beside its geometry.
struct Mark {
  std::string name;  ///< empty when unnamed
  std::optional<Colour> colour;
};

/// Marks by the shape without location and regardless of orientation.
class ShapeMarks {
 public:
  void setName(const TopoDS_Shape& shape, const std::string& name);
  void setColour(const TopoDS_Shape& shape, const Colour& colour);
  /// `to` replaces `from`.
  void copy(const TopoDS_Shape& from, const TopoDS_Shape& to);
  [[nodiscard]] Mark of(const TopoDS_Shape& shape) const;

 private:
  Mark& at(const TopoDS_Shape& shape);
  NCollection_DataMap<TopoDS_Shape, Mark, TopTools_ShapeMapHasher> marks_;
};

struct Loaded {
  std::vector<NamedShape> shapes;  ///< in mm, in place
  std::vector<AssemblyNode> assemblies;
  ShapeMarks marks;  ///< of faces and solids
  std::string unit = "mm";
  double unitInMm = 1;
  std::vector<std::string> warnings;
  std::string emptyReason;  ///< why there may be no faces; empty when nothing is known
};

/// Failures are ends of sentences ("it holds no faces"), to be put after "reading NAME: ".
[[nodiscard]] Result<Loaded> loadStep(const FileText& file, const StepScan& scan);
[[nodiscard]] Result<Loaded> loadIges(const std::filesystem::path& path);
[[nodiscard]] Result<Loaded> loadBrep(const FileText& file);

}  // namespace phront::cad
