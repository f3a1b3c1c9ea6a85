// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "apps/lab/core/stage.hpp"
#include "apps/lab/core/trouble.hpp"

namespace stillhand::lab {

/// A rest between two trials.  It ends after its time, with a request for a start, or when there is
/// trouble, which the next stage reports.
class Rest final : public Stage {
 public:
  /// @param what     for the person at the terminal
  /// @param seconds  [s] 0 or more
  Rest(std::string what, double seconds, Trouble& trouble)
      : what_(std::move(what)), seconds_(seconds), trouble_(trouble) {}

  Actions step(Seen& seen, std::int64_t now_ns) override;

 private:
  std::string what_;
  double seconds_;
  Trouble& trouble_;
  std::int64_t limit_ns_ = -1;  // -1: before the first step
  std::int64_t starts_ = 0;     // requests for a start at the first step
};

}  // namespace stillhand::lab
