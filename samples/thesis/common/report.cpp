#include "common/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "phront/mesh_io.h"

namespace thesis {

Table::Table(std::string title, std::string definition, std::vector<std::string> columns)
    : title_(std::move(title)), definition_(std::move(definition)), rows_{std::move(columns)} {}

void Table::row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

void Table::print() const {
  std::vector<std::size_t> width(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  }
  fmt::print("{}\n{}\n", title_, definition_);
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < row.size(); ++c) fmt::print("  {:>{}}", row[c], width[c]);
    fmt::print("\n");
  }
  fmt::print("\n");
}

void Table::writeCsv(const std::filesystem::path& path) const {
  std::string text = "# " + title_ + "; " + definition_ + "\n";
  for (const auto& row : rows_) text += fmt::format("{}\n", fmt::join(row, ","));
  orStop(phront::writeFileAtomically(path, text));
}

Norms errors(const phront::GridField& swept, const std::vector<double>& exact) {
  Norms norms;
  std::size_t count = 0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    if (swept.seed[n]) continue;
    const double error = std::abs(std::abs(swept.phi[n]) - std::abs(exact[n]));
    norms.rms += error * error;
    norms.max = std::max(norms.max, error);
    ++count;
  }
  if (count > 0) norms.rms = std::sqrt(norms.rms / static_cast<double>(count));
  return norms;
}

std::filesystem::path outputFolder(int argc, char** argv) {
  std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) stop("cannot make the folder " + folder.string() + ": " + error.message());
  return folder;
}

void stop(const std::string& message) {
  fmt::print(stderr, "{}\n", message);
  std::exit(1);
}

}  // namespace thesis
