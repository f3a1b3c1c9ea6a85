// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stillhand::recording {

/// Rate of a replay in thousandths of real time, 0.1 to 100.
struct PlayRate {
  std::int64_t per_mille = 1000;  ///< [1/1000] 100 to 100 000

  static constexpr std::int64_t kSlowest = 100;
  static constexpr std::int64_t kFastest = 100'000;

  /// Parses "1", "0.25" or "100", with at most three decimals; nothing for any other text.
  static std::optional<PlayRate> parse(std::string_view text) noexcept;
  [[nodiscard]] std::string text() const;
  /// The next step up or down of 0.1 0.2 0.5 1 2 5 10 20 50 100.
  [[nodiscard]] PlayRate faster() const noexcept;
  [[nodiscard]] PlayRate slower() const noexcept;
  bool operator==(const PlayRate&) const = default;
};

/// Position of a replay, and the time at which a recorded instant is due:
///
///   recorded = R0 + floor((now - N0) rate / 1000),   due = N0 + ceil((recorded - R0) 1000 / rate)
/// The anchor (N0, R0) changes only at a pause, a seek or a change of the rate.  Errors of single
/// releases therefore never accumulate; each change rounds by at most 1 ns.  All values are
/// integers.  `now` is any steady clock of the caller [ns].
/// Source: README Eq. RC-12 and RC-13.  Pure; one thread.
class PlayClock {
 public:
  PlayClock(std::int64_t now_ns, std::int64_t recorded_ns, PlayRate rate) noexcept
      : now0_ns_(now_ns), recorded0_ns_(recorded_ns), rate_(rate) {}

  /// The recorded instant at the time `now_ns`.
  [[nodiscard]] std::int64_t recorded_at(std::int64_t now_ns) const noexcept;
  /// The time at which a recorded instant is due; nothing while paused.
  [[nodiscard]] std::optional<std::int64_t> due(std::int64_t recorded_ns) const noexcept;

  void pause(std::int64_t now_ns) noexcept;
  void resume(std::int64_t now_ns) noexcept;
  void seek(std::int64_t now_ns, std::int64_t recorded_ns) noexcept;
  void set_rate(std::int64_t now_ns, PlayRate rate) noexcept;

  [[nodiscard]] bool paused() const noexcept { return paused_; }
  [[nodiscard]] PlayRate rate() const noexcept { return rate_; }

 private:
  std::int64_t now0_ns_;
  std::int64_t recorded0_ns_;
  PlayRate rate_;
  bool paused_ = false;
};

}  // namespace stillhand::recording
