// A legitimate engine by trial: no single setting of General Fuse serves all parts, uniform
// settings are not even monotone, so several are tried and each result is judged; the first that
// passes wins. Every trial runs in a child of its own, since General Fuse crashes, loops and eats
// memory.

#include "rebuild/attempt_runner.h"

#include <fmt/format.h>

#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "exchange/guard.h"
#include "exchange/shape_bytes.h"
#include "phront/cad/shape_occt.h"
#include "rebuild/reunite.h"

namespace phront::cad {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kAttemptMemoryMiB = 3000;
constexpr double kCheckSeconds = 30;
constexpr double kLeastCheckSeconds = 10;  // also past the deadline: an attempt is worth it
// No attempt is started with less time than this left, s.
constexpr double kLeastAttempt = 1;
constexpr double kReuniteSeconds = 5;
// Nor with less than this share of the time that another setting took or found too short.
constexpr double kShareOfOthers = 0.25;
constexpr double kShareOfTimeout = 0.5;

struct Trial {
  std::string line;
  std::optional<JudgedAttempt> judged;
  TopoDS_Shape pieces;
  bool accepted = false;
  double seconds = 0;
  bool timedOut = false;
};

// Bytes across the process border: 8 bytes of header length, JSON header, a compound of the shape
// and the pieces, which share much, as far as there are any.
std::string packAttempt(const AttemptResult& attempt) {
  const nlohmann::json header = {{"raw", attempt.rawFaces},
                                 {"split", attempt.splitFaces},
                                 {"kept", attempt.keptFaces},
                                 {"open", attempt.openEdges},
                                 {"fitted", attempt.fittedFaces},
                                 {"fault", attempt.fault},
                                 {"notes", attempt.notes},
                                 {"hasShape", !attempt.shape.IsNull()},
                                 {"hasPieces", !attempt.pieces.IsNull()}};
  const std::string text = header.dump();
  const BRep_Builder builder;
  TopoDS_Compound both;
  builder.MakeCompound(both);
  if (!attempt.shape.IsNull()) builder.Add(both, attempt.shape);
  if (!attempt.pieces.IsNull()) builder.Add(both, attempt.pieces);
  return fmt::format("{:08d}", text.size()) + text + bytesOfShape(both);
}

Result<AttemptResult> unpackAttempt(const std::string& bytes) {
  const std::size_t headerSize = std::stoul(bytes.substr(0, 8));
  const auto header = nlohmann::json::parse(bytes.substr(8, headerSize));
  AttemptResult attempt;
  attempt.rawFaces = header["raw"];
  attempt.splitFaces = header["split"];
  attempt.keptFaces = header["kept"];
  attempt.openEdges = header["open"];
  attempt.fittedFaces = header["fitted"];
  attempt.fault = header["fault"];
  attempt.notes = header["notes"].get<std::vector<std::string>>();
  Result<TopoDS_Shape> both = shapeOfBytes(std::string_view(bytes).substr(8 + headerSize));
  if (!both) return tl::unexpected(both.error());
  TopoDS_Iterator part(*both);
  for (const auto& [name, target] :
       {std::pair{"hasShape", &attempt.shape}, std::pair{"hasPieces", &attempt.pieces}}) {
    if (!header[name].get<bool>()) continue;
    *target = part.Value();
    part.Next();
  }
  return attempt;
}

Trial runTrial(const Body& healed, const OffsetOptions& options, const TrueDistance& phi,
               const BodyCheck& check, const AttemptSetting& setting, const Deadline& deadline) {
  const Clock::time_point start = Clock::now();
  Trial trial;
  const auto say = [&](const std::string& outcome) {
    trial.seconds = secondsSince(start);
    trial.line = fmt::format("{}: {} ({:.1f} s)", setting.name, outcome, trial.seconds);
  };
  const bool solid = healed.kind == BodyKind::Solid;
  const Result<std::string> bytes = runInChild(
      "offset by exact patches", {setting.timeLimit, kAttemptMemoryMiB},
      [&]() -> Result<std::string> {
        Result<AttemptResult> attempt = tryExactOffset(
            occtShape(healed.shape), solid, setting.reach * options.distance, phi, setting);
        if (!attempt) return tl::unexpected(attempt.error());
        return packAttempt(*attempt);
      });
  if (!bytes) {
    trial.timedOut = bytes.error().code == ErrorCode::ResourceLimit;
    say(bytes.error().message);
    return trial;
  }
  const Result<AttemptResult> attempt = unpackAttempt(*bytes);
  if (!attempt) {
    say(attempt.error().message);
    return trial;
  }
  trial.pieces = attempt->pieces;
  if (!attempt->fault.empty()) {
    say(attempt->fault);
    return trial;
  }
  const std::string counts =
      fmt::format("{} raw faces, {} pieces, {} kept, {} fitted", attempt->rawFaces,
                  attempt->splitFaces, attempt->keptFaces, attempt->fittedFaces);
  if (attempt->shape.IsNull()) {
    say("nothing left; " + counts);
    return trial;
  }
  JudgedAttempt judged;
  judged.setting = setting.name;
  judged.reach = setting.reach;
  judged.fittedFaces = attempt->fittedFaces;
  // False where the shape itself is at fault, not where it lies.
  const auto judge = [&](const TopoDS_Shape& shape) {
    judged.bodies = bodiesOf(shape, healed.kind, healed.name);
    judged.file = check.fromFile(judged.bodies, options,
                                 deadline.forStep(1, kLeastCheckSeconds, kCheckSeconds));
    return judged.file.check.pass() || judged.file.check.sound();
  };
  TopoDS_Shape whole;
  if (solid && attempt->fittedFaces == 0)
    whole = reuniteFaces(attempt->shape, phi, std::clamp(deadline.left(), 1.0, kReuniteSeconds));
  if (whole.IsNull() || !judge(whole)) judge(attempt->shape);
  const CheckResult& verdict = judged.file.check;
  trial.accepted = verdict.pass();
  say((trial.accepted ? "accepted; " : "rejected: " + verdict.reasons.front() + "; ") + counts);
  trial.judged = std::move(judged);
  return trial;
}

}  // namespace

