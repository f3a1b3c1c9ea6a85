// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "services/core/device_rig/drive_reply.hpp"

namespace stillhand::device_rig {

/// What the drive is sent.
enum class Order : std::uint8_t {
  kQuery,  ///< state alone; it does not feed the watchdog
  kStop,   ///< driver off; clears a fault and a timeout, which latch until then
  kTorque  ///< a torque; the only order that feeds the watchdog
};

/// What a drive's own settings must be before it may be armed, DEVICES "The drive's settings".
struct SettingLimits {
  double max_current_a = 10.0;  ///< current limit, at most
  double travel_rev = 0.1;      ///< of the stick to each side: position limits lie outside
};

/// What is wrong with a setting, and the drive's own command that mends it.
struct SettingFault {
  std::string name, got, want, mend;
};

/// Hears what a drive says.
class DriveListener {
 public:
  virtual void state(const DriveReply& reply) noexcept = 0;
  /// Something came that was not understood, or not whole.
  virtual void damaged() noexcept = 0;

 protected:
  ~DriveListener() = default;
};

/// The language of a drive: orders to bytes, bytes to states.  No clock and no descriptor; order()
/// and take() never allocate.  A returned view holds until the next call.  One thread.
class DriveProtocol {
 public:
  virtual ~DriveProtocol() = default;

  /// What the drive is called in messages, "drive 1".
  [[nodiscard]] virtual std::string name() const = 0;
  /// What an answer needs, for a person who gets none.
  [[nodiscard]] virtual std::string_view needs() const noexcept = 0;
  /// First bytes on a port that was opened.
  virtual std::string_view greeting() noexcept { return {}; }
  /// Ends a piece of a message that the port took; empty: a message is never taken in pieces.
  [[nodiscard]] virtual std::string_view end_of_piece() const noexcept { return {}; }
  /// Forgets what came, for a port that was opened again.
  virtual void clear() noexcept = 0;

  /// @param torque_n_m  at the stick's shaft; one that is not finite becomes 0, and one beyond
  ///                    the settings' bound the bound
  virtual std::string_view order(Order order, double torque_n_m) noexcept = 0;
  virtual void take(std::string_view bytes, DriveListener& listener) noexcept = 0;

  /// Settings that are read back, one at a time: ask, poll until there is an answer, judge.
  [[nodiscard]] virtual std::span<const std::string_view> settings() const noexcept = 0;
  virtual std::string_view ask(std::string_view name) noexcept = 0;
  /// What fetches an answer that does not come by itself; may be empty.
  virtual std::string_view poll() noexcept { return {}; }
  [[nodiscard]] virtual std::optional<std::string> answer() const = 0;
  /// @returns nothing if the setting is right
  [[nodiscard]] virtual std::optional<SettingFault> judge(std::string_view name,
                                                          std::string_view text) const = 0;

  /// Asks the drive who it is, and forgets the answer of before.
  virtual std::string_view ask_serial() noexcept = 0;
  [[nodiscard]] virtual std::optional<std::string> serial() const = 0;
};

}  // namespace stillhand::device_rig
