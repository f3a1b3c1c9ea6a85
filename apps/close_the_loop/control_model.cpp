// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/control_model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <optional>

#include "services/cancellation/core/command_filter.hpp"
#include "services/contract/config_error.hpp"
#include "services/contract/tick.hpp"
#include "services/diagnosis/core/fitting/modes.hpp"
#include "services/diagnosis/core/model/effect_kind.hpp"
#include "services/diagnosis/core/model/evaluation.hpp"
#include "services/diagnosis/core/model/loop.hpp"
#include "services/diagnosis/core/model/model_run.hpp"
#include "services/identification/core/polynomial.hpp"
#include "services/identification/core/rate_conversion.hpp"
#include "services/signal/decompositions.hpp"

namespace stillhand::close_the_loop {
namespace {

using cancellation::Channel;
using cancellation::ControlModel;
using diagnosis::Effect;
using diagnosis::Stage;
using Complex = std::complex<double>;
using Response = std::function<Complex(double frequency_hz)>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr Eigen::Index kPoints = 241;  // of a response, each with a real and an imaginary part
constexpr double kOuterWeight = 0.2;
constexpr std::size_t kTableValues = 129;

std::optional<Channel> channel_of(std::string_view name) {
  for (std::size_t i = 0; i < cancellation::kChannels; ++i) {
    if (cancellation::kChannelFacts[i].name == name) return static_cast<Channel>(i);
  }
  return std::nullopt;
}

// sum c_i exp(-j w i)
Complex polynomial_at(const std::vector<double>& c, double turn_rad) {
  Complex sum = 0.0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * std::polar(1.0, -turn_rad) + c[i];
  return sum;
}

cancellation::ValueMap table(double low, double high, const std::function<double(double)>& map) {
  cancellation::ValueMap out{low, high, {}};
  for (std::size_t i = 0; i < kTableValues; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(kTableValues - 1);
    out.values.push_back(map(low + share * (high - low)));
  }
  return out;
}

// tanh of the rate, steep enough for the motion and not for the encoder's steps.
cancellation::DirectPath friction_path(const Effect& effect, Channel channel, double gain) {
  constexpr double kLeastTransition = 0.05;  // [rad/s] 4096 counts and 100 Hz: 0.15 rad/s a count
  const double transition =
      effect.parameters.empty() ? kLeastTransition : std::max(effect.value(0), kLeastTransition);
  const double wide = 8.0 * transition;
  return {channel, 0.0, table(-wide, wide, [&](double v) { return std::tanh(v / transition); }),
          gain};
}

void add_waves(const Effect& effect, std::optional<Channel> channel, double sign,
               ControlModel& model) {
  for (std::size_t h = 0; 2 * h + 1 < effect.coefficients.size(); ++h) {
    model.waves.push_back({channel, static_cast<double>(h + 1) * effect.value(0),
                           sign * effect.coefficients[2 * h],
                           sign * effect.coefficients[2 * h + 1]});
  }
}

class Conversion {
 public:
  Conversion(const diagnosis::Model& model, const diagnosis::Signals& signals,
             const ControlOptions& options)
      : model_(model), signals_(signals), options_(options) {}

  ConvertedModel run(const std::vector<double>& denominator);

 private:
  void convert_inputs();
  void convert_loop(const Effect& effect);
  void convert_map(const Effect& effect);
  void convert_term(const Effect& effect);
  void coupled(const Effect& effect);
  void treat(const Effect& effect, bool cancelled, std::string how) {
    out_.treatments.push_back({effect.kind, cancelled, std::move(how)});
  }
  [[nodiscard]] double turn(double frequency_hz) const {
    return kTwoPi * frequency_hz / model_.rate_hz;
  }
  std::vector<double> numerator(const Response& wanted, bool late, double scale);
  [[nodiscard]] double last_gain() const;
  [[nodiscard]] double delay_s() const;
  [[nodiscard]] Complex body_response(std::size_t k, double frequency_hz) const;

