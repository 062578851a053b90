// Chooses the format by the extension and puts the file's name into errors.
#include "phront/mesh_io.h"

#include <fmt/format.h>

#include <new>

#include "io/file.h"
#include "io/formats.h"

namespace phront {
namespace {

Result<TriMesh> parse(MeshFormat format, std::string_view bytes) {
  switch (format) {
    case MeshFormat::Stl:
      return io::parseStl(bytes);
    case MeshFormat::Obj:
      return io::parseObj(bytes);
    case MeshFormat::Ply:
      return io::parsePly(bytes);
    case MeshFormat::Vtu:
      break;
  }
  return fail(ErrorCode::NotSupported, "VTU is written, not read; give STL, OBJ or PLY");
}

Result<std::string> format(MeshFormat format, const TriMesh& mesh) {
  switch (format) {
    case MeshFormat::Stl:
      return io::formatStl(mesh);
    case MeshFormat::Obj:
      return io::formatObj(mesh);
    case MeshFormat::Ply:
      return io::formatPly(mesh);
    case MeshFormat::Vtu:
      break;
  }
  return io::formatVtu(mesh);
}

Result<void> checkWritable(const TriMesh& mesh) {
  const auto count = static_cast<Index>(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index corner : mesh.triangles[t]) {
      if (corner < 0 || corner >= count) {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("triangle {} names point {} of {}", t, corner, count));
      }
    }
  }
  if (!mesh.faceOf.empty() && mesh.faceOf.size() != mesh.triangles.size()) {
    return fail(ErrorCode::InvalidArgument, fmt::format("{} face labels for {} triangles",
                                                        mesh.faceOf.size(), mesh.triangles.size()));
  }
  return {};
}

/// Puts the name of the file before the sentence of a failure.
template <class T>
Result<T> named(Result<T> result, const char* verb, const std::filesystem::path& path) {
  if (!result) {
    result.error().message =
        fmt::format("cannot {} {}: {}", verb, path.string(), result.error().message);
  }
  return result;
}

}  // namespace

Result<MeshFormat> meshFormatOf(const std::filesystem::path& path) {
  const std::string extension = io::lowerExtension(path);
  if (extension == ".stl") return MeshFormat::Stl;
  if (extension == ".obj") return MeshFormat::Obj;
  if (extension == ".ply") return MeshFormat::Ply;
  if (extension == ".vtu") return MeshFormat::Vtu;
  return fail(ErrorCode::InvalidArgument,
              fmt::format("{}: unknown mesh format \"{}\"; known are .stl .obj .ply .vtu",
                          path.string(), extension));
}

Result<TriMesh> readMesh(const std::filesystem::path& path) try {
  const auto format = meshFormatOf(path);
  if (!format) return tl::unexpected(format.error());
  const auto bytes = io::readFile(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return named(parse(*format, *bytes), "read", path);
} catch (const std::bad_alloc&) {
  return fail(ErrorCode::ResourceLimit,
              fmt::format("cannot read {}: out of memory", path.string()));
}

Result<void> writeMesh(const TriMesh& mesh, const std::filesystem::path& path) try {
  const auto kind = meshFormatOf(path);
  if (!kind) return tl::unexpected(kind.error());
  if (auto good = checkWritable(mesh); !good) return named(std::move(good), "write", path);
  const auto bytes = named(format(*kind, mesh), "write", path);
  if (!bytes) return tl::unexpected(bytes.error());
  return writeFileAtomically(path, *bytes);
} catch (const std::bad_alloc&) {
  return fail(ErrorCode::ResourceLimit,
              fmt::format("cannot write {}: out of memory", path.string()));
}

}  // namespace phront
