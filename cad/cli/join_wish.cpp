#include "join_wish.h"

#include <map>
#include <string>

namespace phront::cli {

void addJoinWish(CLI::App& command, JoinWish& wish) {
  const std::map<std::string, cad::Join> joins{{"arc", cad::Join::Arc},
                                               {"mitre", cad::Join::Mitre}};
  command
      .add_option("--join", wish.join,
                  "Edges and corners: arc (rounded, true distance) or mitre (faces extended until "
                  "they meet)")
      ->transform(CLI::CheckedTransformer(joins))
      ->option_text("arc|mitre");
  command
      .add_option("--mitre-limit", wish.mitreLimit,
                  "Corners that reach farther from the part, in distances, stay round")
      ->capture_default_str();
}

}  // namespace phront::cli
