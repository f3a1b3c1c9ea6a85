// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/control_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "apps/close_the_loop/verdict/control_check.hpp"
#include "apps/close_the_loop/verdict/control_conversion.hpp"
#include "apps/close_the_loop/verdict/control_response.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/fitting/fit.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/population/population.hpp"

namespace stillhand::close_the_loop {
namespace {

using diagnosis::Effect;
using diagnosis::Model;

template <typename Law>
bool has_role(const Effect& effect) {
  return std::holds_alternative<Law>(diagnosis::effect_kind(effect.kind).body_role(effect));
}

// The denominator with the smallest error, or the first that is good; one that settles in time is
// preferred where its error is allowed.
ConvertedModel best_conversion(const Model& model, const diagnosis::Signals& signals,
                               const ControlOptions& options) {
  constexpr double kGood = 0.01;
  std::optional<ConvertedModel> best;
  bool best_settles = false;
  for (const std::vector<double>& denominator : possible_denominators(model)) {
    ConvertedModel next = converted(model, signals, denominator, options);
    const bool settles = cancellation::settle_ticks({kControlRateHz, denominator, denominator}) <=
                         cancellation::kMaxSettle_ticks;
    const bool allowed = settles && !best_settles && next.conversion_error <= options.max_error;
    const bool closer =
        settles == best_settles && best && next.conversion_error < best->conversion_error;
    if (!best || allowed || closer) {
      best = std::move(next);
      best_settles = settles;
    }
    if (best_settles && best->conversion_error < kGood) break;
  }
  return std::move(*best);
}

// What the hand does not feel, or time alone explains, the body never stood in for.
bool has_a_part_in_the_body(const Effect& effect) {
  return !has_role<diagnosis::control::NotFelt>(effect) &&
         !diagnosis::effect_kind(effect.kind).time_only(effect);
}

}  // namespace

Effect continued(const Effect& effect, const diagnosis::Signals& signals) {
  if (!has_role<diagnosis::control::Gain>(effect)) return effect;
  const double gain = gain_at_the_end(effect, signals);
  return {"regime_change",
          "step of the gain",
          {},
          {diagnosis::constant("time", "s", 0.0), diagnosis::constant("change", "-", gain - 1.0)},
          {}};
}

Model fitted_again(Model model, const diagnosis::Signals& signals) {
  const diagnosis::Blocks blocks = diagnosis::make_blocks(signals);
  const auto order = static_cast<int>(model.body.order());
  const diagnosis::Body linear = diagnosis::fit_baseline(signals, blocks, order).model.body;
  if (model.effects.empty()) {
    model.body = linear;
    return model;
  }
  Model best = model;
  double least = std::numeric_limits<double>::infinity();
  for (const diagnosis::Body& body : {model.body, linear}) {
    if (body.order() != model.body.order()) continue;  // effects have as many numbers
    Model other = model;
    other.body = body;
    for (Effect& each : other.effects) each.seen.clear();
    const double rmse = diagnosis::fit(other, signals, blocks).rmse;
    if (!(rmse < least)) continue;
    least = rmse;
    for (std::size_t e = 0; e < other.effects.size(); ++e) {
      other.effects[e].seen = model.effects[e].seen;
    }
    best = std::move(other);
  }
  return best;
}

namespace {

// Converts, compares, and converts again without what differs.
class Export {
 public:
  Export(const Model& model, const diagnosis::Signals& signals, const ControlOptions& options)
      : signals_(signals), options_(options), fitted_(model) {
    for (std::size_t e = 0; e < model.effects.size(); ++e) {
      const Effect& effect = model.effects[e];
      const std::string channel = effect.channels.empty() ? "" : effect.channels.front();
      treatments_.push_back({effect.kind, false, {}, channel});
      places_.push_back(e);
    }
  }

  ConvertedModel run() {
    for (;;) {
      carried_ = fitted_;
      for (Effect& effect : carried_.effects) effect = continued(effect, signals_);
      ConvertedModel next = best_conversion(carried_, signals_, options_);
      if (drop_left_alone(next) || drop_unsound_spring(next)) continue;
      if (!carried_.effects.empty() && drop_worst(next)) continue;
      if (!(next.conversion_error <= options_.max_error)) {
        throw ConfigError(
            "the model's response at 1 kHz",
            fmt::format("off by {:.2g} %", 100.0 * next.conversion_error),
            fmt::format("at most {:.2g} % from {:g} to {:g} Hz", 100.0 * options_.max_error,
                        options_.low_hz, options_.high_hz));
      }
      name_shares();
      next.treatments = std::move(treatments_);
      return next;
    }
  }

