// PLY (Turk 1994): elements with typed properties, ASCII or binary of either byte order. Elements
// and properties that phront does not know are passed over. Read are vertex x y z, the corner list
// of face (vertex_indices or vertex_index) and, as label, the face property "face". Polygons are
// fanned from their first corner. Triangle strips are not read. Hostile files: an element's count
// is checked against the least number of bytes it needs before any memory is asked for; every list
// length against the bytes that are left.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "io/formats.h"
#include "io/text.h"

namespace phront::io {
namespace {

enum class Encoding { Ascii, LittleEndian, BigEndian };
enum class Scalar { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

struct Property {
  std::string name;
  Scalar type = Scalar::Float32;
  std::optional<Scalar> countType;  ///< of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
  std::size_t size = 0;  ///< bytes
};

std::optional<Scalar> scalarOf(std::string_view name) {
  constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                   {"uchar", "uint8"},
                                                                   {"short", "int16"},
                                                                   {"ushort", "uint16"},
                                                                   {"int", "int32"},
                                                                   {"uint", "uint32"},
                                                                   {"float", "float32"},
                                                                   {"double", "float64"}}};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i][0] || name == kNames[i][1]) return static_cast<Scalar>(i);
  }
  return std::nullopt;
}

std::size_t sizeOf(Scalar type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

bool isInteger(Scalar type) { return type < Scalar::Float32; }

Result<Property> parseProperty(TextCursor& words) {
  Property property;
  std::string_view type = words.word();
  if (type == "list") {
    property.countType = scalarOf(words.word());
    if (!property.countType || !isInteger(*property.countType)) {
      return unreadable("PLY header: list whose length is not a whole number");
    }
    type = words.word();
  }
  const auto scalar = scalarOf(type);
  property.name = std::string(words.word());
  if (!scalar || property.name.empty()) return unreadable("PLY header: bad property line");
  property.type = *scalar;
  return property;
}

Result<Header> parseHeader(std::string_view bytes) {
  TextCursor cursor(bytes);
  if (cursor.line() != "ply") return unreadable("it does not start with \"ply\"");
  Header header;
  bool formatKnown = false;
  while (!cursor.atEnd()) {
    TextCursor words(cursor.line());
    const std::string_view keyword = words.word();
    if (keyword == "format") {
      const std::string_view name = words.word();
      formatKnown = true;
      if (name == "ascii") {
        header.encoding = Encoding::Ascii;
      } else if (name == "binary_little_endian") {
        header.encoding = Encoding::LittleEndian;
      } else if (name == "binary_big_endian") {
        header.encoding = Encoding::BigEndian;
      } else {
        return unreadable("PLY header: unknown format \"{}\"", name.substr(0, 40));
      }
    } else if (keyword == "element") {
      Element element;
      element.name = std::string(words.word());
      const auto count = parseInteger<std::uint64_t>(words.word());
      if (element.name.empty() || !count) return unreadable("PLY header: bad element line");
      element.count = *count;
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) return unreadable("PLY header: property before any element");
      auto property = parseProperty(words);
      if (!property) return tl::unexpected(property.error());
      header.elements.back().properties.push_back(std::move(*property));
    } else if (keyword == "end_header") {
      if (!formatKnown) return unreadable("PLY header without format line");
      header.size = cursor.position();
      return header;
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      return unreadable("PLY header: unexpected \"{}\"", keyword.substr(0, 40));
    }
  }
  return unreadable("PLY header without end_header: it is cut short");
}

/// Numbers of the body, whatever the encoding. Whole numbers up to 32 bits are exact in a double.
class Body {
 public:
  Body(std::string_view bytes, Encoding encoding)
      : bytes_(bytes), cursor_(bytes), encoding_(encoding) {}

