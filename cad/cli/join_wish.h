// How offsets and their checks are to go round edges and corners.
#pragma once

#include "cli.h"

namespace phront::cli {

struct JoinWish {
  cad::Join join = cad::Join::Arc;
  double mitreLimit = cad::kMitreLimit;
};

/// --join and --mitre-limit.
void addJoinWish(CLI::App& command, JoinWish& wish);

}  // namespace phront::cli
