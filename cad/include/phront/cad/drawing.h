// Planar drawings: SVG and DXF in and out, planar wires of CAD files in.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "phront/curve_mesh.h"
#include "phront/status.h"

namespace phront::cad {

enum class DrawingFormat { Svg, Dxf };

/// Format by extension (.svg .dxf, any case); InvalidArgument names them.
[[nodiscard]] Result<DrawingFormat> drawingFormatOf(const std::filesystem::path& path);

struct DrawingOptions {
  /// Largest distance of chords from the curves, mm; automatic: 1e-5 of the drawing's diagonal.
  std::optional<double> tolerance = std::nullopt;
  double timeLimit = 25;      ///< s, of the reading process
  double memoryLimit = 1024;  ///< MiB, of the reading process
};

struct Drawing {
  CurveMesh curves;       ///< mm, y upwards; loops oriented by nesting: material inside the outer
                          ///< ones, holes in it, and so on; open curves as drawn
  double unitInMm = 1;    ///< length unit of the file
  std::size_t loops = 0;  ///< closed curves
  std::size_t open = 0;   ///< open ones
  std::vector<std::string> warnings;
};

/// Reads the curves of a drawing, in a child process with limits. SVG: shapes and paths with their
/// transforms, without what is hidden or only defined; units as CSS has them (no unit: 96 to the
/// inch). DXF: LINE, ARC, CIRCLE, ELLIPSE, (LW)POLYLINE with bulges, SPLINE, and blocks inserted;
/// $INSUNITS, none: mm. Ends nearer to one another than the tolerance are joined; curves drawn
/// twice count once. STEP, IGES, BREP: the curves of a file without faces that lie in one
/// plane; parallel to z = 0 they keep x and y, else they are seen from the front of their plane, z
/// upwards. Fails with UnreadableInput, ResourceLimit; one sentence that names the
/// trouble.
[[nodiscard]] Result<Drawing> readDrawing(const std::filesystem::path& path,
                                          const DrawingOptions& options = {});

/// Writes polygons in mm: SVG paths (even-odd fill of loops) or DXF polylines, aside, then renames.
/// Fails with CannotWrite, InvalidArgument (extension).
[[nodiscard]] Result<void> writeDrawing(const CurveMesh& curves, const std::filesystem::path& path);

}  // namespace phront::cad
