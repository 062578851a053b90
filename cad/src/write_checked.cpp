#include "write_checked.h"

#include <fmt/format.h>

#include <system_error>

#include "deadline.h"
#include "judge/read_back.h"
#include "phront/cad/exchange.h"

namespace phront::cad {
namespace {

// For writing, reading back and checking what was read: up to so many time limits in all.
constexpr double kWithReadBack = 1.4;
constexpr double kReadBackShare = 0.6;
constexpr double kLeastReadBackSeconds = 10;
constexpr double kMostReadBackSeconds = 45;

}  // namespace

Result<std::filesystem::path> writeChecked(const Model& model, const WriteRequest& request,
                                           const Recheck& recheck, CheckResult& check) {
  std::filesystem::path aside = request.path;
  aside.replace_extension(".unchecked" + request.path.extension().string());
  double spent = 0;
  for (const StageTime& time : request.times) spent += time.seconds;
  const Deadline deadline(kWithReadBack * request.timeLimit - spent);
  if (Result<void> written = writeModel(model, aside); !written)
    return tl::unexpected(written.error());

  if (check.pass()) {
    ReadOptions asWritten;
    asWritten.repair = false;
    asWritten.timeLimit =
        deadline.forStep(kReadBackShare, kLeastReadBackSeconds, kMostReadBackSeconds);
    const Result<Model> back = readModel(aside, asWritten);
    if (!back) {
      check.reasons.push_back("the written file cannot be read back: " + back.error().message);
    } else if (request.checkedFile == 0 || fingerprintOf(*back) != request.checkedFile) {
      const Result<CheckResult> again =
          recheck(*back, deadline.forStep(1, kLeastReadBackSeconds, kMostReadBackSeconds));
      if (!again)
        check.reasons.push_back("the written file cannot be checked: " + again.error().message);
      else
        for (const std::string& reason : again->reasons)
          check.reasons.push_back("read back from the file: " + reason);
    }
  }
  const std::filesystem::path target =
      check.pass() || request.keep ? request.path : rejectedPath(request.path);
  std::error_code error;
  std::filesystem::rename(aside, target, error);
  if (error) {
    std::filesystem::remove(aside, error);
    return fail(ErrorCode::CannotWrite, fmt::format("cannot rename to {}", target.string()));
  }
  return target;
}

}  // namespace phront::cad
