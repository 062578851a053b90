// Each check stands for a way in which OpenCASCADE was seen to crash, hang or silently lose
// geometry: numbers that are none, coordinates beyond any part, references in a circle or to
// nothing, points with too few coordinates, B-splines with impossible knots, assemblies that unfold
// without end. Weak spots: only circles of one entity are refused; longer ones are left to the
// guard, as nothing forbids them outside geometry.
#include "exchange/step_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include "exchange/step_text.h"

namespace phront::cad {
namespace {

// A coordinate beyond this (file units) is nonsense: a double resolves it to 1e-4 at best.
constexpr double kLargestCoordinate = 1e12;
// Placed copies of parts that an assembly may unfold to.
constexpr double kMostInstances = 1e6;

std::string nameOf(const StepEntity& entity) {
  return fmt::format("{} #{}", entity.keyword, entity.id);
}

bool isSurface(const StepEntity& entity) {
  return entity.keyword.starts_with("B_SPLINE_SURFACE") ||
         (entity.text.starts_with('(') && hasKeyword(entity.text, "B_SPLINE_SURFACE"));
}

// Coordinates of every point an entity refers to directly must be three.
std::optional<std::string> shortPoint(const StepText& file, const StepEntity& entity) {
  const bool edge = entity.keyword == "EDGE_CURVE";
  const bool owner = edge || entity.keyword == "VERTEX_POINT" ||
                     entity.keyword == "AXIS2_PLACEMENT_3D" ||
                     entity.keyword == "AXIS1_PLACEMENT" || isSurface(entity);
  if (!owner) return std::nullopt;
  const auto& all = file.entities();
  for (const std::size_t t : file.targets(entity)) {
    const StepEntity& target = all[t];
    if (target.keyword == "CARTESIAN_POINT" && target.numberCount != 3) {
      return fmt::format("{} has {} coordinates instead of three", nameOf(target),
                         target.numberCount);
    }
    if (edge && target.keyword == "LINE") {
      for (const std::size_t p : file.targets(target)) {
        if (all[p].keyword == "CARTESIAN_POINT" && all[p].numberCount != 3) {
          return fmt::format("{} has {} coordinates instead of three", nameOf(all[p]),
                             all[p].numberCount);
        }
      }
    }
  }
  return std::nullopt;
}

std::optional<std::string> defectOf(const StepText& file, const StepEntity& entity) {
  if (file.refersToItself(entity)) return nameOf(entity) + " refers to itself";
  if (entity.keyword == "CARTESIAN_POINT" && entity.largestNumber > kLargestCoordinate) {
    return fmt::format("{} has the coordinate {:g}, which is beyond any part", nameOf(entity),
                       entity.largestNumber);
  }
  if (entity.keyword == "VERTEX_POINT" && entity.refCount == 0) {
    return nameOf(entity) + " has no point";
  }
  if (entity.smallInteger) {
    return fmt::format("B-spline #{} has a degree or knot multiplicity below one", entity.id);
  }
  return shortPoint(file, entity);
}

// Copies that each representation unfolds to, by MAPPED_ITEM; depth first with an explicit stack.
double largestUnfolding(const StepText& file) {
  const auto& all = file.entities();
  std::vector<double> copies(all.size(), -1);  // -1 unknown, -2 being counted
  const auto counts = [&](std::size_t i) {
    return all[i].keyword == "MAPPED_ITEM" || all[i].keyword == "REPRESENTATION_MAP" ||
           all[i].keyword.ends_with("SHAPE_REPRESENTATION");
  };
  const auto follows = [&](std::size_t from, std::size_t to) {
    if (all[from].keyword == "MAPPED_ITEM") return all[to].keyword == "REPRESENTATION_MAP";
    if (all[from].keyword == "REPRESENTATION_MAP") {
      return all[to].keyword.ends_with("SHAPE_REPRESENTATION");
    }
    return all[to].keyword == "MAPPED_ITEM";
  };
  double largest = 0;
  for (std::size_t root = 0; root < all.size(); ++root) {
    if (!counts(root)) continue;
    std::vector<std::size_t> stack{root};
    while (!stack.empty()) {
      const std::size_t top = stack.back();
      if (copies[top] >= 0) {
        stack.pop_back();
        continue;
      }
      const bool second = copies[top] == -2;
      copies[top] = -2;
      double sum = 0;
      for (const std::size_t t : file.targets(all[top])) {
        if (!follows(top, t)) continue;
        if (copies[t] >= 0) sum += copies[t];
        if (!second && copies[t] == -1) stack.push_back(t);
      }
      if (stack.back() != top) continue;
      copies[top] = std::max(1.0, sum);
      largest = std::max(largest, copies[top]);
      stack.pop_back();
    }
  }
  return largest;
}

// First circle of references longer than one, or empty.
std::string circleOf(const StepText& file) {
  const auto& all = file.entities();
  enum : char { kNew, kOpen, kDone };
  std::vector<char> state(all.size(), kNew);
  for (std::size_t root = 0; root < all.size(); ++root) {
    if (state[root] != kNew) continue;
    std::vector<std::pair<std::size_t, std::vector<std::size_t>>> path;
    state[root] = kOpen;
    path.emplace_back(root, file.targets(all[root]));
    while (!path.empty()) {
      auto& [node, open] = path.back();
      if (open.empty()) {
        state[node] = kDone;
        path.pop_back();
        continue;
      }
      const std::size_t next = open.back();
      open.pop_back();
      if (state[next] == kOpen) {
        return fmt::format("{} and {} refer to each other in a circle", nameOf(all[node]),
                           nameOf(all[next]));
      }
      if (state[next] == kNew) {
        state[next] = kOpen;
        path.emplace_back(next, file.targets(all[next]));
      }
    }
  }
  return {};
}

struct Unit {
  std::string name;
  double inMm = 1;
};

std::string upperBetweenQuotes(std::string_view text) {
  const std::size_t begin = text.find('\'');
  const std::size_t end = begin == std::string_view::npos ? begin : text.find('\'', begin + 1);
  if (end == std::string_view::npos) return {};
  std::string name(text.substr(begin + 1, end - begin - 1));
  for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

std::optional<Unit> siLength(std::string_view text) {
  if (text.find(".METRE.") == std::string_view::npos) return std::nullopt;
  struct Prefix {
    std::string_view step;
    Unit unit;
  };
  static const Prefix kPrefixes[] = {{".MILLI.", {"mm", 1}},    {".CENTI.", {"cm", 10}},
                                     {".DECI.", {"dm", 100}},   {".KILO.", {"km", 1e6}},
                                     {".MICRO.", {"um", 1e-3}}, {".NANO.", {"nm", 1e-6}}};
  for (const Prefix& prefix : kPrefixes) {
    if (text.find(prefix.step) != std::string_view::npos) return prefix.unit;
  }
  return Unit{"m", 1000};
}

// Names in files vary (INCH, inch, Inches): the factor says what is meant.
Unit conversionUnit(const std::string& name, double inMm) {
  static const Unit kKnown[] = {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}, {"ft", 304.8}};
  for (const Unit& unit : kKnown) {
    if (std::abs(inMm - unit.inMm) <= 1e-9 * unit.inMm) return unit;
  }
  return {name, inMm};
}

std::optional<Unit> lengthUnit(const StepText& file, const StepEntity& entity, int depth = 0) {
  constexpr int kDeepestUnit = 8;
  if (depth > kDeepestUnit) return std::nullopt;
  if (!hasKeyword(entity.text, "LENGTH_UNIT")) return std::nullopt;
  if (hasKeyword(entity.text, "SI_UNIT")) return siLength(entity.text);
  if (!hasKeyword(entity.text, "CONVERSION_BASED_UNIT")) return std::nullopt;
  const std::string name = upperBetweenQuotes(entity.text);
  const auto& all = file.entities();
  for (const std::size_t m : file.targets(entity)) {
    if (!hasKeyword(all[m].text, "LENGTH_MEASURE_WITH_UNIT") &&
        !hasKeyword(all[m].text, "MEASURE_WITH_UNIT")) {
      continue;
    }
    for (const std::size_t u : file.targets(all[m])) {
      if (const auto base = lengthUnit(file, all[u], depth + 1)) {
        return conversionUnit(name, all[m].lastNumber * base->inMm);
      }
    }
  }
  return conversionUnit(name, name == "INCH" ? 25.4 : 1);
}

void findUnits(const StepText& file, StepScan& scan) {
  const auto& all = file.entities();
  bool found = false;
  bool several = false;
  for (const StepEntity& context : all) {
    if (!hasKeyword(context.text, "GLOBAL_UNIT_ASSIGNED_CONTEXT")) continue;
    for (const std::size_t u : file.targets(context)) {
      const auto unit = lengthUnit(file, all[u]);
      if (!unit) continue;
      several = several || (found && unit->inMm != scan.unitInMm);
      if (!found) {
        scan.unit = unit->name;
        scan.unitInMm = unit->inMm;
      }
      found = true;
    }
  }
  if (!found) {
    scan.warnings.push_back("the file gives no length unit: millimetres are assumed");
  } else if (several) {
    scan.warnings.push_back(
        "the file mixes length units: each part is read in its own, all lengths are now mm");
  }
}

bool isShell(const StepEntity& entity) {
  return entity.keyword == "CLOSED_SHELL" || entity.keyword == "OPEN_SHELL";
}

// Faults of shells that OpenCASCADE mends without a word.
void findShellFaults(const StepText& file, StepScan& scan) {
  const auto& all = file.entities();
  for (const StepEntity& entity : all) {
    if (isShell(entity)) {
      std::vector<std::size_t> faces = file.targets(entity);
      std::sort(faces.begin(), faces.end());
      const auto twice = std::adjacent_find(faces.begin(), faces.end());
      if (twice != faces.end()) {
        scan.warnings.push_back(fmt::format("{} lists {} twice: the repetition is dropped",
                                            nameOf(entity), nameOf(all[*twice])));
      }
    } else if (entity.keyword == "MANIFOLD_SOLID_BREP") {
      for (const std::size_t t : file.targets(entity)) {
        if (all[t].keyword != "OPEN_SHELL") continue;
        scan.warnings.push_back(fmt::format("solid {} is bounded by {}, which claims to be open",
                                            nameOf(entity), nameOf(all[t])));
      }
    }
  }
}

void findMissing(const StepText& file, StepScan& scan) {
  int count = 0;
  std::string first;
  for (const StepEntity& entity : file.entities()) {
    const std::int64_t missing = file.missingTarget(entity);
    if (missing == -1) continue;
    if (count++ == 0) {
      first = fmt::format("{} refers to #{}, which is not in the file", nameOf(entity), missing);
    }
  }
  if (count == 0) return;
  scan.warnings.push_back(
      count == 1 ? first : fmt::format("{} (and {} more such references)", first, count - 1));
}

}  // namespace

StepScan scanStep(std::string_view text) {
  StepScan scan;
  const StepText file(text);
  scan.entities = static_cast<int>(file.entities().size());
  if (!file.hasData) {
    scan.defect = "it is cut short: it has no DATA section";
  } else if (!file.dataEnds) {
    scan.defect = "it is cut short in its DATA section (ENDSEC is missing)";
  } else if (file.entities().empty()) {
    scan.defect = "it holds no entities, hence no geometry";
  } else {
    scan.defect = file.defect;
  }
  if (!scan.defect.empty()) return scan;
  for (const StepEntity& entity : file.entities()) {
    if (const auto defect = defectOf(file, entity)) {
      scan.defect = *defect;
      return scan;
    }
    if (entity.keyword == "ADVANCED_FACE" || entity.keyword == "FACE_SURFACE") ++scan.faces;
    if (entity.keyword == "DOCUMENT_FILE") {
      scan.externalFiles.push_back(upperBetweenQuotes(entity.text));
    }
  }
  const double copies = largestUnfolding(file);
  if (copies > kMostInstances) {
    scan.defect = fmt::format("its nested copies unfold to {:.0f} parts (limit {:.0f})", copies,
                              kMostInstances);
    return scan;
  }
  scan.suspicion = circleOf(file);
  scan.endLineMissing = !file.endLine;
  if (scan.endLineMissing) {
    scan.warnings.push_back(
        "the file lacks its last line (END-ISO-10303-21); its data is complete");
  }
  findUnits(file, scan);
  findMissing(file, scan);
  findShellFaults(file, scan);
  return scan;
}

}  // namespace phront::cad
