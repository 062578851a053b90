// What OpenCASCADE's readers give: placed shapes with names. Call in a guarded child.
#pragma once

#include <NCollection_DataMap.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "exchange/file_text.h"
#include "exchange/step_scan.h"
#include "phront/status.h"

namespace phront::cad {

struct NamedShape {
  TopoDS_Shape shape;
  std::string name;
};

/// Names by the shape without location and regardless of orientation.
class ShapeNames {
 public:
  void set(const TopoDS_Shape& shape, const std::string& name);
  [[nodiscard]] std::string of(const TopoDS_Shape& shape) const;  ///< empty when unnamed

 private:
  NCollection_DataMap<TopoDS_Shape, std::string, TopTools_ShapeMapHasher> names_;
};

struct Loaded {
  std::vector<NamedShape> shapes;  ///< in mm, in place
  ShapeNames names;                ///< of faces and solids
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
