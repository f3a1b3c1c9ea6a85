// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "apps/lab/core/stage.hpp"
#include "apps/lab/core/trouble.hpp"

namespace stillhand::lab {

/// Waits for the model that identification makes of a pegged trial, at most 60 s.
class ModelWait final : public Stage {
 public:
  ModelWait(std::int64_t trial, Trouble& trouble) : trial_(trial), trouble_(trouble) {}

  Actions step(Seen& seen, std::int64_t now_ns) override;
  /// Why there is no usable model; empty: there is one.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  std::int64_t trial_;
  Trouble& trouble_;
  std::int64_t limit_ns_ = -1;  // -1: before the first step
  std::string failure_;
};

/// Gives the canceller a model and waits for its answer, at most 5 s.
class ModelUse final : public Stage {
 public:
  explicit ModelUse(Trouble& trouble) : trouble_(trouble) {}

  Actions step(Seen& seen, std::int64_t now_ns) override;
  /// Why the canceller refused the model; empty: it took it, or did not answer.
  [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }
  /// Why it did not answer; empty: it did.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  Trouble& trouble_;
  std::int64_t limit_ns_ = -1;  // -1: before the first step
  std::string refusal_, failure_;
};

/// Waits until the recorder's disk has a trial, at most 10 s.
class RecordingWait final : public Stage {
 public:
  /// @param end_tick  first tick after the trial
  RecordingWait(Tick end_tick, Trouble& trouble) : end_tick_(end_tick), trouble_(trouble) {}

  Actions step(Seen& seen, std::int64_t now_ns) override;
  /// Why the trial is not there; empty: it is.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  Tick end_tick_;
  Trouble& trouble_;
  std::int64_t limit_ns_ = -1;  // -1: before the first step
  std::string failure_;
};

}  // namespace stillhand::lab
