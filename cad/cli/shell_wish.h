// What a shell is asked for on the command line.
#pragma once

#include <string>

#include "cli.h"
#include "face_wish.h"
#include "phront/cad/shell_shape.h"

namespace phront::cli {

struct ShellWish {
  std::string thickness;
  std::string open;
  std::string side = "in";
};

/// -t, --open and --side.
CLI::Option* addShellWish(CLI::App& command, ShellWish& wish);  // returns that of -t

/// As options of the library; the tolerance and threads are those of `common`.
[[nodiscard]] Result<cad::ShellOptions> resolve(const ShellWish& wish, const FaceWish& faces,
                                                const cad::Model& model,
                                                const CommonOptions& common);

}  // namespace phront::cli
