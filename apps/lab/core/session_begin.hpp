// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/lab/core/stage.hpp"
#include "apps/lab/core/trouble.hpp"

namespace stillhand::lab {

/// Waits until every endpoint of the session has matched.
class Matching final : public Stage {
 public:
  /// @param bus      "domain 3 rig 1", for the error line
  /// @param limit_s  [s] patience, positive
  Matching(const Roster& roster, std::string bus, double limit_s, Trouble& trouble);

  Actions step(Seen& seen, std::int64_t now_ns) override;
  [[nodiscard]] bool complete() const noexcept { return complete_; }
  /// Another session is on the bus, or the time is over; empty: neither.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  [[nodiscard]] std::vector<std::string> absent(const Seen& seen) const;
  [[nodiscard]] std::string describe(const Seen& seen) const;

  const Roster& roster_;
  std::string bus_;
  double limit_s_;
  Trouble& trouble_;
  std::int64_t limit_ns_ = -1;  // -1: before the first step
  bool complete_ = false;
  std::string failure_;
};

/// Announces that the session runs and waits until the sample clock ticks, at most 5 s.
class ClockStart final : public Stage {
 public:
  ClockStart(const Roster& roster, Trouble& trouble) : roster_(roster), trouble_(trouble) {}

  Actions step(Seen& seen, std::int64_t now_ns) override;
  /// The sample clock did not start in time; empty: it did, or trouble came first.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  const Roster& roster_;
  Trouble& trouble_;
  std::int64_t limit_ns_ = -1;  // -1: before the first step
  std::string failure_;
};

}  // namespace stillhand::lab