std::vector<Body> bodiesOf(const TopoDS_Shape& shape, BodyKind kind, const std::string& name) {
  std::vector<Body> bodies;
  const auto add = [&](const TopoDS_Shape& part) {
    Body body;
    body.shape = makeShape(part);
    body.kind = kind;
    body.name = name;
    bodies.push_back(std::move(body));
  };
  const TopAbs_ShapeEnum type = kind == BodyKind::Solid ? TopAbs_SOLID : TopAbs_SHELL;
  for (TopExp_Explorer part(shape, type); part.More(); part.Next()) add(part.Current());
  if (kind == BodyKind::Sheet) {
    for (TopExp_Explorer face(shape, TopAbs_FACE, TopAbs_SHELL); face.More(); face.Next())
      add(face.Current());
  }
  return bodies;
}

AttemptLog runAttempts(const Body& healed, const OffsetOptions& options, const TrueDistance& phi,
                       const BodyCheck& check, const Deadline& deadline, const Progress& progress) {
  const std::vector<AttemptSetting> settings = attemptSettings();
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const unsigned threads = options.threads > 0 ? static_cast<unsigned>(options.threads) : cores;
  const std::size_t wave = threads >= 2 ? 2 : 1;
  const bool sheet = healed.kind == BodyKind::Sheet;
  AttemptLog log;
  double leastWorth = kLeastAttempt;
  const auto serves = [&](const AttemptSetting& setting) {
    return !sheet || (setting.reach == 1 && setting.repairSeconds == 0 && !setting.dividesBends);
  };
  for (std::size_t next = 0; next < settings.size() && !log.accepted;) {
    const double left = deadline.left();
    if (left < leastWorth || !progress.report(static_cast<double>(next) / settings.size())) break;
    std::vector<AttemptSetting> chosen;
    for (; next < settings.size() && chosen.size() < wave; ++next) {
      if (!serves(settings[next])) continue;
      chosen.push_back(settings[next]);
      chosen.back().timeLimit = std::min(chosen.back().timeLimit, left);
    }
    std::vector<Trial> trials(chosen.size());
    std::vector<std::atomic<bool>> notNeeded(chosen.size());
    std::vector<std::thread> runners;  // they only wait for their child process
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      runners.emplace_back([&, i] {
        const CancelScope scope(notNeeded[i]);
        trials[i] = runTrial(healed, options, phi, check, chosen[i], deadline);
        if (!trials[i].accepted) return;
        for (std::size_t later = i + 1; later < chosen.size(); ++later) notNeeded[later] = true;
      });
    }
    for (std::thread& runner : runners) runner.join();
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      Trial& trial = trials[i];
      if (log.accepted) break;  // done, or stopped on the way
      leastWorth =
          std::max(leastWorth, (trial.timedOut ? kShareOfTimeout : kShareOfOthers) * trial.seconds);
      log.lines.push_back(trial.line);
      if (!trial.accepted && !trial.pieces.IsNull())
        log.open.push_back({chosen[i].name, chosen[i].reach, trial.pieces});
      if (!trial.judged) continue;
      const CheckResult& verdict = trial.judged->file.check;
      if (trial.accepted) {
        log.accepted = std::move(trial.judged);
      } else if (!log.rejected && verdict.valid && (verdict.closed || sheet)) {
        log.rejected = std::move(trial.judged);
      }
    }
  }
  return log;
}

}  // namespace phront::cad
