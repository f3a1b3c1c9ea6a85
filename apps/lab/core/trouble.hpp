// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/lab/core/seen.hpp"

namespace stillhand::lab {

/// State of something that is waited for.
enum class Wait : std::uint8_t { kGoesOn, kOver, kStopped, kTooLong };

/// Why a session cannot go on: an emergency stop, or a process that ended.  Lives as long as the
/// session.  Pure: times in nanoseconds come in.
class Trouble {
 public:
  /// Takes in what is seen now.  A process's end counts 50 ms after it was seen: Ctrl-C also
  /// reaches a process that is just starting, and then the interruption is the reason.
  /// @param over  what is waited for is there; it counts before trouble and time
  Wait wait(bool over, Seen& seen, std::int64_t limit_ns, std::int64_t now_ns);

  /// A process ended less than 50 ms ago: nothing else counts until that time is over.
  [[nodiscard]] bool settles() const noexcept { return since_ns_.has_value(); }
  /// Empty: no trouble.
  [[nodiscard]] const std::string& why() const noexcept { return why_; }
  /// A process refused what the user gave it.
  [[nodiscard]] bool refused() const noexcept { return refused_; }
  /// A process's life sign is gone, and the process may still be there.
  [[nodiscard]] bool silent() const noexcept { return silent_; }
  /// The trouble, "interrupted", or else `otherwise`.
  [[nodiscard]] std::string why_stopped(const Seen& seen, const std::string& otherwise) const;

 private:
  void look(Seen& seen, std::int64_t now_ns);

  std::string why_;
  bool refused_ = false;
  bool silent_ = false;
  std::optional<std::int64_t> since_ns_;  // a process's end was seen
};

}  // namespace stillhand::lab
