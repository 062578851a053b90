// Wavefront OBJ: points and polygons as text. Read are v, f, g and o; texture, normals, materials,
// lines and curves are passed over. Polygons are fanned from their first corner.
// Indices count from 1; negative ones count back from the last point read so far.
// Weak spot: a fan folds over in strongly concave polygons.
#include <map>
#include <string>

#include "io/formats.h"
#include "io/text.h"

namespace phront::io {
namespace {

class ObjParser {
 public:
  explicit ObjParser(std::string_view bytes) : cursor_(bytes) {}

  Result<TriMesh> parse() {
    while (!cursor_.atEnd()) {
      if (auto done = statement(nextStatement()); !done) return tl::unexpected(done.error());
    }
    if (mesh_.triangles.empty()) return unreadable("it holds no faces");
    if (groupIds_.size() < 2) mesh_.faceOf.clear();
    return std::move(mesh_);
  }

 private:
  /// One logical line: a backslash at the end joins the next one.
  std::string_view nextStatement() {
    std::string_view line = nextLine();
    if (line.empty() || line.back() != '\\') return line;
    joined_.clear();
    while (!line.empty() && line.back() == '\\') {
      joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
      line = nextLine();
    }
    joined_.append(line);
    return joined_;
  }

  Result<void> statement(std::string_view line) {
    TextCursor words(line);
    const std::string_view keyword = words.word();
    if (keyword == "v") return point(words);
    if (keyword == "f") return polygon(words);
    if (keyword == "g" || keyword == "o") {
      group_.assign(line.substr(words.position()));
      groupKnown_ = false;
    }
    return {};
  }

  Result<void> point(TextCursor& words) {
    Vec3 p;
    for (int c = 0; c < 3; ++c) {
      const auto value = parseCoordinate(words.word());
      if (!value) return unreadable("line {}: point without three finite numbers", line_);
      p[c] = *value;
    }
    if (mesh_.points.size() >= kMaxCount) return unreadable("more points than phront can index");
    mesh_.points.push_back(p);
    return {};
  }

  Result<void> polygon(TextCursor& words) {
    corners_.clear();
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
      if (word.front() == '#') break;
      const auto number = parseInteger<std::int64_t>(word.substr(0, word.find('/')));
      const auto count = static_cast<std::int64_t>(mesh_.points.size());
      if (!number || *number == 0 || *number > count || *number < -count) {
        return unreadable("line {}: face names point \"{}\" but {} points are known there", line_,
                          word.substr(0, 40), count);
      }
      corners_.push_back(static_cast<Index>(*number > 0 ? *number - 1 : count + *number));
    }
    if (corners_.size() < 3)
      return unreadable("line {}: face of {} corners", line_, corners_.size());
    if (mesh_.triangles.size() + corners_.size() > kMaxCount) {
      return unreadable("more triangles than phront can index");
    }
    for (std::size_t k = 2; k < corners_.size(); ++k) {
      mesh_.triangles.push_back({corners_[0], corners_[k - 1], corners_[k]});
      mesh_.faceOf.push_back(groupId());
    }
    return {};
  }

  /// Groups are numbered in the order of their first face, so that empty ones take no number.
  Index groupId() {
    if (!groupKnown_) {
      groupNumber_ =
          groupIds_.try_emplace(group_, static_cast<Index>(groupIds_.size())).first->second;
      groupKnown_ = true;
    }
    return groupNumber_;
  }

  std::string_view nextLine() {
    ++line_;
    return cursor_.line();
  }

  TextCursor cursor_;
  std::size_t line_ = 0;  ///< number of the line last read, from 1
  TriMesh mesh_;
  std::string joined_;
  std::vector<Index> corners_;
  std::string group_;
  bool groupKnown_ = false;
  Index groupNumber_ = 0;
  std::map<std::string, Index> groupIds_;
};

}  // namespace

Result<TriMesh> parseObj(std::string_view bytes) { return ObjParser(bytes).parse(); }

std::string formatObj(const TriMesh& mesh) {
  fmt::memory_buffer out;
  const auto at = std::back_inserter(out);
  fmt::format_to(at, "# written by phront\n");
  // The shortest digits that read back to the same bits.
  for (const Vec3& p : mesh.points) fmt::format_to(at, "v {} {} {}\n", p.x(), p.y(), p.z());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.faceOf.empty() && (t == 0 || mesh.faceOf[t] != mesh.faceOf[t - 1])) {
      fmt::format_to(at, "g face{}\n", mesh.faceOf[t]);
    }
    const auto& corners = mesh.triangles[t];
    fmt::format_to(at, "f {} {} {}\n", corners[0] + 1, corners[1] + 1, corners[2] + 1);
  }
  return fmt::to_string(out);
}

}  // namespace phront::io
