// STL: triangles without connectivity. Binary or ASCII is told by the size, not by the first word:
// many binary files start with "solid" too. Corners with bitwise equal coordinates are one point.
// ASCII facets with more than three corners, which some programs write, are fanned from the first.
// Normals in the file are ignored: they follow from the corners.
// Weak spot: binary STL stores single precision, so writing rounds to 6e-8 relative.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "io/formats.h"
#include "io/text.h"

namespace phront::io {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kPrefixBytes = kHeaderBytes + 4;
constexpr std::size_t kFacetBytes = 50;

template <class T>
T littleEndian(const char* bytes) {
  T value;  // the platforms phront builds on are little endian; asserted where files are written
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

Result<TriMesh> weldedUnlessEmpty(TriMesh soup) {
  if (soup.triangles.empty()) return unreadable("it holds no triangles");
  TriMesh mesh = weld(soup);
  if (mesh.triangles.empty()) return unreadable("all its triangles are degenerate");
  return mesh;
}

Result<TriMesh> parseBinary(std::string_view bytes) {
  if (bytes.size() < kPrefixBytes) {
    return unreadable("binary STL of {} bytes is cut short", bytes.size());
  }
  const std::size_t count = littleEndian<std::uint32_t>(bytes.data() + kHeaderBytes);
  const std::size_t there = (bytes.size() - kPrefixBytes) / kFacetBytes;
  if (count > there) {
    return unreadable("binary STL names {} triangles but only {} are there: it is cut short", count,
                      there);
  }
  if (count > kMaxCount / 3) return unreadable("more triangles than phront can index");

  TriMesh soup;
  soup.points.reserve(3 * count);
  soup.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    const char* corners = bytes.data() + kPrefixBytes + t * kFacetBytes + 12;
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 p;
      for (int c = 0; c < 3; ++c) p[c] = littleEndian<float>(corners + 12 * k + 4 * c);
      if (!p.allFinite()) return unreadable("triangle {} has a corner that is not finite", t);
      // -0 and 0 are one place: without this, welding by bits would tear the surface there.
      soup.points.push_back(p.array() + 0.0);
    }
    const auto first = static_cast<Index>(3 * t);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return weldedUnlessEmpty(std::move(soup));
}

bool sameWord(std::string_view a, std::string_view lower) {
  return a.size() == lower.size() &&
         std::equal(a.begin(), a.end(), lower.begin(), [](char x, char y) {
           return std::tolower(static_cast<unsigned char>(x)) == y;
         });
}

class AsciiParser {
 public:
  explicit AsciiParser(std::string_view bytes) : cursor_(bytes) {}

  Result<TriMesh> parse() {
    bool open = false;
    for (std::string_view word = cursor_.word(); !word.empty(); word = cursor_.word()) {
      if (sameWord(word, "solid") && !open) {
        cursor_.line();
        open = true;
        ++solids_;
      } else if (sameWord(word, "endsolid") && open) {
        cursor_.line();
        open = false;
      } else if (sameWord(word, "facet") && open) {
        if (auto done = facet(); !done) return tl::unexpected(done.error());
      } else {
        return unexpectedWord(word);
      }
    }
    if (open) return unreadable("ASCII STL without its endsolid: it is cut short");
    if (solids_ < 2) soup_.faceOf.clear();
    return weldedUnlessEmpty(std::move(soup_));
  }

 private:
  tl::unexpected<Error> unexpectedWord(std::string_view word) const {
    if (word.empty()) return unreadable("ASCII STL ends inside a facet: it is cut short");
    constexpr std::size_t kShown = 40;
    return unreadable("line {}: unexpected \"{}\" in ASCII STL", cursor_.lineNumber(),
                      word.substr(0, kShown));
  }

  /// Reads the given word or fails.
  Result<void> expect(std::string_view lower) {
    const std::string_view word = cursor_.word();
    if (!sameWord(word, lower)) return unexpectedWord(word);
    return {};
  }

