// What the commands that work body by body tell of them.
#pragma once

#include <string>
#include <vector>

#include "cli.h"
#include "phront/cad/offset_shape.h"

namespace phront::cli {

[[nodiscard]] nlohmann::json jsonOf(const std::vector<cad::BodyReport>& bodies);
[[nodiscard]] nlohmann::json jsonOf(const std::vector<cad::StageTime>& times);

/// "12 exact faces, 3 fitted faces, 40 planar facets in place of curved faces"
[[nodiscard]] std::string facesOf(const std::vector<cad::BodyReport>& bodies, bool solid);

/// One sentence on stderr, unless quiet.
void say(const CommonOptions& options, const std::string& sentence);
/// With -v: attempts and times.
void sayDetails(const CommonOptions& options, const std::vector<cad::BodyReport>& bodies,
                const std::vector<cad::StageTime>& times);

/// Resolves --tol; empty when not given. Error: one sentence.
[[nodiscard]] Result<std::optional<double>> toleranceOf(const CommonOptions& options);

}  // namespace phront::cli
