// What the commands of the phront executable share: exit codes, lengths, progress, reports.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "phront/cad/check.h"
#include "phront/cad/shape.h"
#include "phront/cad/tessellate.h"
#include "phront/progress.h"
#include "phront/status.h"
#include "phront/tri_mesh.h"

namespace phront::cli {

/// Stable, documented in README, tested.
enum ExitCode {
  kDone = 0,
  kFailed = 1,
  kUsage = 2,
  kUnreadable = 3,
  kOutOfTolerance = 4,
  kInterrupted = 130,
};

/// Options every command takes.
struct CommonOptions {
  std::string tolerance;  ///< length text, empty: automatic
  int threads = 0;
  std::string unit = "mm";  ///< unit of lengths given without one
  std::filesystem::path report;
  std::filesystem::path picture;
  bool keep = false;
  bool quiet = false;
  bool verbose = false;
};
void addCommonOptions(CLI::App& command, CommonOptions& options);

/// "2", "2mm", "0.1in" -> millimetres; a bare number counts in `defaultUnit`. Error: one sentence.
[[nodiscard]] Result<double> parseLength(const std::string& text, const std::string& defaultUnit);

/// Prints "phront: sentence" on stderr and gives the exit code that belongs to the error.
int reportError(const Error& error);
int reportUsage(const std::string& sentence);

/// Progress bar on stderr when it is a terminal and not quiet; stops the work after Ctrl-C.
[[nodiscard]] Progress makeProgress(const CommonOptions& options);
/// Wipes the bar.
void endProgress(const CommonOptions& options);
void installInterruptHandler();
[[nodiscard]] bool interrupted();

/// Refuses, before any work is done, an output that could not be written later: its folder missing
/// or not writable, a directory, or the same file as the input.
[[nodiscard]] Result<void> checkOutputPath(const std::filesystem::path& out,
                                           const std::filesystem::path& in);

/// True for .stl .obj .ply .vtu.
[[nodiscard]] bool isMeshPath(const std::filesystem::path& path);

/// Writes the JSON report when one is asked for ("-" is stdout).
[[nodiscard]] Result<void> writeReport(const nlohmann::json& report, const CommonOptions& options);

[[nodiscard]] nlohmann::json jsonOf(const cad::CheckResult& check);
[[nodiscard]] const char* wordFor(cad::SurfaceType type);

/// Adds a mesh to another; its face labels are numbered on from those already there.
void appendMesh(TriMesh& all, const TriMesh& part);
/// Reads a mesh and turns triangles that disagree with their neighbours; warns on stderr, unless
/// quiet, of that and of what keeps it from being a closed surface.
[[nodiscard]] Result<TriMesh> readSurface(const std::filesystem::path& path,
                                          const CommonOptions& options);
/// All bodies' triangles in one mesh, each face with its own label. `deflection` in mm.
[[nodiscard]] Result<TriMesh> meshOfModel(const cad::Model& model, double deflection);

/// Draws input and result side by side when a picture is asked for.
[[nodiscard]] Result<void> drawModels(const cad::Model& in, const std::string& inCaption,
                                      const cad::Model& out, const std::string& outCaption,
                                      const CommonOptions& options);
[[nodiscard]] Result<void> drawMeshes(const TriMesh& in, const std::string& inCaption,
                                      const TriMesh& out, const std::string& outCaption,
                                      const CommonOptions& options);

/// Sub-commands: each adds itself to the app and sets `exitCode` when it ran.
void addOffsetCommand(CLI::App& app, int& exitCode);
void addShellCommand(CLI::App& app, int& exitCode);
void addInfoCommand(CLI::App& app, int& exitCode);
void addFieldCommand(CLI::App& app, int& exitCode);
void addCheckCommand(CLI::App& app, int& exitCode);

}  // namespace phront::cli
