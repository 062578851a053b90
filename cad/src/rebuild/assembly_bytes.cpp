// A line of counts, a line of words, the shape (nothing where there is none).
#include "rebuild/assembly_bytes.h"

#include <fmt/format.h>

#include <sstream>

#include "exchange/shape_bytes.h"

namespace phront::cad {

std::string bytesOfAssembly(const Assembly& assembly) {
  std::string bytes = fmt::format("{} {} {}\n{}\n", assembly.openEdges, assembly.fittedFaces,
                                  assembly.facetedFaces, assembly.way);
  if (!assembly.shape.IsNull()) bytes += bytesOfShape(assembly.shape);
  return bytes;
}

Result<Assembly> assemblyOfBytes(std::string_view bytes) {
  const std::size_t counts = bytes.find('\n');
  const std::size_t words = counts == bytes.npos ? counts : bytes.find('\n', counts + 1);
  if (words == bytes.npos) return fail(ErrorCode::Failed, "an assembly was cut short");
  Assembly assembly;
  std::istringstream line{std::string(bytes.substr(0, counts))};
  line >> assembly.openEdges >> assembly.fittedFaces >> assembly.facetedFaces;
  if (!line) return fail(ErrorCode::Failed, "an assembly has no counts");
  assembly.way = bytes.substr(counts + 1, words - counts - 1);
  if (words + 1 == bytes.size()) return assembly;
  Result<TopoDS_Shape> shape = shapeOfBytes(bytes.substr(words + 1));
  if (!shape) return tl::unexpected(shape.error());
  assembly.shape = std::move(*shape);
  return assembly;
}

}  // namespace phront::cad
