// One handle for progress and cancellation that travels down the call tree.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace phront {

/// Reports progress in [0, 1] and carries the wish to stop back. Cheap to copy.
/// A default-constructed Progress reports to nobody and never cancels.
/// Not thread safe: call it from the thread that started the operation.
class Progress {
 public:
  /// `fraction` in [0, 1], `stage` a short name; return false to cancel.
  using Callback = std::function<bool(double fraction, std::string_view stage)>;

  Progress() = default;
  explicit Progress(Callback callback) : callback_(std::move(callback)) {}

  /// False when the caller asked to stop; the operation then returns ErrorCode::Cancelled.
  [[nodiscard]] bool report(double fraction) const {
    return !callback_ || callback_(from_ + (to_ - from_) * fraction, stage_);
  }

  /// A handle for a part of the work that covers [from, to] of this one.
  [[nodiscard]] Progress part(double from, double to, std::string stage = {}) const {
    Progress p = *this;
    p.from_ = from_ + (to_ - from_) * from;
    p.to_ = from_ + (to_ - from_) * to;
    if (!stage.empty()) p.stage_ = std::move(stage);
    return p;
  }

 private:
  Callback callback_;
  double from_ = 0;
  double to_ = 1;
  std::string stage_;
};

}  // namespace phront
