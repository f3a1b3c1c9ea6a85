// SPDX-License-Identifier: Apache-2.0
#include "services/processes/human_operator/shell.hpp"

namespace stillhand::human_operator {
namespace {

// The display sends both pointer and tracking samples. If tracking continues and the pointer gets
// no new tick for this time, the window is closed.
constexpr Tick kPointerLost_ticks = 2000;

SubjectConfig seeded(SubjectConfig config, std::uint64_t seed) {
  constexpr std::uint64_t kSeedMask = 0xffffffffu;  // CrossoverConfig::seed is a 32-bit number
  config.crossover.seed = static_cast<std::int64_t>(seed & kSeedMask);
  return config;
}

}  // namespace

Shell::Shell(runtime::Service& service, bool with_pointer)
    : service_(service),
      config_(seeded(service.config<SubjectConfig>(), service.options().seed)),
      simulated_(config_.crossover),
      person_(config_.pointer),
      with_pointer_(with_pointer),
      force_(service.bus().publisher<stillhand_msgs::OperatorForce>(topics::kOperatorForce)) {
  pointer_.tick(-1);
  service.on_trial([this](const Trial& trial, const auto&) {
    simulated_.arm(trial);
    person_.arm(trial);
    service_.note_armed(trial.number);
  });
  service.bus().subscribe<stillhand_msgs::Pointer>(
      topics::kPointer, [this](const auto& message, const auto&) { pointer_ = message; });
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) {
        if (message.tick() < 0) return;
        newest_felt_m_s2_ = message.accel_y_m_s2();
        felt_[static_cast<std::size_t>(message.tick()) % kFelt_ticks] = {message.tick(),
                                                                         message.accel_y_m_s2()};
      });
  service.bus().subscribe<stillhand_msgs::TrackingSample>(
      topics::kTrackingSample, [this](const auto& message, const auto&) { on_tracking(message); });
}

double Shell::felt_m_s2(Tick tick) const noexcept {
  if (tick < 0) return 0.0;
  const Felt& felt = felt_[static_cast<std::size_t>(tick) % kFelt_ticks];
  return felt.tick == tick ? felt.a_y_m_s2 : newest_felt_m_s2_;
}

PointerInput Shell::pointer_input(const OperatorInput& input) const {
  const bool known = pointer_.tick() >= 0;
  const Tick age = known ? input.tick - pointer_.tick() : 0;
  return {input.tick, known ? pointer_.position_m() : std::numeric_limits<double>::quiet_NaN(), age,
          known && age < kPointerLost_ticks, input.active};
}

void Shell::on_tracking(const stillhand_msgs::TrackingSample& sample) {
  const Trial& trial = service_.trial();
  const bool active = trial.phase == TrialPhase::kTracking && trial.covers(sample.tick());
  const OperatorInput input = from_idl(sample, active, felt_m_s2(sample.tick()));
  const OperatorOutput output =
      with_pointer_ ? person_.step(pointer_input(input)) : simulated_.step(input);
  auto message = to_idl(output, input, trial.number);
  force_.write(message);
  service_.note_tick(sample.tick());
}

}  // namespace stillhand::human_operator
