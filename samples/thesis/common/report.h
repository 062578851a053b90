// What a case prints and writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "phront/grid_field.h"

namespace thesis {

/// Printed with aligned columns and written as CSV.
class Table {
 public:
  /// `definition`: what the figures mean, printed above them.
  Table(std::string title, std::string definition, std::vector<std::string> columns);
  void row(std::vector<std::string> cells);
  void print() const;
  void writeCsv(const std::filesystem::path& path) const;

 private:
  std::string title_;
  std::string definition_;
  std::vector<std::vector<std::string>> rows_;  // the first names the columns
};

/// Errors of |phi| over the nodes that had to be swept.
struct Norms {
  double rms = 0;
  double max = 0;
};
[[nodiscard]] Norms errors(const phront::GridField& swept, const std::vector<double>& exact);

/// The folder from the command line (made when missing), else the current one.
[[nodiscard]] std::filesystem::path outputFolder(int argc, char** argv);

/// The value, or the sentence of the error on stderr and exit 1.
template <class T>
T orStop(phront::Result<T> result);
[[noreturn]] void stop(const std::string& message);

template <class T>
T orStop(phront::Result<T> result) {
  if (!result) stop(result.error().message);
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

}  // namespace thesis
