// Plain framing: a count, then the elements, in the order of the struct. Both ends are the same
// executable on the same machine, so layout and byte order agree.
#include "tessellate/tessellation_bytes.h"

#include <cstring>

namespace phront::cad {
namespace {

class Writer {
 public:
  template <class T>
  void value(const T& v) {
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof(T));
  }
  template <class T>
  void vector(const std::vector<T>& v) {
    value(static_cast<std::uint64_t>(v.size()));
    if (!v.empty()) bytes_.append(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T));
  }
  void text(const std::string& s) {
    value(static_cast<std::uint64_t>(s.size()));
    bytes_ += s;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  void value(T& v) {
    raw(&v, sizeof(T));
  }
  template <class T>
  void vector(std::vector<T>& v) {
    v.resize(count(sizeof(T)));
    if (!v.empty()) raw(v.data(), v.size() * sizeof(T));
  }
  void text(std::string& s) {
    s.resize(count(1));
    raw(s.data(), s.size());
  }
  /// A number of elements; 0 when fewer bytes are left than they need.
  std::size_t count(std::size_t size) {
    std::uint64_t n = 0;
    value(n);
    if (n > bytes_.size() / size) good_ = false;
    return good_ ? static_cast<std::size_t>(n) : 0;
  }
  [[nodiscard]] bool done() const { return good_ && bytes_.empty(); }

 private:
  void raw(void* to, std::size_t size) {
    if (!good_ || size > bytes_.size()) {
      good_ = false;
      return;
    }
    std::memcpy(to, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  std::string_view bytes_;
  bool good_ = true;
};

// One list of the fields, for both directions.
template <class Archive, class Features>
void planes(Archive& archive, Features& face) {
  Vec3 normal = face.plane ? face.plane->normal : Vec3::Zero();
  double offset = face.plane ? face.plane->offset : 0;
  bool planar = face.plane.has_value();
  archive.value(planar);
  archive.value(normal);
  archive.value(offset);
  if constexpr (!std::is_const_v<Features>) {
    if (planar) face.plane = Plane{normal, offset};
  }
}

template <class Archive, class T>
void meshFields(Archive& archive, T& tessellation) {
  archive.vector(tessellation.mesh.points);
  archive.vector(tessellation.mesh.triangles);
  archive.vector(tessellation.mesh.faceOf);
  archive.vector(tessellation.mesh.edgeOf);
  archive.vector(tessellation.mesh.vertexOf);
  archive.vector(tessellation.uv);
  archive.vector(tessellation.edgeSides);
  archive.value(tessellation.measuredDeflection);
  archive.value(tessellation.untessellatedFaces);
  archive.value(tessellation.filledHoles);
}

template <class Archive, class Face>
void faceFields(Archive& archive, Face& face) {
  archive.value(face.type);
  planes(archive, face);
  archive.value(face.area);
  archive.value(face.deflection);
  archive.text(face.name);
}

template <class Archive, class Edge>
void edgeFields(Archive& archive, Edge& edge) {
  archive.value(edge.type);
  archive.vector(edge.faces);
  archive.value(edge.maxDihedral);
  archive.value(edge.length);
}

}  // namespace

std::string bytesOfTessellation(const Tessellation& tessellation) {
  Writer writer;
  meshFields(writer, tessellation);
  const FeatureTable& table = tessellation.features;
  writer.value(static_cast<std::uint64_t>(table.faces.size()));
  for (const FaceFeature& face : table.faces) faceFields(writer, face);
  writer.value(static_cast<std::uint64_t>(table.edges.size()));
  for (const EdgeFeature& edge : table.edges) edgeFields(writer, edge);
  writer.vector(table.vertices);
  return writer.take();
}

Result<Tessellation> tessellationOfBytes(std::string_view bytes) {
  Reader reader(bytes);
  Tessellation tessellation;
  meshFields(reader, tessellation);
  FeatureTable& table = tessellation.features;
  table.faces.resize(reader.count(1));
  for (FaceFeature& face : table.faces) faceFields(reader, face);
  table.edges.resize(reader.count(1));
  for (EdgeFeature& edge : table.edges) edgeFields(reader, edge);
  reader.vector(table.vertices);
  if (!reader.done()) {
    return fail(ErrorCode::Failed, "The tessellation came back incomplete from its process.");
  }
  return tessellation;
}

}  // namespace phront::cad
