// VTU with raw appended data (bit-exact, no text to parse). A small writer of our own: linking
// VTK's would add some 10 ms to every start of a program. A mesh becomes triangle cells with the
// B-Rep face as cell data.
#include "io/vtu.h"

#include "io/formats.h"

namespace phront::io {
namespace {

constexpr std::uint8_t kVtkTriangle = 5;

}  // namespace

std::string assembleVtu(VtuPiece& piece, const std::vector<double>& coordinates, const Cells& cells,
                        const std::string& pointData, const std::string& cellData) {
  const std::size_t count = cells.connectivity.size() / cells.corners;
  std::vector<std::int64_t> ends(count);
  for (std::size_t i = 0; i < count; ++i)
    ends[i] = static_cast<std::int64_t>((i + 1) * cells.corners);
  const std::vector<std::uint8_t> types(count, cells.type);
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <UnstructuredGrid>\n"
      "    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      coordinates.size() / 3, count);
  if (!pointData.empty()) xml += "      <PointData>\n" + pointData + "      </PointData>\n";
  if (!cellData.empty()) xml += "      <CellData>\n" + cellData + "      </CellData>\n";
  xml += "      <Points>\n" + piece.add("Points", "Float64", 3, coordinates) + "      </Points>\n";
  xml += "      <Cells>\n" + piece.add("connectivity", "Int32", 1, cells.connectivity) +
         piece.add("offsets", "Int64", 1, ends) + piece.add("types", "UInt8", 1, types) +
         "      </Cells>\n";
  xml += "    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_";
  xml += piece.data();
  xml += "\n  </AppendedData>\n</VTKFile>\n";
  return xml;
}

std::string formatVtu(const TriMesh& mesh) {
  std::vector<double> coordinates;
  coordinates.reserve(3 * mesh.points.size());
  for (const Vec3& p : mesh.points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
  Cells cells{.connectivity = {}, .type = kVtkTriangle, .corners = 3};
  cells.connectivity.reserve(3 * mesh.triangles.size());
  for (const auto& corners : mesh.triangles) {
    cells.connectivity.insert(cells.connectivity.end(), corners.begin(), corners.end());
  }
  VtuPiece piece;
  const std::string cellData =
      mesh.faceOf.empty() ? std::string() : piece.add("faceOf", "Int32", 1, mesh.faceOf);
  return assembleVtu(piece, coordinates, cells, {}, cellData);
}

}  // namespace phront::io