  /// Nothing where the file ends or a word is no number.
  std::optional<double> next(Scalar type) {
    if (encoding_ == Encoding::Ascii) {
      const std::string_view word = cursor_.word();
      const auto value = parseCoordinate(word);
      if (value && isInteger(type) && *value != std::floor(*value)) return std::nullopt;
      // A number that is not finite counts only where it is used, as in binary files.
      return value || word.empty() ? value : nonFinite(word);
    }
    switch (type) {
      case Scalar::Int8:
        return raw<std::int8_t>();
      case Scalar::Uint8:
        return raw<std::uint8_t>();
      case Scalar::Int16:
        return raw<std::int16_t>();
      case Scalar::Uint16:
        return raw<std::uint16_t>();
      case Scalar::Int32:
        return raw<std::int32_t>();
      case Scalar::Uint32:
        return raw<std::uint32_t>();
      case Scalar::Float32:
        return raw<float>();
      case Scalar::Float64:
        return raw<double>();
    }
    return std::nullopt;
  }

  [[nodiscard]] std::size_t remaining() const {
    return encoding_ == Encoding::Ascii ? cursor_.remaining() : bytes_.size() - at_;
  }

  /// Least number of bytes of one scalar.
  [[nodiscard]] std::size_t leastSize(Scalar type) const {
    return encoding_ == Encoding::Ascii ? 1 : sizeOf(type);
  }