 private:
  void name_shares() {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (carried_.effects[i].is_whole()) continue;
      treatments_[places_[i]].how +=
          fmt::format(", at {:.0f} % of its size", 100.0 * carried_.effects[i].share);
    }
  }

  // @param which  of the carried effects, the last first
  void drop(const std::vector<std::size_t>& which) {
    bool again = false;
    for (const std::size_t i : which) {
      again = again || has_a_part_in_the_body(fitted_.effects[i]);
      fitted_.effects.erase(fitted_.effects.begin() + static_cast<std::ptrdiff_t>(i));
      places_.erase(places_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (again) fitted_ = fitted_again(std::move(fitted_), signals_);
  }

  void leave_alone(std::size_t i, std::string why) {
    treatments_[places_[i]].cancelled = false;
    treatments_[places_[i]].how = std::move(why);
    drop({i});
  }

  // What adds nothing to the canceller's model.
  bool drop_left_alone(const ConvertedModel& next) {
    std::vector<std::size_t> left_alone;
    for (std::size_t i = carried_.effects.size(); i-- > 0;) {
      Treatment& to = treatments_[places_[i]];
      to.cancelled = next.treatments[i].cancelled;
      to.how = next.treatments[i].how;
      if (to.cancelled && !has_role<diagnosis::control::NotFelt>(carried_.effects[i])) continue;
      left_alone.push_back(i);
    }
    drop(left_alone);
    return !left_alone.empty();
  }

  // A spring that the canceller's body cannot hold.
  bool drop_unsound_spring(const ConvertedModel& next) {
    constexpr double kAny = 1e12;  // its size is the canceller's own question
    const auto spring =
        std::ranges::find_if(carried_.effects, has_role<diagnosis::control::Spring>);
    if (spring == carried_.effects.end()) return false;
    const auto refusal = cancellation::check_model(next.model, {kAny, kAny}).refusal;
    const auto i = static_cast<std::size_t>(spring - carried_.effects.begin());
    if (refusal != cancellation::Refusal::kNone) {
      leave_alone(i, "the canceller does not run it: " + std::string(describe(refusal)));
      return true;
    }
    if (next.conversion_error <= options_.max_error) return false;
    leave_alone(i, fmt::format("with it the response at 1 kHz is off by {:.2g} %",
                               100.0 * next.conversion_error));
    return true;
  }

  // One that differs changes what the others are compared with: the worst goes first.
  bool drop_worst(const ConvertedModel& next) {
    const std::vector<EffectDifference> differences =
        effect_differences(carried_, signals_, next.model.denominator, options_);
    for (std::size_t i = 0; i < differences.size(); ++i) {
      treatments_[places_[i]].difference = differences[i];
    }
    const auto worst = std::ranges::max_element(differences, {}, &EffectDifference::worst);
    if (worst->worst() <= options_.max_difference) return false;
    leave_alone(
        static_cast<std::size_t>(worst - differences.begin()),
        fmt::format("in the canceller its force differs by {:.2g} % from that of the diagnosed "
                    "model, and {:.2g} % are allowed",
                    100.0 * worst->worst(), 100.0 * options_.max_difference));
    return true;
  }

  const diagnosis::Signals& signals_;
  const ControlOptions& options_;
  Model fitted_;                     ///< to the recording
  Model carried_;                    ///< as the session continues it
  std::vector<std::size_t> places_;  ///< of the carried effects among all
  std::vector<Treatment> treatments_;
};

}  // namespace

cancellation::HandCompliance average_hand() {
  const human_operator::ArmFeel feel = population::mean_subject({}).who.arm;
  return {feel.effective_mass_kg, feel.effective_damping_n_s_m, feel.effective_stiffness_n_m,
          rig::StickConfig{}.lever_m};
}

ConvertedModel to_control_model(const Model& model, const diagnosis::Signals& signals,
                                const ControlOptions& options) {
  return Export(model, signals, options).run();
}

ConvertedModel to_control_model(const diagnosis::CarriedModel& carried,
                                const diagnosis::Signals& signals, const ControlOptions& options) {
  ConvertedModel control = to_control_model(carried.in_session, signals, options);
  for (const diagnosis::LeftOut& left : carried.left_out) {
    const bool in_session = std::ranges::any_of(
        carried.in_session.effects,
        [&](const Effect& effect) { return diagnosis::is_same(effect, left.effect); });
    if (in_session) continue;
    const auto& channels = left.effect.channels;
    control.treatments.push_back({left.effect.kind, false, "not carried: " + left.why,
                                  channels.empty() ? "" : channels.front()});
  }
  return control;
}

}  // namespace stillhand::close_the_loop
