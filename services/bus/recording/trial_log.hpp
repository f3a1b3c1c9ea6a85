// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <mutex>

#include "services/bus/found_writer.hpp"
#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// Trials announced while a file is written.  The threads of DDS call take(); any thread may call
/// the other functions.
class TrialLog {
 public:
  void take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample);
  /// Number of the newest trial, -1 before the first.
  [[nodiscard]] std::int64_t newest() const;
  /// Metadata record "stillhand.trials".
  [[nodiscard]] TextMap texts() const;

 private:
  mutable std::mutex mutex_;
  std::int64_t newest_ = -1;
  TextMap texts_;
};

}  // namespace stillhand::recording
