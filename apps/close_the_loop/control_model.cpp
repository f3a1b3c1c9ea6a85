// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/control_model.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "apps/close_the_loop/control_laws.hpp"
#include "apps/close_the_loop/control_response.hpp"
#include "services/contract/config_error.hpp"
#include "services/contract/tick.hpp"
#include "services/contract/units.hpp"
#include "services/diagnosis/core/model/effect_kind.hpp"
#include "services/diagnosis/core/model/evaluation.hpp"
#include "services/diagnosis/core/model/loop.hpp"
#include "services/diagnosis/core/model/model_run.hpp"
#include "services/population/population.hpp"

namespace stillhand::close_the_loop {
namespace {

namespace control = diagnosis::control;
using diagnosis::Effect;

// One try at carrying a model over, with one denominator.
class Conversion {
 public:
  Conversion(const diagnosis::Model& model, const diagnosis::Signals& signals,
             const ControlOptions& options)
      : model_(model), signals_(signals), options_(options) {}

  ConvertedModel run(const std::vector<double>& denominator);

 private:
  void convert_inputs();
  // What becomes of an effect, one function a law.
  void carry(const Effect& effect, const control::LeftOut& law);
  void carry(const Effect& effect, const control::NotFelt& law);
  void carry(const Effect& effect, const control::InputDelay& law);
  void carry(const Effect& effect, const control::InputMap& law);
  void carry(const Effect& effect, const control::OutputMap& law);
  void carry(const Effect& effect, const control::Spring& law);
  void carry(const Effect& effect, const control::Gain& law);
  void carry(const Effect& effect, const control::Mode& law);
  void carry(const Effect& effect, const control::Path& law);
  void carry(const Effect& effect, const control::Waves& law);
  void carry(const Effect& effect, const control::Friction& law);
  // Of the effect's first channel; where the canceller does not receive it, the effect is left out.
  std::optional<cancellation::Channel> received_channel(const Effect& effect);
  void treat(const Effect& effect, bool cancelled, std::string how) {
    out_.treatments.push_back({effect.kind, cancelled, std::move(how)});
  }
  [[nodiscard]] double turn(double frequency_hz) const {
    return kTwoPi * frequency_hz / model_.rate_hz;
  }
  std::vector<double> numerator(const Response& wanted, bool late);
  // A polynomial over the body's own poles.
  [[nodiscard]] Response over_poles(std::vector<double> c) const;
  [[nodiscard]] double last_gain() const;

