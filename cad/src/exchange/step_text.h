// The entities of a STEP file (ISO 10303-21) as tokens, without their meaning.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace phront::cad {

/// What is kept of one `#id = KEYWORD(...);`.
struct StepEntity {
  std::int64_t id = 0;
  std::string_view keyword;  ///< the first one; of a complex entity the first in the parentheses
  std::string_view text;     ///< all after '='
  std::uint32_t firstRef = 0;
  std::uint32_t refCount = 0;
  int numberCount = 0;
  double lastNumber = 0;
  double largestNumber = 0;   ///< largest magnitude
  bool smallInteger = false;  ///< a B-spline degree or multiplicity below one
};

class StepText {
 public:
  explicit StepText(std::string_view text);

  [[nodiscard]] const std::vector<StepEntity>& entities() const { return entities_; }
  /// References of an entity that exist, as indices into entities(), in file order.
  [[nodiscard]] std::vector<std::size_t> targets(const StepEntity& entity) const;
  /// First reference of an entity to nothing, or -1.
  [[nodiscard]] std::int64_t missingTarget(const StepEntity& entity) const;
  [[nodiscard]] bool refersToItself(const StepEntity& entity) const;

  bool hasData = false;   ///< DATA;
  bool dataEnds = false;  ///< ENDSEC after it
  bool endLine = false;   ///< END-ISO-10303-21
  std::string defect;     ///< first token that cannot be

 private:
  void parse(std::string_view text);
  void parseEntity(std::string_view statement);
  std::vector<StepEntity> entities_;
  std::vector<std::int64_t> refs_;
  std::unordered_map<std::int64_t, std::size_t> indexOf_;
};

/// True when `text` contains the keyword as a whole word.
[[nodiscard]] bool hasKeyword(std::string_view text, std::string_view keyword);

}  // namespace phront::cad
