// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "services/bus/service.hpp"
#include "services/core/human_operator/crossover_operator.hpp"
#include "services/core/human_operator/pointer_operator.hpp"
#include "services/core/human_operator/subject_config.hpp"
#include "services/messages/human_operator/codec.hpp"

namespace stillhand::human_operator {

/// The process of the subject: one volitional force for each tracking sample, in the receiving
/// thread.
class Shell {
 public:
  /// @param with_pointer  a person's mouse replaces the simulated subject
  Shell(runtime::Service& service, bool with_pointer);
  void run() { service_.run(); }

 private:
  void on_tracking(const stillhand_msgs::TrackingSample& sample);
  /// a_y of this tick, or the newest if its sensed sample has not arrived.
  [[nodiscard]] double felt_m_s2(Tick tick) const noexcept;
  [[nodiscard]] PointerInput pointer_input(const OperatorInput& input) const;

  runtime::Service& service_;
  SubjectConfig config_;
  CrossoverOperator simulated_;
  PointerOperator person_;
  bool with_pointer_;
  stillhand_msgs::Pointer pointer_;
  /// a_y of the last ticks.
  struct Felt {
    Tick tick = -1;
    double a_y_m_s2 = 0.0;
  };
  static constexpr std::size_t kFelt_ticks = 64;
  std::array<Felt, kFelt_ticks> felt_{};
  double newest_felt_m_s2_ = 0.0;
  runtime::Publisher<stillhand_msgs::OperatorForce> force_;
};

}  // namespace stillhand::human_operator
