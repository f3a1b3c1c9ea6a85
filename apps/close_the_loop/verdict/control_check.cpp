// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/control_check.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

#include "apps/close_the_loop/verdict/control_conversion.hpp"
#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/interpolation.hpp"
#include "services/core/diagnosis/model/other_phases.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::close_the_loop {
namespace {

using cancellation::ControlModel;
using cancellation::ControlModelFilter;
using diagnosis::Model;
using diagnosis::Signals;
using diagnosis::Stretch;

constexpr std::uint64_t kSeed = 7;
constexpr double kLouder = 1.25;
// Of the whole force: an effect without any on this motion cannot differ by a share of itself.
constexpr double kNoForce = 1e-6;

// The channels that the canceller receives and the signals have.
struct Sensed {
  std::size_t channel;
  const std::vector<double>* values;
};

std::vector<Sensed> sensed_in(const Signals& signals) {
  std::vector<Sensed> out;
  for (std::size_t c = 0; c < cancellation::kChannels; ++c) {
    const auto found = std::ranges::find(signals.all(), cancellation::kChannelFacts[c].name,
                                         &diagnosis::Signal::name);
    if (found != signals.all().end()) out.push_back({c, &found->values});
  }
  return out;
}

// Steps filters through one stretch, and reads their forces at its samples.
class StretchReplay {
 public:
  StretchReplay(const Signals& signals, const std::vector<Sensed>& sensed, const Stretch& stretch)
      : signals_(signals), sensed_(sensed), stretch_(stretch) {}

  void run(std::span<ControlModelFilter> filters, std::vector<std::vector<double>>& forces) {
    std::vector<double> before(filters.size());
    std::vector<double> now(filters.size());
    const auto last = static_cast<Tick>(std::ceil(ticks_at(stretch_.end - 1)));
    std::size_t next = stretch_.first;
    for (Tick tick = 0; tick <= last; ++tick) {
      const cancellation::ChannelSample sample = sample_at(tick);
      for (std::size_t i = 0; i < filters.size(); ++i) {
        const ControlModelFilter::Force force = filters[i].step(sample, tick);
        before[i] = tick == 0 ? force.feedthrough_n + force.beside_n : now[i];
        now[i] = force.feedthrough_n + force.beside_n;
      }
      for (; next < stretch_.end && ticks_at(next) <= static_cast<double>(tick); ++next) {
        const double back = static_cast<double>(tick) - ticks_at(next);
        for (std::size_t i = 0; i < filters.size(); ++i) {
          forces[i][next] = now[i] - back * (now[i] - before[i]);
        }
      }
    }
  }

 private:
  // From tick 0 at the stretch's first sample.
  [[nodiscard]] double ticks_at(std::size_t n) const {
    constexpr double kRounding = 1e-6;
    const double ticks =
        static_cast<double>(n - stretch_.first) * kControlRateHz / signals_.rate_hz();
    const double whole = std::round(ticks);
    return std::abs(ticks - whole) < kRounding ? whole : ticks;
  }
  [[nodiscard]] cancellation::ChannelSample sample_at(Tick tick) const {
    const double place = (static_cast<double>(tick) - ticks_at(stretch_.first)) * kControlPeriod_s *
                         signals_.rate_hz();
    cancellation::ChannelSample sample{};
    for (const Sensed& each : sensed_) {
      const auto part =
          std::span(*each.values).subspan(stretch_.first, stretch_.end - stretch_.first);
      sample[each.channel] = diagnosis::value_at(part, place);
    }
    return sample;
  }

  const Signals& signals_;
  const std::vector<Sensed>& sensed_;
  const Stretch& stretch_;
};

// The same model with its clock begun again at a time: tones go on.
ControlModel begun_at(ControlModel model, double time_s) {
  for (cancellation::Wave& wave : model.waves) {
    if (wave.channel) continue;
    const std::complex<double> turned = std::complex(wave.sine_n, wave.cosine_n) *
                                        std::polar(1.0, kTwoPi * wave.frequency * time_s);
    wave.sine_n = turned.real();
    wave.cosine_n = turned.imag();
  }
  return model;
}

Model without(const Model& model, std::size_t e) {
  Model out = model;
  out.effects.erase(out.effects.begin() + static_cast<std::ptrdiff_t>(e));
  return out;
}

// Of the band that the conversion meets, each stretch from rest.
std::vector<double> in_band(std::vector<double> x, const Signals& signals, double upper_hz) {
  constexpr int kOrder = 4;
  if (2.0 * upper_hz >= signals.rate_hz()) return x;
  const signal::Butterworth low_pass(kOrder, upper_hz, signals.rate_hz());
  for (const Stretch& stretch : signals.stretches()) {
    signal::Butterworth filter = low_pass;
    for (std::size_t n = stretch.first; n < stretch.end; ++n) x[n] = filter.step(x[n]);
  }
  return x;
}

// RMS about the mean over the samples that are compared.
double level(const std::vector<double>& x, const std::vector<bool>& compared) {
  double sum = 0.0;
  double square = 0.0;
  double count = 0.0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (!compared[n]) continue;
    sum += x[n];
    square += x[n] * x[n];
    count += 1.0;
  }
  const double mean = sum / count;
  return std::sqrt(std::max(square / count - mean * mean, 0.0));
}

