// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/explanation_over_time.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/diagnose/page/binning.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Effect;
using report::Kind;
using report::Series;

constexpr double kWidestLag_s = 0.6;
constexpr double kAround_s = 1.0;
constexpr std::size_t kGainBins = 24;
constexpr double kFewestIndependent = 5.0;  // samples in a bin

struct Lag {
  double lag_s = 0.0;
  double error_s = 0.0;
};

// Lag of the largest correlation of y with x over some samples, a parabola through its neighbours;
// its error is that of the least-squares lag: noise over slope.
std::optional<Lag> lag_between(const std::vector<double>& x, const std::vector<double>& y,
                               std::size_t first, std::size_t end, const Evidence& evidence) {
  const double rate_hz = evidence.signals.rate_hz();
  const auto widest = static_cast<std::ptrdiff_t>(kWidestLag_s * rate_hz);
  const auto begin = static_cast<std::ptrdiff_t>(first) + widest;
  const auto stop = static_cast<std::ptrdiff_t>(end) - widest;
  if (stop - begin < widest) return {};
  const auto at = [](const std::vector<double>& v, std::ptrdiff_t n) {
    return v[static_cast<std::size_t>(n)];
  };
  std::vector<double> correlation;
  for (std::ptrdiff_t lag = -widest; lag <= widest; ++lag) {
    double product = 0.0;
    double square = 1e-300;
    for (std::ptrdiff_t n = begin; n < stop; ++n) {
      product += at(x, n - lag) * at(y, n);
      square += at(x, n - lag) * at(x, n - lag);
    }
    correlation.push_back(product / std::sqrt(square));
  }
  const auto peak = std::ranges::max_element(correlation) - correlation.begin();
  if (peak == 0 || peak == 2 * widest) return {};
  const double low = correlation[static_cast<std::size_t>(peak) - 1];
  const double top = correlation[static_cast<std::size_t>(peak)];
  const double high = correlation[static_cast<std::size_t>(peak) + 1];
  const double bent = low - 2.0 * top + high;
  const double fraction = bent < 0.0 ? 0.5 * (low - high) / bent : 0.0;
  double slope = 1e-300;
  double left = 0.0;
  for (std::ptrdiff_t n = begin; n < stop; ++n) {
    slope += std::pow((at(x, n) - at(x, n - 1)) * rate_hz, 2);
    left += std::pow(at(evidence.after.residual, n), 2);
  }
  const double noise = left / static_cast<double>(stop - begin) * evidence.correlation_samples;
  return Lag{(static_cast<double>(peak - widest) + fraction) / rate_hz, std::sqrt(noise / slope)};
}

void add_factor(const Effect& effect, const diagnosis::Signals& signals,
                std::vector<double>& gain) {
  const auto& kind = diagnosis::effect_kind(effect.kind);
  if (kind.stage(effect) == diagnosis::Stage::kGain) kind.gain(effect, signals, gain);
}

}  // namespace

Explanation lag_over_time(const Evidence& evidence, const Effect& effect,
                          const EffectTrace& trace) {
  const diagnosis::Signals& signals = evidence.signals;
  const auto& kind = diagnosis::effect_kind(effect.kind);
  std::vector<double> measured = evidence.after.run.body;
  for (std::size_t n = 0; n < measured.size(); ++n) measured[n] += evidence.after.residual[n];
  Series lags{.label = "output after prediction", .kind = Kind::kErrorBars, .colour = kBefore};
  Series model{.label = "the effect", .kind = Kind::kLine, .colour = report::Colour::kModel};
  const auto least = static_cast<std::size_t>(6.0 * kWidestLag_s * signals.rate_hz());
  const std::size_t length = std::max(diagnosis::make_blocks(signals).length, least);
  for (const diagnosis::Stretch& stretch : signals.stretches()) {
    for (std::size_t first = stretch.first; first + length <= stretch.end; first += length) {
      const double time_s = signals.time_s()[first + length / 2];
      model.x.push_back(time_s);
      model.y.push_back(1000.0 * kind.input_delay_s(effect, time_s));
      const auto lag = lag_between(trace.run.body, measured, first, first + length, evidence);
      if (!lag) continue;
      lags.x.push_back(time_s);
      lags.y.push_back(1000.0 * lag->lag_s);
      lags.y_low.push_back(1000.0 * (lag->lag_s - lag->error_s));
      lags.y_high.push_back(1000.0 * (lag->lag_s + lag->error_s));
    }
  }
  Explanation result;
  result.panel.x.label = "time [s]";
  result.panel.y.label = "lag [ms]";
  result.panel.series = {lags, model};
  result.panel.reference_lines = {{.at = 0.0}};
  result.text =
      "delay of the measured output behind the prediction without the effect (largest correlation, "
      "block by block)";
  return result;
}