  const diagnosis::Model& model_;
  const diagnosis::Signals& signals_;
  const ControlOptions& options_;
  double gain_ = last_gain();  ///< of the body alone: modes and paths lie beside it
  ConvertedModel out_;
};

// Eq. CL-1: z' = z^(rate/1000 Hz).
std::vector<double> carried_poles(const std::vector<double>& denominator, double rate_hz) {
  const double share = rate_hz / kControlRateHz;
  const std::vector<double> reversed(denominator.rbegin(), denominator.rend());
  std::vector<Complex> poles = identification::roots(reversed);
  for (Complex& z : poles) {
    constexpr double kLeast = 1e-3;
    const bool turns = std::abs(z.imag()) > 1e-12;
    z = std::polar(std::pow(std::max(std::abs(z), kLeast), share),
                   turns ? std::arg(z) * share : 0.0);
  }
  const identification::Polynomial ascending = identification::from_roots(poles);
  return {ascending.rbegin(), ascending.rend()};
}

// The modes beside the body.
std::vector<std::vector<double>> modes_of(const diagnosis::Model& model) {
  std::vector<std::vector<double>> modes;
  for (const Effect& effect : model.effects) {
    if (effect.kind != "resonance") continue;
    modes.push_back(diagnosis::mode_denominator(effect.value(0), effect.value(1), model.rate_hz));
  }
  return modes;
}

// Body and modes as one difference model, from the first input.
identification::DifferenceModel all_of(const diagnosis::Model& model) {
  using diagnosis::product;
  std::vector<double> numerator = model.body.numerators.front();
  std::vector<double> denominator = model.body.denominator;
  for (const Effect& effect : model.effects) {
    if (effect.kind != "resonance") continue;
    // c_0 (1 - q^-1) + c_1 over the mode.
    const std::vector<double> mode =
        diagnosis::mode_denominator(effect.value(0), effect.value(1), model.rate_hz);
    const double c0 = effect.coefficients.at(0);
    const std::vector<double> of_mode = product({c0 + effect.coefficients.at(1), -c0}, denominator);
    numerator = product(numerator, mode);
    denominator = product(denominator, mode);
    for (std::size_t i = 0; i < of_mode.size(); ++i) numerator[i] += of_mode[i];
  }
  return {model.rate_hz, numerator, denominator};
}

// Eq. CL-1, and where a pole has no like at the new rate (a real one left of 0 turns by half the
// old rate): those of a fit to the response of the body, or of body and modes together
// (identification ID-9).
std::vector<std::vector<double>> possible_denominators(const diagnosis::Model& model) {
  const auto with_modes = [&](std::vector<double> denominator) {
    for (const std::vector<double>& mode : modes_of(model)) {
      denominator = diagnosis::product(denominator, carried_poles(mode, model.rate_hz));
    }
    return denominator;
  };
  std::vector<std::vector<double>> all{
      with_modes(carried_poles(model.body.denominator, model.rate_hz))};
  const auto add_fitted = [&](const identification::DifferenceModel& to_fit, const auto& extended) {
    try {
      all.push_back(extended(identification::to_control_rate(to_fit).model.denominator));
    } catch (const ConfigError&) {  // no fit: one possibility less
    }
  };
  add_fitted({model.rate_hz, model.body.numerators.front(), model.body.denominator}, with_modes);
  add_fitted(all_of(model), [](std::vector<double> denominator) { return denominator; });
  return all;
}

// Eq. CL-2: c in sum c_i D^i / A' nearest to the wanted response.
std::vector<double> Conversion::numerator(const Response& wanted, bool late, double scale) {
  const std::size_t order = out_.model.denominator.size() - 1;
  const auto columns = static_cast<Eigen::Index>(late ? order : order + 1);
  Eigen::MatrixXd matrix(2 * kPoints, columns);
  Eigen::VectorXd right(2 * kPoints);
  std::vector<Complex> target(kPoints);
  const auto frequency = [&](Eigen::Index row) {
    return options_.upper_hz * static_cast<double>(row) / (kPoints - 1.0);
  };
  const auto in_band = [&](Eigen::Index row) {
    return frequency(row) >= options_.low_hz && frequency(row) <= options_.high_hz;
  };
  for (Eigen::Index row = 0; row < kPoints; ++row) {
    const double weight = in_band(row) ? 1.0 : kOuterWeight;
    const double w = kTwoPi * frequency(row) / kControlRateHz;
    const Complex delay = std::polar(1.0, -w);
    Complex column = weight / polynomial_at(out_.model.denominator, w) * (late ? delay : 1.0);
    for (Eigen::Index i = 0; i < columns; ++i) {
      matrix(2 * row, i) = column.real();
      matrix(2 * row + 1, i) = column.imag();
      column *= 1.0 - delay;
    }
    target[static_cast<std::size_t>(row)] = wanted(frequency(row));
    right[2 * row] = weight * target[static_cast<std::size_t>(row)].real();
    right[2 * row + 1] = weight * target[static_cast<std::size_t>(row)].imag();
  }
  const Eigen::RowVectorXd norms = matrix.colwise().norm();
  matrix.array().rowwise() /= norms.array();
  const Eigen::VectorXd x = signal::least_squares(matrix, right);
  std::vector<double> differences(static_cast<std::size_t>(columns));
  for (Eigen::Index i = 0; i < columns; ++i) {
    differences[static_cast<std::size_t>(i)] = x[i] / norms[i];
  }
  std::vector<double> powers = diagnosis::difference_basis(differences);
  if (late) powers.insert(powers.begin(), 0.0);
  double largest = scale;
  double error = 0.0;
  for (Eigen::Index row = 0; row < kPoints; ++row) {
    if (!in_band(row)) continue;
    const double w = kTwoPi * frequency(row) / kControlRateHz;
    const Complex got = polynomial_at(powers, w) / polynomial_at(out_.model.denominator, w);
    error = std::max(error, std::abs(got - target[static_cast<std::size_t>(row)]));
    largest = std::max(largest, std::abs(target[static_cast<std::size_t>(row)]));
  }
  if (largest > 0.0) out_.conversion_error = std::max(out_.conversion_error, error / largest);
  return powers;
}

// Of the record's last tenth, relative to the mean: where the hand is when the recording ends.
double Conversion::last_gain() const {
  std::vector<double> gain(signals_.size(), 1.0);
  for (const Effect& effect : model_.effects) {
    if (diagnosis::acts_at(effect, Stage::kGain)) {
      diagnosis::effect_kind(effect.kind).gain(effect, signals_, gain);
    }
  }
  const std::size_t from = gain.size() - gain.size() / 10 - 1;
  double sum = 0.0;
  for (std::size_t n = from; n < gain.size(); ++n) sum += gain[n];
  return sum / static_cast<double>(gain.size() - from);
}

Complex Conversion::body_response(std::size_t k, double frequency_hz) const {
  const double w = turn(frequency_hz);
  Complex sum = gain_ * polynomial_at(model_.body.numerators[k], w) /
                polynomial_at(model_.body.denominator, w);
  for (const Effect& effect : model_.effects) {
    if (effect.kind == "resonance") {
      const Complex mode = polynomial_at(
          diagnosis::mode_denominator(effect.value(0), effect.value(1), model_.rate_hz), w);
      const Complex difference = 1.0 - std::polar(1.0, -w);
      sum +=
          (effect.coefficients.at(2 * k) * difference + effect.coefficients.at(2 * k + 1)) / mode;
    }
  }
  return sum;
}

// Of the input's way to the body.
double Conversion::delay_s() const {
  for (const Effect& effect : model_.effects) {
    if (effect.kind == "delay") return effect.value(0);
  }
  return 0.0;
}

void Conversion::convert_inputs() {
  const double late_s = delay_s() - options_.lead_s;
  for (std::size_t k = 0; k < model_.inputs.size(); ++k) {
    const auto channel = channel_of(model_.inputs[k]);
    if (!channel) {
      throw ConfigError("the model's input", model_.inputs[k],
                        "a channel that the canceller is given");
    }
    out_.model.inputs.push_back(
        {*channel,
         {},
         numerator(
             [&](double f) { return body_response(k, f) * std::polar(1.0, -kTwoPi * f * late_s); },
             false, 0.0)});
  }
}

void Conversion::convert_loop(const Effect& effect) {
  if (out_.model.loop) {
    treat(effect, false, "a second spring inside the body: the canceller runs one");
    return;
  }
  const std::size_t order = model_.body.order();
  const diagnosis::LoopPath path = diagnosis::loop_path(effect, order);
  const auto over_poles = [&](const std::vector<double>& c) {
    return [this, c](double f) {
      return polynomial_at(c, turn(f)) / polynomial_at(model_.body.denominator, turn(f));
    };
  };
  diagnosis::ModelRun run;
  diagnosis::run_all(model_, signals_, run);
  double range = 0.0;
  for (const double z : run.free.argument) range = std::max(range, std::abs(z));
  // Where z is the force itself, it is the one behind the gain.
  const double z_gain = path.of_output() ? gain_ : 1.0;
  range *= 2.0 * std::abs(z_gain);
  const diagnosis::Nonlinearity shape = diagnosis::effect_kind(effect.kind).feedback(effect);
  cancellation::LoopPath loop;
  // phi has the size of its own slope times z: judged by what the linear part does.
  loop.e = numerator(over_poles(path.e), path.of_output(), 0.0);
  for (double& e : loop.e) e *= gain_;
  if (!path.of_output()) {
    loop.n = numerator(over_poles(path.n), false, 0.0);
    loop.m = numerator(over_poles(path.m), true, 0.0);
  }
  loop.phi = table(-range, range, [&](double z) {
    diagnosis::LoopMemory memory;
    return shape.phi(z / (z_gain * shape.threshold), memory);
  });
  out_.model.loop = std::move(loop);
  treat(effect, true, "the spring runs inside the canceller's body");
}

void Conversion::convert_map(const Effect& effect) {
  const diagnosis::EffectKind& kind = diagnosis::effect_kind(effect.kind);
  if (kind.stage(effect) == Stage::kOutputValue) {
    const double range = 2.0 * (signals_.output().deviation * 4.0);
    if (effect.kind == "output_saturation") {
      treat(effect, true,
            "a limit of the force's sensor isn't felt by the hand: the motor answers the force "
            "beyond it");
      return;
    }
    out_.model.output = table(-range, range, [&](double y) { return kind.mapped(effect, y); });
    treat(effect, true, "the map runs behind the canceller's body");
    return;
  }
  for (cancellation::InputPath& input : out_.model.inputs) {
    const auto name = cancellation::kChannelFacts[static_cast<std::size_t>(input.channel)].name;
    if (effect.channels.at(0) != name) continue;
    const double scale =
        1.5 * cancellation::kChannelFacts[static_cast<std::size_t>(input.channel)].full_scale;
    input.map = table(-scale, scale, [&](double u) { return kind.mapped(effect, u); });
  }
  treat(effect, true, "the map runs before the canceller's body");
}

void Conversion::coupled(const Effect& effect) {
  const auto channel = channel_of(effect.channels.front());
  if (!channel) {
    treat(effect, false, "the canceller isn't given " + effect.channels.front());
    return;
  }
  if (effect.form == "through the body") {
    const std::vector<double> c = diagnosis::difference_basis(effect.coefficients);
    const auto response = [&](double f) {
      return polynomial_at(c, turn(f)) / polynomial_at(model_.body.denominator, turn(f));
    };
    out_.model.inputs.push_back({*channel, {}, numerator(response, false, 0.0)});
  } else {
    const double lag_s = effect.form == "lagged" ? effect.value(0) : 0.0;
    out_.model.paths.push_back({*channel, lag_s, {}, effect.coefficients.at(0)});
  }
  treat(effect, true, "a path from " + effect.channels.front() + " beside a_y's");
}

void Conversion::convert_term(const Effect& effect) {
  if (effect.kind == "coupled_input") return coupled(effect);
  if (effect.kind == "resonance") {
    return treat(effect, true, "two poles more in the canceller's body");
  }
  if (effect.kind == "tone") {
    add_waves(effect, std::nullopt, 1.0, out_.model);
    return treat(effect, true, "the tone's phase is carried on by the sample clock");
  }
  if (effect.kind == "drift") {
    return treat(effect, false, "a slow offset of the force's sensor, or a hand that leans");
  }
  treat(effect, false, "no law of the canceller has this form: left alone");
}

ConvertedModel Conversion::run(const std::vector<double>& denominator) {
  out_.model.rate_hz = kControlRateHz;
  out_.model.denominator = denominator;
  convert_inputs();
  for (const Effect& effect : model_.effects) {
    switch (diagnosis::effect_kind(effect.kind).stage(effect)) {
      case Stage::kInputTime:
        treat(effect, effect.kind == "delay",
              effect.kind == "delay" ? "the prediction is late by as much"
                                     : "clocks that run apart: one clock drives the canceller");
        break;
      case Stage::kInputValue:
      case Stage::kOutputValue:
        convert_map(effect);
        break;
      case Stage::kFeedback:
        convert_loop(effect);
        break;
      case Stage::kGain:
        treat(effect, true, "the gain at the end of the recording, followed from there on");
        break;
      case Stage::kTerm:
        convert_term(effect);
        break;
      case Stage::kWeight:
        treat(effect, false, "bursts come when they like");
        break;
    }
  }
  return std::move(out_);
}

}  // namespace

cancellation::HandCompliance average_hand() {
  const cancellation::CommandFilterConfig average;
  return {average.mass_kg, average.damping_n_s_m, average.stiffness_n_m, average.lever_m};
}

void add_drive_effect(const Effect& effect, double share, ConvertedModel& to) {
  const auto channel = channel_of(effect.channels.empty() ? "" : effect.channels.front());
  if (effect.kind == "coulomb_friction" && channel == Channel::kOmega) {
    // The motor's force is minus the model's: it pushes with the motion.
    to.model.paths.push_back(friction_path(effect, *channel, -share * effect.coefficients.at(0)));
    to.treatments.push_back({effect.kind, true, "the motor pushes with the motion"});
  } else if (effect.kind == "position_ripple" && channel == Channel::kTheta) {
    add_waves(effect, channel, -1.0, to.model);
    to.treatments.push_back({effect.kind, true, "the motor answers the ripple at each position"});
  } else {
    to.treatments.push_back(
        {effect.kind, false, "no law of the canceller for the drive: left alone"});
  }
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