  const diagnosis::Model& model_;
  const diagnosis::Signals& signals_;
  const ControlOptions& options_;
  double gain_ = last_gain();  ///< of the body alone: modes and paths lie next to it
  ConvertedModel out_;
};

std::vector<double> Conversion::numerator(const Response& wanted, bool late) {
  NumeratorFit fit = fit_numerator(out_.model.denominator, wanted, late, options_);
  out_.conversion_error = std::max(out_.conversion_error, fit.error);
  return std::move(fit.numerator);
}

Response Conversion::over_poles(std::vector<double> c) const {
  return [this, c = std::move(c)](double f) {
    return polynomial_at(c, turn(f)) / polynomial_at(model_.body.denominator, turn(f));
  };
}

// Of the record's last tenth, relative to the mean: where the hand is when the recording ends.
double Conversion::last_gain() const {
  std::vector<double> gain(signals_.size(), 1.0);
  for (const Effect& effect : model_.effects) {
    if (diagnosis::acts_at(effect, diagnosis::Stage::kGain)) {
      diagnosis::effect_kind(effect.kind).gain(effect, signals_, gain);
    }
  }
  const std::size_t from = gain.size() - gain.size() / 10 - 1;
  double sum = 0.0;
  for (std::size_t n = from; n < gain.size(); ++n) sum += gain[n];
  return sum / static_cast<double>(gain.size() - from);
}

void Conversion::convert_inputs() {
  const double late_s = input_delay_s(model_) - options_.lead_s;
  for (std::size_t k = 0; k < model_.inputs.size(); ++k) {
    const auto channel = channel_of(model_.inputs[k]);
    if (!channel) {
      throw ConfigError("the model's input", model_.inputs[k],
                        "a channel that the canceller receives");
    }
    const auto wanted = [&](double f) {
      return linear_response(model_, k, gain_, f) * std::polar(1.0, -kTwoPi * f * late_s);
    };
    out_.model.inputs.push_back({*channel, {}, numerator(wanted, false)});
  }
}

std::optional<cancellation::Channel> Conversion::received_channel(const Effect& effect) {
  const auto channel = channel_of(effect.channels.front());
  if (!channel) treat(effect, false, "the canceller does not receive " + effect.channels.front());
  return channel;
}

void Conversion::carry(const Effect& effect, const control::LeftOut& law) {
  treat(effect, false, law.reason);
}

void Conversion::carry(const Effect& effect, const control::NotFelt& law) {
  treat(effect, true, law.reason);
}

void Conversion::carry(const Effect& effect, const control::InputDelay& /*law*/) {
  treat(effect, true, "the prediction comes as much later");
}

void Conversion::carry(const Effect& effect, const control::InputMap& /*law*/) {
  const diagnosis::EffectKind& kind = diagnosis::effect_kind(effect.kind);
  for (cancellation::InputPath& input : out_.model.inputs) {
    const auto& facts = cancellation::kChannelFacts[static_cast<std::size_t>(input.channel)];
    if (effect.channels.at(0) != facts.name) continue;
    const double scale = 1.5 * facts.full_scale;
    input.map = table(-scale, scale, [&](double u) { return kind.mapped(effect, u); });
  }
  treat(effect, true, "the map runs before the canceller's body");
}

void Conversion::carry(const Effect& effect, const control::OutputMap& /*law*/) {
  const diagnosis::EffectKind& kind = diagnosis::effect_kind(effect.kind);
  const double range = 2.0 * (signals_.output().deviation * 4.0);
  out_.model.output = table(-range, range, [&](double y) { return kind.mapped(effect, y); });
  treat(effect, true, "the map runs behind the canceller's body");
}

void Conversion::carry(const Effect& effect, const control::Spring& /*law*/) {
  if (out_.model.loop) {
    treat(effect, false, "the canceller runs one spring inside the body, and this is a second");
    return;
  }
  const diagnosis::LoopPath path = diagnosis::loop_path(effect, model_.body.order());
  diagnosis::ModelRun run;
  diagnosis::run_all(model_, signals_, run);
  double range = 0.0;
  for (const double z : run.free.argument) range = std::max(range, std::abs(z));
  // Where z is the force itself, it is the one behind the gain.
  const double z_gain = path.of_output() ? gain_ : 1.0;
  range *= 2.0 * std::abs(z_gain);
  const diagnosis::Nonlinearity shape = diagnosis::effect_kind(effect.kind).feedback(effect);
  cancellation::LoopPath loop;
  loop.e = numerator(over_poles(path.e), path.of_output());
  for (double& e : loop.e) e *= gain_;
  if (!path.of_output()) {
    loop.n = numerator(over_poles(path.n), false);
    loop.m = numerator(over_poles(path.m), true);
  }
  loop.phi = table(-range, range, [&](double z) {
    diagnosis::LoopMemory memory;
    return shape.phi(z / (z_gain * shape.threshold), memory);
  });
  out_.model.loop = std::move(loop);
  treat(effect, true, "the spring runs inside the canceller's body");
}

void Conversion::carry(const Effect& effect, const control::Gain& /*law*/) {
  treat(effect, true, "the canceller starts with the gain at the end of the recording and adapts");
}

void Conversion::carry(const Effect& effect, const control::Mode& /*law*/) {
  treat(effect, true, "the canceller's body has two more poles");
}

void Conversion::carry(const Effect& effect, const control::Path& law) {
  const auto channel = received_channel(effect);
  if (!channel) return;
  if (law.through_body) {
    const Response wanted = over_poles(diagnosis::difference_basis(effect.coefficients));
    out_.model.inputs.push_back({*channel, {}, numerator(wanted, false)});
  } else {
    out_.model.paths.push_back({*channel, law.lag_s, {}, effect.coefficients.at(0)});
  }
  treat(effect, true, "a path from " + effect.channels.front() + " next to that of a_y");
}

void Conversion::carry(const Effect& effect, const control::Waves& law) {
  if (effect.channels.empty()) {
    add_waves(effect, std::nullopt, law.frequency, 1.0, out_.model);
    treat(effect, true, "the sample clock carries the tone's phase on");
  } else if (const auto channel = received_channel(effect)) {
    add_waves(effect, channel, law.frequency, 1.0, out_.model);
    treat(effect, true, "the motor opposes the ripple at each value of " + effect.channels.front());
  }
}

void Conversion::carry(const Effect& effect, const control::Friction& law) {
  if (const auto channel = received_channel(effect)) {
    out_.model.paths.push_back(friction_path(*channel, law.transition, effect.coefficients.at(0)));
    treat(effect, true, "the motor opposes the sign of " + effect.channels.front());
  }
}

ConvertedModel Conversion::run(const std::vector<double>& denominator) {
  out_.model.rate_hz = kControlRateHz;
  out_.model.denominator = denominator;
  convert_inputs();
  for (const Effect& effect : model_.effects) {
    std::visit([&](const auto& law) { carry(effect, law); },
               diagnosis::effect_kind(effect.kind).body_role(effect));
  }
  return std::move(out_);
}

}  // namespace

cancellation::HandCompliance average_hand() {
  const human_operator::ArmFeel feel = population::mean_subject({}).who.arm;
  return {feel.effective_mass_kg, feel.effective_damping_n_s_m, feel.effective_stiffness_n_m,
          rig::StickConfig{}.lever_m};
}

ConvertedModel to_control_model(const diagnosis::Model& model, const diagnosis::Signals& signals,
                                const ControlOptions& options) {
  constexpr double kGood = 0.01;
  std::optional<ConvertedModel> best;
  for (const std::vector<double>& denominator : possible_denominators(model)) {
    ConvertedModel next = Conversion(model, signals, options).run(denominator);
    if (!best || next.conversion_error < best->conversion_error) best = std::move(next);
    if (best->conversion_error < kGood) break;
  }
  if (!(best->conversion_error <= options.max_error)) {
    throw ConfigError("the model's response at 1 kHz",
                      "off by " + std::to_string(100.0 * best->conversion_error) + " %",
                      "at most " + std::to_string(100.0 * options.max_error) + " % in the band");
  }
  return std::move(*best);
}

}  // namespace stillhand::close_the_loop
