// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/config_field.hpp"

namespace stillhand::dashboard {

/// From when on the dashboard warns, and from when on it calls it critical.
struct Config {
  double grace_s = 2.0;
  double deadline_ms = 2.0;
  double late_warning_ms = 1.0;
  double late_critical_ms = 3.5;
  double lost_warning_ticks = 1.0;
  double lost_critical_ticks = 10.0;
  double silent_warning_ms = 50.0;
  double silent_critical_ms = 300.0;
  double latency_warning_ms = 5.0;
  double latency_critical_ms = 20.0;
  double chain_warning_ms = 5.0;
  double chain_critical_ms = 10.0;
  double service_warning_ms = 300.0;
  double service_critical_ms = 2000.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("grace_s", self.grace_s, Range{0.0, 60.0},
          "[s] after a session or a topic begins, in which nothing is called late");
    visit("deadline_ms", self.deadline_ms, Range{1.0, 1000.0},
          "[ms] longest time between two samples of a 1 kHz topic; the period and the tolerance of "
          "each process's own supervision");
    visit("late_warning_ms", self.late_warning_ms, Range{0.0, 1000.0},
          "[ms] beyond the deadline, by the writer's stamps");
    visit("late_critical_ms", self.late_critical_ms, Range{0.0, 1000.0},
          "[ms] the same; with the deadline 5.5 ms, the DDS deadline of control_loop");
    visit("lost_warning_ticks", self.lost_warning_ticks, Range{1.0, 1e6},
          "[ticks] missing in a row");
    visit("lost_critical_ticks", self.lost_critical_ticks, Range{1.0, 1e6},
          "[ticks] the same; the age at which the rig takes no motor command any more");
    visit("silent_warning_ms", self.silent_warning_ms, Range{5.0, 60000.0},
          "[ms] without a sample of a 1 kHz topic while the session runs");
    visit("silent_critical_ms", self.silent_critical_ms, Range{5.0, 60000.0}, "[ms] the same");
    visit("latency_warning_ms", self.latency_warning_ms, Range{0.01, 1000.0},
          "[ms] p99 of one second from a writer to here");
    visit("latency_critical_ms", self.latency_critical_ms, Range{0.01, 1000.0},
          "[ms] the same; twice the age that the motor refuses");
    visit("chain_warning_ms", self.chain_warning_ms, Range{0.1, 1000.0},
          "[ms] longest time from acquisition to the motor in a tenth of a second");
    visit("chain_critical_ms", self.chain_critical_ms, Range{0.1, 1000.0},
          "[ms] the same; rig.yaml, motor.max_motor_age_ticks");
    visit("service_warning_ms", self.service_warning_ms, Range{100.0, 60000.0},
          "[ms] without a status of a process; the lease of its life sign");
    visit("service_critical_ms", self.service_critical_ms, Range{100.0, 60000.0},
          "[ms] the same; the participant's lease in qos/profiles.xml");
  }
};

}  // namespace stillhand::dashboard
