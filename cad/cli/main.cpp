// The phront executable: a thin layer over the libraries.
#include "cli.h"

int main(int argc, char** argv) {
  using namespace phront::cli;
  CLI::App app(
      "phront: offsets of CAD parts and meshes that do not fail.\n"
      "Lengths are in mm unless a unit is given (2mm, 0.1in); a file's own unit is honoured.\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 unreadable input, 4 outside tolerance,\n"
      "130 interrupted.");
  app.set_version_flag("--version", "phront " PHRONT_VERSION);
  app.require_subcommand(1);
  int exitCode = kDone;
  addOffsetCommand(app, exitCode);
  addShellCommand(app, exitCode);
  addInfoCommand(app, exitCode);
  addFieldCommand(app, exitCode);
  addCheckCommand(app, exitCode);
  installInterruptHandler();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int shown = app.exit(error);
    return shown == 0 ? kDone : kUsage;
  }
  return interrupted() ? kInterrupted : exitCode;
}