 private:
  static std::optional<double> nonFinite(std::string_view word) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
  }

  template <class T>
  std::optional<double> raw() {
    if (bytes_.size() - at_ < sizeof(T)) return std::nullopt;
    std::array<char, sizeof(T)> buffer;
    std::memcpy(buffer.data(), bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    const bool fileIsLittle = encoding_ == Encoding::LittleEndian;
    if (fileIsLittle != (std::endian::native == std::endian::little)) {
      std::reverse(buffer.begin(), buffer.end());
    }
    return static_cast<double>(std::bit_cast<T>(buffer));
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  TextCursor cursor_;
  Encoding encoding_;
};

class PlyParser {
 public:
  PlyParser(Header header, std::string_view bytes)
      : header_(std::move(header)), body_(bytes.substr(header_.size), header_.encoding) {}

  Result<TriMesh> parse() {
    for (const Element& element : header_.elements) {
      if (auto done = readElement(element); !done) return tl::unexpected(done.error());
    }
    const auto count = static_cast<double>(mesh_.points.size());
    if (largestIndex_ >= count) {
      return unreadable("a face names point {} but there are {} points", largestIndex_, count);
    }
    if (mesh_.triangles.empty()) return unreadable("it holds no faces");
    if (!labelled_) mesh_.faceOf.clear();
    return std::move(mesh_);
  }

 private:
  Result<void> readElement(const Element& element) {
    std::size_t least = 0;
    for (const Property& p : element.properties) {
      least += body_.leastSize(p.countType.value_or(p.type));
    }
    if (least == 0) return {};  // an element without properties has no bytes
    if (element.count > body_.remaining() / least + 1) return cutShort(element);
    if (element.count > kMaxCount) return unreadable("more {} than phront can index", element.name);

    const bool isVertex = element.name == "vertex";
    const bool isFace = element.name == "face";
    if (isVertex) {
      for (const char* axis : {"x", "y", "z"}) {
        if (std::none_of(element.properties.begin(), element.properties.end(),
                         [&](const Property& p) { return p.name == axis && !p.countType; })) {
          return unreadable("PLY points without {}", axis);
        }
      }
      mesh_.points.reserve(mesh_.points.size() + element.count);
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      auto done = isVertex ? readPoint(element) : isFace ? readFace(element) : skip(element);
      if (!done) return done;
    }
    return {};
  }

  static tl::unexpected<Error> cutShort(const Element& element) {
    return unreadable("PLY names {} elements \"{}\" but ends, or has no number, before that",
                      element.count, element.name.substr(0, 40));
  }

  Result<void> readPoint(const Element& element) {
    Vec3 p = Vec3::Zero();
    for (const Property& property : element.properties) {
      if (property.countType) {
        if (!readList(property)) return cutShort(element);
        continue;
      }
      const auto value = body_.next(property.type);
      if (!value) return cutShort(element);
      if (property.name == "x") p.x() = *value;
      if (property.name == "y") p.y() = *value;
      if (property.name == "z") p.z() = *value;
    }
    if (!p.allFinite()) return unreadable("point {} is not finite", mesh_.points.size());
    mesh_.points.push_back(p);
    return {};
  }

  Result<void> readFace(const Element& element) {
    corners_.clear();
    double label = 0;
    for (const Property& property : element.properties) {
      if (property.countType) {
        if (!readList(property)) return cutShort(element);
        const bool isCorners = property.name == "vertex_indices" || property.name == "vertex_index";
        if (isCorners) corners_ = list_;
        continue;
      }
      const auto value = body_.next(property.type);
      if (!value) return cutShort(element);
      if (property.name == "face" && isInteger(property.type)) {
        label = *value;
        labelled_ = true;
      }
    }
    if (corners_.size() < 3) return unreadable("a face has {} corners", corners_.size());
    for (const double corner : corners_) {
      if (!(corner >= 0) || corner >= static_cast<double>(kMaxCount)) {
        return unreadable("a face names point {}", corner);
      }
      largestIndex_ = std::max(largestIndex_, corner);
    }
    if (label < 0 || label >= static_cast<double>(kMaxCount)) label = 0;
    for (std::size_t k = 2; k < corners_.size(); ++k) {
      mesh_.triangles.push_back({static_cast<Index>(corners_[0]),
                                 static_cast<Index>(corners_[k - 1]),
                                 static_cast<Index>(corners_[k])});
      mesh_.faceOf.push_back(static_cast<Index>(label));
    }
    if (mesh_.triangles.size() > kMaxCount) return unreadable("more faces than phront can index");
    return {};
  }

  Result<void> skip(const Element& element) {
    for (const Property& property : element.properties) {
      const bool read =
          property.countType ? readList(property) : body_.next(property.type).has_value();
      if (!read) return cutShort(element);
    }
    return {};
  }

  /// Reads a list into list_; false where the file ends before.
  bool readList(const Property& property) {
    list_.clear();
    const auto count = body_.next(*property.countType);
    if (!count || !(*count >= 0)) return false;
    if (*count > static_cast<double>(body_.remaining() / body_.leastSize(property.type) + 1)) {
      return false;
    }
    for (double i = 0; i < *count; ++i) {
      const auto value = body_.next(property.type);
      if (!value) return false;
      list_.push_back(*value);
    }
    return true;
  }

  Header header_;
  Body body_;
  TriMesh mesh_;
  std::vector<double> list_;
  std::vector<double> corners_;
  double largestIndex_ = -1;
  bool labelled_ = false;
};

template <class T>
void append(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little, "PLY is written as little endian");
  std::array<char, sizeof(T)> buffer;
  std::memcpy(buffer.data(), &value, sizeof(T));
  bytes.append(buffer.data(), buffer.size());
}

}  // namespace

Result<TriMesh> parsePly(std::string_view bytes) {
  auto header = parseHeader(bytes);
  if (!header) return tl::unexpected(header.error());
  return PlyParser(std::move(*header), bytes).parse();
}

std::string formatPly(const TriMesh& mesh) {
  const bool labelled = !mesh.faceOf.empty();
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by phront\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\n{}end_header\n",
      mesh.points.size(), mesh.triangles.size(), labelled ? "property int face\n" : "");
  constexpr std::size_t kPointBytes = 24;
  constexpr std::size_t kMostFaceBytes = 17;
  bytes.reserve(bytes.size() + kPointBytes * mesh.points.size() +
                kMostFaceBytes * mesh.triangles.size());
  for (const Vec3& p : mesh.points) {
    for (int c = 0; c < 3; ++c) append(bytes, p[c]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    append(bytes, std::uint8_t{3});
    for (const Index corner : mesh.triangles[t]) append(bytes, std::int32_t{corner});
    if (labelled) append(bytes, std::int32_t{mesh.faceOf[t]});
  }
  return bytes;
}

}  // namespace phront::io