Explanation local_gain(const Evidence& evidence, std::size_t which) {
  const diagnosis::Signals& signals = evidence.signals;
  const auto& effects = evidence.found.model.effects;
  const Effect& effect = effects.at(which);
  const std::vector<double>& weight = evidence.after.run.weight;
  std::vector<double> own(signals.size(), 1.0);
  std::vector<double> others(signals.size(), 1.0);
  for (std::size_t e = 0; e < effects.size(); ++e) {
    add_factor(effects[e], signals, e == which ? own : others);
  }
  const bool by_channel = !effect.channels.empty();
  const std::vector<double>& x =
      by_channel ? signals.at(effect.channels.front()).values : signals.time_s();
  const BinAxis axis =
      axis_over(x, weight, bins_for(weight, evidence.correlation_samples, kGainBins));
  // Least squares within a bin: measured = gain * reference.
  std::vector<double> product(axis.count, 0.0);
  std::vector<double> square(axis.count, 0.0);
  std::vector<double> left(axis.count, 0.0);
  std::vector<double> count(axis.count, 0.0);
  for (std::size_t n = 0; n < signals.size(); ++n) {
    const std::size_t bin = axis.bin_of(x[n]);
    if (bin == axis.count || !(weight[n] > 0.0)) continue;
    const double reference = others[n] * evidence.after.run.body[n];
    const double r = evidence.after.residual[n];
    product[bin] += (own[n] * reference + r) * reference;
    square[bin] += reference * reference;
    left[bin] += r * r;
    count[bin] += 1.0;
  }
  Series measured{.label = "measured over predicted", .kind = Kind::kErrorBars, .colour = kBefore};
  for (std::size_t b = 0; b < axis.count; ++b) {
    if (count[b] < kFewestIndependent * evidence.correlation_samples || !(square[b] > 0.0))
      continue;
    const double gain = product[b] / square[b];
    const double error = std::sqrt(left[b] / count[b] * evidence.correlation_samples / square[b]);
    measured.x.push_back(axis.centre(b));
    measured.y.push_back(gain);
    measured.y_low.push_back(gain - error);
    measured.y_high.push_back(gain + error);
  }
  const BinAxis fine{axis.low, axis.high, 200};
  const BinnedMeans means = binned_means(fine, x, own, weight, 1.0);
  Series model{.label = "the effect",
               .kind = Kind::kLine,
               .colour = report::Colour::kModel,
               .x = means.centre,
               .y = means.mean};
  Explanation result;
  result.panel.x.label =
      by_channel ? axis_label(effect.channels.front(), signals.at(effect.channels.front()).unit)
                 : "time [s]";
  result.panel.y.label = "gain over the model's [-]";
  result.panel.series = {model, measured};
  result.panel.reference_lines = {{.at = 1.0}};
  result.text =
      "gain of the measured output over the prediction without the effect, by bins (least squares)";
  return result;
}

Explanation strongest_burst(const Evidence& evidence, const EffectTrace& trace) {
  const diagnosis::Signals& signals = evidence.signals;
  struct Burst {
    std::size_t first = 0;
    std::size_t end = 0;
    double energy = 0.0;
  } best;
  const auto disclaimed = [&](std::size_t n) {
    return evidence.after.run.weight[n] <= 0.0 && trace.run.weight[n] > 0.0;
  };
  for (std::size_t n = 0; n < signals.size();) {
    Burst burst{n, n, 0.0};
    for (; burst.end < signals.size() && disclaimed(burst.end); ++burst.end) {
      burst.energy += trace.without[burst.end] * trace.without[burst.end];
    }
    if (burst.energy > best.energy) best = burst;
    n = burst.end + 1;
  }
  Explanation result;
  result.panel.x.label = "time [s]";
  result.panel.y.label = axis_label("residual", evidence.found.output_unit);
  result.text = "residual around the strongest of the bursts that the model leaves out";
  if (best.end == 0) return result;
  const auto around = static_cast<std::size_t>(kAround_s * signals.rate_hz());
  const std::size_t from = best.first > around ? best.first - around : 0;
  const std::size_t to = std::min(best.end + around, signals.size());
  Series line{.label = "residual", .kind = Kind::kLine, .colour = kBefore};
  Series kept{.label = "used for the fit", .kind = Kind::kLine, .colour = kAfter};
  for (std::size_t n = from; n < to; ++n) {
    line.x.push_back(signals.time_s()[n]);
    line.y.push_back(trace.run.weight[n] > 0.0 ? trace.without[n] : NAN);
    kept.y.push_back(evidence.after.run.weight[n] > 0.0 ? evidence.after.residual[n] : NAN);
  }
  kept.x = line.x;
  result.panel.series = {line, kept};
  for (const std::size_t end : {best.first, best.end - 1}) {
    result.panel.reference_lines.push_back(
        {.direction = report::Direction::kVertical, .at = signals.time_s()[end]});
  }
  return result;
}

}  // namespace stillhand::diagnose
