#include "judge/read_back.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "judge/check_topology.h"
#include "phront/cad/exchange.h"
#include "phront/cad/shape_occt.h"

namespace phront::cad {
namespace {

namespace fs = std::filesystem;

constexpr GuardLimits kLimits{20, 2000};

/// A folder of its own that goes with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string name = (fs::temp_directory_path(error) / "phront-XXXXXX").string();
    std::vector<char> pattern(name.begin(), name.end());
    pattern.push_back('\0');
    if (!error && ::mkdtemp(pattern.data()) != nullptr) path_ = pattern.data();
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string faultOf(const TopoDS_Shape& shape, bool solid, const MeshSize& size) {
  const TopologyFigures figures = measureTopology(shape);
  if (solid && figures.solids == 0) return "the file holds no solid";
  if (solid && !figures.closed()) return "read back from a file it is not closed";
  if (!figures.valid) return "read back from a file it is not valid";
  const std::size_t bad = facesWithoutTriangles(shape, size).size();
  if (bad > 0) return fmt::format("read back from a file {} faces cannot be tessellated", bad);
  return {};
}

}  // namespace

Result<std::optional<Model>> readBack(const std::vector<Body>& bodies) {
  const TemporaryFolder folder;
  if (folder.path().empty()) return std::nullopt;
  const fs::path file = folder.path() / "result.step";
  Model out;
  out.bodies = bodies;
  if (const Result<void> written = writeModel(out, file); !written)
    return tl::unexpected(written.error());
  ReadOptions asWritten;
  asWritten.repair = false;
  Result<Model> back = readModel(file, asWritten);
  if (!back) return tl::unexpected(back.error());
  return std::optional<Model>(std::move(*back));
}

std::size_t fingerprintOf(const Model& model) {
  std::string bytes;
  for (const Body& body : model.bodies) bytes += bytesOfShape(occtShape(body.shape));
  return std::max<std::size_t>(1, std::hash<std::string>{}(bytes));
}

std::string exchangeFault(const Model& out, const MeshSize& size) {
  const Result<std::optional<Model>> tried = readBack(out.bodies);
  if (!tried) return tried.error().message;
  const std::optional<Model>& back = *tried;
  if (!back) return {};  // the written result is checked anyway
  const bool solid = std::any_of(out.bodies.begin(), out.bodies.end(),
                                 [](const Body& b) { return b.kind == BodyKind::Solid; });
  const Result<std::string> fault =
      runInChild("looking at the file", kLimits, [&]() -> Result<std::string> {
        const BRep_Builder builder;
        TopoDS_Compound all;
        builder.MakeCompound(all);
        for (const Body& body : back->bodies) builder.Add(all, occtShape(body.shape));
        return faultOf(all, solid, size);
      });
  return fault ? *fault : fault.error().message;
}

void checkExchange(const std::vector<Body>& bodies, const OffsetScale& scale, CheckResult& check) {
  if (!check.pass()) return;
  Model out;
  out.bodies = bodies;
  std::string fault = exchangeFault(out, usualMeshSize(scale));
  if (!fault.empty()) check.reasons.push_back(std::move(fault));
}

}  // namespace phront::cad