std::vector<double> less(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> out = x;
  for (std::size_t n = 0; n < out.size(); ++n) out[n] -= y[n];
  return out;
}

// All but what comes before the models have settled; of each stretch its second half at least.
std::vector<bool> compared_samples(const ControlModel& model, const Signals& signals) {
  const cancellation::ModelCheck check =
      cancellation::check_model(model, cancellation::ModelBounds{HUGE_VAL, HUGE_VAL});
  const double settle_s = static_cast<double>(check.refusal == cancellation::Refusal::kNone
                                                  ? check.settle_ticks
                                                  : cancellation::kMaxSettle_ticks) *
                          kControlPeriod_s;
  const auto settle = static_cast<std::size_t>((2.0 * settle_s + 2.0) * signals.rate_hz());
  std::vector<bool> out(signals.size(), false);
  for (const Stretch& stretch : signals.stretches()) {
    const std::size_t first = stretch.first + std::min(settle, (stretch.end - stretch.first) / 2);
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(first),
              out.begin() + static_cast<std::ptrdiff_t>(stretch.end), true);
  }
  return out;
}

}  // namespace

std::vector<std::vector<double>> forces_of(const std::vector<ControlModel>& models,
                                           const Signals& signals) {
  const std::vector<Sensed> sensed = sensed_in(signals);
  std::vector<std::vector<double>> forces(models.size(), std::vector<double>(signals.size()));
  for (const Stretch& stretch : signals.stretches()) {
    std::vector<ControlModelFilter> filters;
    for (const ControlModel& model : models) {
      filters.emplace_back(begun_at(model, signals.time_s()[stretch.first]), 1);
    }
    StretchReplay(signals, sensed, stretch).run(filters, forces);
  }
  return forces;
}

Signals second_motion(const Signals& signals) {
  return signals.moved([](const diagnosis::Signal& signal) {
    std::vector<double> x = signal.values;
    for (double& value : x) value -= signal.mean;
    x = diagnosis::other_phases(std::move(x), signal::Gaussian(kSeed, 0));
    for (double& value : x) value = signal.mean + kLouder * value;
    return x;
  });
}

std::vector<EffectDifference> effect_differences(const Model& model, const Signals& signals,
                                                 const std::vector<double>& denominator,
                                                 const ControlOptions& options) {
  // The diagnosed model knows no motor that is late.
  ControlOptions as_diagnosed = options;
  as_diagnosed.lead_s = 0.0;
  std::vector<Model> diagnosed{model};
  for (std::size_t e = 0; e < model.effects.size(); ++e) diagnosed.push_back(without(model, e));
  std::vector<ControlModel> exported;
  for (const Model& each : diagnosed) {
    exported.push_back(converted(each, signals, denominator, as_diagnosed).model);
  }
  const std::vector<bool> compared = compared_samples(exported.front(), signals);
  const auto over = [&](const Signals& motion) {
    const auto got = forces_of(exported, motion);
    std::vector<std::vector<double>> wanted;
    wanted.reserve(diagnosed.size());
    for (const Model& each : diagnosed) {
      wanted.push_back(diagnosis::free_run(each, motion).prediction);
    }
    std::vector<double> differences;
    for (std::size_t e = 1; e < diagnosed.size(); ++e) {
      const std::vector<double> effect = less(wanted.front(), wanted[e]);
      const std::vector<double> miss = less(less(got.front(), got[e]), effect);
      const auto size_of = [&](const std::vector<double>& force) {
        return level(in_band(force, motion, options.upper_hz), compared);
      };
      const double share =
          size_of(miss) / std::max(size_of(effect), kNoForce * size_of(wanted.front()));
      differences.push_back(std::isfinite(share) ? share : HUGE_VAL);
    }
    return differences;
  };
  const std::vector<double> source = over(signals);
  const std::vector<double> second = over(second_motion(signals));
  std::vector<EffectDifference> out;
  for (std::size_t e = 0; e < source.size(); ++e) out.push_back({source[e], second[e]});
  return out;
}

}  // namespace stillhand::close_the_loop
