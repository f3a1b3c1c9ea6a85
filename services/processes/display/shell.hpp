// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/bus/emergency_stop.hpp"
#include "services/bus/service.hpp"
#include "services/core/display/tracking_display.hpp"
#include "services/messages/display/codec.hpp"
#include "services/system/process/handover.hpp"
#include "services/system/process/latest_value.hpp"

namespace stillhand::display {

/// What the screen shows, handed from the 1 kHz data to the 60 Hz frames.
struct Shown {
  Tick tick = -1;
  TrackingSample sample{};
  Trial trial;
  bool paused = false;  ///< no trial begins before the experimenter starts it
};

/// The display's process.  Target and cursor are computed in the receiving thread, one pair for
/// each sensed sample; the frames are drawn elsewhere from the newest pair and never delay it.
class Shell {
 public:
  explicit Shell(runtime::Service& service);

  /// Newest pair, for one drawing thread.
  const Shown& shown() noexcept { return shown_.load(); }
  /// Newest prompt, for the same thread.
  const stillhand_msgs::Prompt& prompt() noexcept { return prompt_.load(); }
  void answer(const Answering::Answer& answer);
  [[nodiscard]] runtime::Service& service() noexcept { return service_; }
  [[nodiscard]] const TrackingDisplay::Config& config() const noexcept { return config_; }
  /// A person at the screen asks for an emergency stop.
  void stop_at_once();

 private:
  struct Prepared {
    std::optional<signal::ReferenceSignal> reference;
    Trial trial;
  };
  void on_sensed(const stillhand_msgs::Sensed& sensed);
  void prepare(const Trial& trial, std::uint64_t reference_seed);

  runtime::Service& service_;
  TrackingDisplay::Config config_;
  TrackingDisplay core_;
  CommandInUse taken_off_;
  runtime::Handover<Prepared> handover_;
  const Prepared* armed_ = nullptr;
  bool paused_ = false;
  runtime::LatestValue<Shown> shown_;
  runtime::LatestValue<stillhand_msgs::Prompt> prompt_;
  runtime::Publisher<stillhand_msgs::TrackingSample> tracking_;
  runtime::Publisher<stillhand_msgs::Answer> answers_;
  runtime::EmergencyStop emergency_stop_;
};

}  // namespace stillhand::display
