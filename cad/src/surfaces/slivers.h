// Parts of a cut face that are too narrow to matter.
#pragma once

#include <TopoDS_Face.hxx>

namespace phront::cad {

/// Twice the area of a face by the length of its loops.
[[nodiscard]] double meanWidth(const TopoDS_Face& face);

/// A face in a plane without its holes of less than a mean width.
[[nodiscard]] TopoDS_Face withoutSlits(const TopoDS_Face& face, double width);

}  // namespace phront::cad
