// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/repair/recorded_trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "apps/close_the_loop/recorded/replay.hpp"
#include "apps/close_the_loop/verdict/control_laws.hpp"
#include "apps/close_the_loop/verdict/control_model.hpp"
#include "apps/libraries/measurement/grid.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::close_the_loop {
namespace {

namespace control = diagnosis::control;
using diagnosis::Effect;
using diagnosis::Model;

template <typename Law>
bool is_body(const Effect& effect) {
  return std::holds_alternative<Law>(diagnosis::effect_kind(effect.kind).body_role(effect));
}

// Of what the hand feels in another trial of the session.
Model felt(Model model, const diagnosis::Signals& pegged) {
  std::erase_if(model.effects, [](const Effect& each) {
    return is_past(each) || is_body<control::NotFelt>(each);
  });
  for (Effect& effect : model.effects) effect = continued(effect, pegged);
  return model;
}

// Acts on the hand next to the body: a hand that stiffens does not change it.
bool is_next_to_body(const Effect& effect) {
  const auto role = diagnosis::effect_kind(effect.kind).body_role(effect);
  const auto* path = std::get_if<control::Path>(&role);
  return (path != nullptr && !path->through_body) || std::holds_alternative<control::Waves>(role) ||
         std::holds_alternative<control::Hysteresis>(role);
}

// w_0 f + w_1 f'/Omega, as the canceller follows it.
std::vector<double> followed_force(const std::vector<double>& f, double rate_hz,
                                   const cancellation::AdaptiveGain::Pair& weights) {
  constexpr double kOmega_rad_s = kTwoPi * 1.2;  // cancellation, Eq. CC-10
  std::vector<double> out;
  for (std::size_t n = 0; n < f.size(); ++n) {
    const std::size_t before = n > 0 ? n - 1 : n;
    const std::size_t after = std::min(n + 1, f.size() - 1);
    const double rate = (f[after] - f[before]) * rate_hz / static_cast<double>(after - before);
    out.push_back(weights[0] * f[n] + weights[1] * rate / kOmega_rad_s);
  }
  return out;
}

}  // namespace

bool is_past(const Effect& effect) {
  return diagnosis::effect_kind(effect.kind).time_only(effect) && !is_body<control::Gain>(effect) &&
         !is_body<control::Waves>(effect);
}

diagnosis::Stretch longest(const std::vector<diagnosis::Stretch>& stretches) {
  return *std::ranges::max_element(stretches, {},
                                   [](const auto& each) { return each.end - each.first; });
}

RecordedTrial recorded_trial(diagnosis::Measurement record, const Model& model) {
  const std::size_t factor = diagnosis::rate_factor(record, model.rate_hz);
  diagnosis::Signals signals(factor > 1 ? diagnosis::decimated(record, factor) : record,
                             model.inputs, model.output);
  return {std::move(record), std::move(signals)};
}

diagnosis::Measurement record_of(const TrialRun& run) { return measurement::on_grid(run.measured); }

std::vector<double> at_1_khz(const std::vector<double>& values, const RecordedTrial& trial) {
  return at_control_rate(values, longest(trial.signals.stretches()), trial.signals.rate_hz());
}

Course still_course(const diagnosis::Measurement& record) {
  const diagnosis::Stretch stretch = longest(record.stretches);
  Course out;
  out.first_tick = static_cast<Tick>(std::llround(stretch.start_s * kControlRateHz));
  out.sensed = sensed(record, stretch);
  const auto target = record.find("x_r")->values.begin();
  out.target_m.assign(target + static_cast<std::ptrdiff_t>(stretch.first),
                      target + static_cast<std::ptrdiff_t>(stretch.end));
  out.force_n.assign(out.target_m.size(), 0.0);
  return out;
}

Course course_of(const RecordedTrial& trial, const Model& body, const diagnosis::Signals& pegged,
                 const cancellation::AdaptiveGain::Pair& track) {
  Course out = still_course(trial.record);
  const Model all = felt(body, pegged);
  Model inner = all;
  std::erase_if(inner.effects, is_next_to_body);
  std::vector<double> force = diagnosis::free_run(all, trial.signals).prediction;
  std::vector<double> of_body = diagnosis::free_run(inner, trial.signals).prediction;
  for (double& each : of_body) each -= body.body.offset;
  const std::vector<double> stiffened = followed_force(of_body, trial.signals.rate_hz(), track);
  for (std::size_t n = 0; n < force.size(); ++n) {
    force[n] += stiffened[n] - of_body[n] - body.body.offset;
  }
  out.force_n = at_1_khz(force, trial);
  out.force_n.resize(std::min(out.force_n.size(), out.sensed.size()));
  return out;
}

}  // namespace stillhand::close_the_loop