  Result<void> facet() {
    if (auto ok = expect("normal"); !ok) return ok;
    for (int c = 0; c < 3; ++c) cursor_.word();
    if (auto ok = expect("outer"); !ok) return ok;
    if (auto ok = expect("loop"); !ok) return ok;
    const std::size_t first = soup_.points.size();
    for (;;) {
      const std::string_view word = cursor_.word();
      if (sameWord(word, "endloop")) break;
      if (!sameWord(word, "vertex")) return unexpectedWord(word);
      Vec3 p;
      for (int c = 0; c < 3; ++c) {
        const std::string_view number = cursor_.word();
        const auto value = parseCoordinate(number);
        if (!value) return unexpectedWord(number);
        p[c] = *value + 0.0;
      }
      soup_.points.push_back(p);
    }
    const std::size_t corners = soup_.points.size() - first;
    if (corners < 3)
      return unreadable("line {}: facet of {} corners", cursor_.lineNumber(), corners);
    if (soup_.points.size() > kMaxCount) return unreadable("more corners than phront can index");
    for (std::size_t k = 2; k < corners; ++k) {
      soup_.triangles.push_back({static_cast<Index>(first), static_cast<Index>(first + k - 1),
                                 static_cast<Index>(first + k)});
      soup_.faceOf.push_back(solids_ - 1);
    }
    return expect("endfacet");
  }

  TextCursor cursor_;
  TriMesh soup_;
  Index solids_ = 0;
};

bool looksLikeText(std::string_view bytes) {
  constexpr std::size_t kSample = 1024;
  return std::none_of(bytes.begin(), bytes.begin() + std::min(bytes.size(), kSample), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u < 0x20 && !isSpace(c);
  });
}

}  // namespace

Result<TriMesh> parseStl(std::string_view bytes) {
  const bool exactBinarySize =
      bytes.size() >= kPrefixBytes &&
      bytes.size() ==
          kPrefixBytes + kFacetBytes * static_cast<std::size_t>(littleEndian<std::uint32_t>(
                                           bytes.data() + kHeaderBytes));
  if (exactBinarySize) return parseBinary(bytes);
  TextCursor start(bytes.substr(0, std::min<std::size_t>(bytes.size(), 1024)));
  if (sameWord(start.word(), "solid") && looksLikeText(bytes)) return AsciiParser(bytes).parse();
  return parseBinary(bytes);
}

Result<std::string> formatStl(const TriMesh& mesh) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max()) {
    return fail(ErrorCode::CannotWrite, "more triangles than STL can count");
  }
  std::string bytes(kPrefixBytes + kFacetBytes * mesh.triangles.size(), '\0');
  constexpr std::string_view kTitle = "Binary STL by phront";  // must not start with "solid"
  std::copy(kTitle.begin(), kTitle.end(), bytes.begin());
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::memcpy(bytes.data() + kHeaderBytes, &count, sizeof count);

  char* out = bytes.data() + kPrefixBytes;
  const auto put = [&out](const Vec3& v) {
    for (int c = 0; c < 3; ++c) {
      const auto single = static_cast<float>(v[c]);
      if (!std::isfinite(single)) return false;
      std::memcpy(out, &single, sizeof single);
      out += sizeof single;
    }
    return true;
  };
  for (const auto& triangle : mesh.triangles) {
    const auto corner = [&](int k) -> const Vec3& {
      return mesh.points[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
    };
    const Vec3 cross = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const double length = cross.norm();
    bool good =
        put(length > 0 && std::isfinite(length) ? Vec3(cross / length) : Vec3(Vec3::Zero()));
    for (int k = 0; k < 3; ++k) good = good && put(corner(k));
    if (!good) {
      return fail(ErrorCode::CannotWrite,
                  "a coordinate is beyond the single precision of STL; write OBJ or PLY instead");
    }
    out += 2;  // attribute bytes, zero
  }
  return bytes;
}

}  // namespace phront::io
