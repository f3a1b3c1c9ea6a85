// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "apps/lab/core/stage.hpp"
#include "apps/lab/core/trouble.hpp"

namespace stillhand::lab {

/// A rest between two trials.  It ends after its time, or when there is trouble, which the next
/// stage reports; one that waits for something when that is there, any other with a request for a
/// start.
class Rest final : public Stage {
 public:
  /// @param what     for the person at the terminal
  /// @param seconds  [s] 0 or more
  /// @param is_there  what it waits for; empty: its time
  Rest(std::string what, double seconds, Trouble& trouble, std::function<bool()> is_there = {})
      : what_(std::move(what)),
        seconds_(seconds),
        trouble_(trouble),
        is_there_(std::move(is_there)) {}

  Actions step(Seen& seen, std::int64_t now_ns) override;

 private:
  std::string what_;
  double seconds_;
  Trouble& trouble_;
  std::function<bool()> is_there_;
  std::int64_t limit_ns_ = -1;  // -1: before the first step
  std::int64_t starts_ = 0;     // requests for a start at the first step
};

}  // namespace stillhand::lab
