// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <span>

#include "apps/diagnose/page/binned_series.hpp"
#include "apps/diagnose/page/binning.hpp"
#include "apps/diagnose/page/law_parts.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/excerpt.hpp"
#include "services/core/diagnosis/effect_sizes.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/loop_sizes.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Effect;
using diagnosis::Model;
using diagnosis::SizeCase;
using diagnosis::Stage;
using report::Kind;
using report::Panel;

constexpr std::size_t kNarrowBins = 200;  // for laws with many turns
constexpr double kNoMemory = 0.98;        // of the force's variance that lies between narrow bins

// Samples of the stretch in which x swings most.
std::pair<std::size_t, std::size_t> largest_swing(const Evidence& evidence,
                                                  const std::vector<double>& x) {
  const std::size_t wanted = report::excerpt_length(x, evidence.signals.rate_hz());
  std::pair<std::size_t, std::size_t> best{0, 0};
  double most = -1.0;
  for (const diagnosis::Stretch& stretch : evidence.signals.stretches()) {
    const std::size_t length = std::min(wanted, stretch.end - stretch.first);
    for (std::size_t first = stretch.first; first + length <= stretch.end;
         first += std::max<std::size_t>(length / 4, 1)) {
      const auto [low, high] =
          std::minmax_element(x.begin() + static_cast<std::ptrdiff_t>(first),
                              x.begin() + static_cast<std::ptrdiff_t>(first + length));
      if (*high - *low <= most) continue;
      most = *high - *low;
      best = {first, first + length};
    }
  }
  return best;
}

// Where x turns back up, on the way down from a peak; a tenth of the range is a turn.
template <typename Iterator>
Iterator trough_after(Iterator peak, Iterator end, double range) {
  Iterator lowest = peak;
  for (Iterator at = peak; at != end && *at < *lowest + 0.1 * range; ++at) {
    if (*at < *lowest) lowest = at;
  }
  return lowest;
}

// Up to the largest peak of that stretch and down again: one loop.
std::pair<std::size_t, std::size_t> largest_loop(const Evidence& evidence,
                                                 const std::vector<double>& x) {
  const auto [first, end] = largest_swing(evidence, x);
  const std::span<const double> all = std::span(x).subspan(first, end - first);
  const auto [low, high] = std::ranges::minmax_element(all);
  const double range = *high - *low;
  const auto down = trough_after(high, all.end(), range);
  const auto up = trough_after(std::make_reverse_iterator(high), all.rend(), range);
  return {first + static_cast<std::size_t>(up.base() - all.begin()),
          first + static_cast<std::size_t>(down - all.begin())};
}

bool has_memory(const Evidence& evidence, const std::vector<double>& x,
                const std::vector<double>& y) {
  const std::vector<double>& weight = evidence.after.run.weight;
  return share_between_bins(axis_over(x, weight, kNarrowBins), x, y, weight) < kNoMemory;
}

void add_loop(const Evidence& evidence, const std::vector<double>& x, const std::vector<double>& y,
              Panel& panel) {
  const auto [first, end] = largest_loop(evidence, x);
  const auto cut = [first = first, end = end](const std::vector<double>& all) {
    return std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(first),
                               all.begin() + static_cast<std::ptrdiff_t>(end));
  };
  panel.series.push_back({.label = "the effect",
                          .kind = Kind::kLine,
                          .colour = report::Colour::kModel,
                          .x = cut(x),
                          .y = cut(y),
                          .line_width_px = 1.3});
}

// Samples whose x are the nearest to places that are evenly spread over what was seen, in order.
std::vector<std::size_t> spread_over(const Evidence& evidence, const std::vector<double>& x) {
  const BinAxis axis = axis_over(x, evidence.after.run.weight, kLawPoints);
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t n) { return x[n]; });
  std::vector<std::size_t> picked;
  for (std::size_t b = 0; b < axis.count; ++b) {
    const auto at =
        std::ranges::lower_bound(order, axis.centre(b), {}, [&](std::size_t n) { return x[n]; });
    if (at != order.end() && (picked.empty() || picked.back() != *at)) picked.push_back(*at);
  }
  return picked;
}

// The force over the channel that makes it.
Law term_law(const Evidence& evidence, const SizeCase& at, const EffectTrace& trace) {
  const Effect& effect = at.effect();
  const diagnosis::EffectKind& kind = diagnosis::effect_kind(effect.kind);
  const diagnosis::Signal& over = evidence.signals.at(effect.channels.front());
  const auto force_of = [&](const Effect& each) {
    diagnosis::Columns columns;
    kind.terms(each, evidence.signals, evidence.after.run.body, columns);
    std::vector<double> force(evidence.signals.size(), 0.0);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      for (std::size_t n = 0; n < force.size(); ++n) {
        force[n] += each.coefficients[c] * columns[c][n];
      }
    }
    return force;
  };
  const std::vector<double> force = force_of(effect);
  Panel panel;
  panel.x.label = axis_label(over.name, over.unit);
  panel.y.label = axis_label("effect at the output", evidence.found.output_unit);
  if (has_memory(evidence, over.values, force)) {
    add_loop(evidence, over.values, force, panel);
    return {{panel}, "One loop of the effect, at the largest motion."};
  }
  const std::vector<std::size_t> samples = spread_over(evidence, over.values);
  const auto values_at = [&](const std::vector<double>& all) {
    std::vector<double> values;
    for (const std::size_t n : samples) values.push_back(all[n]);
    return values;
  };
  const std::vector<double>& weight = evidence.after.run.weight;
  const auto means = [&](const std::vector<double>& y) {
    return binned_means(axis_over(over.values, weight, kLawBins), over.values, y, weight,
                        evidence.correlation_samples);
  };
  const BinnedMeans left = means(evidence.after.residual);
  panel.series.push_back({.label = "left with it",
                          .kind = Kind::kPoints,
                          .colour = kAfter,
                          .x = left.centre,
                          .y = left.mean,
                          .point_size = 1.0});
  panel.series.push_back(with_errors("without it", kBefore, means(trace.without)));
  add_with_band("the effect", values_at(over.values), values_at(force),
                evidence.errors.of([&](const Model& model) {
                  return values_at(force_of(model.effects[at.which]));
                }),
                panel);
  return {{panel},
          "The effect with the 95 % band of its numbers, and means of the residual over bins.",
          true};
}

// phi over its argument, both as they show at the output, Eq. DG-74 and DG-75.
Law loop_law(const Evidence& evidence, const SizeCase& at) {
  const diagnosis::FreeRun& run = evidence.after.run;
  const double threshold = diagnosis::effect_kind(at.effect().kind).feedback(at.effect()).threshold;
  std::vector<double> x = run.argument;
  std::vector<double> y = run.phi;
  for (double& each : x) each *= diagnosis::output_over_argument(at) / threshold;
  for (double& each : y) each *= diagnosis::output_over_phi(at);
  const std::string& unit = evidence.found.output_unit;
  Panel panel;
  panel.x.label = axis_label("motion inside the body, as it shows at the output", unit);
  panel.y.label = axis_label("nonlinearity at the output, at 0 Hz", unit);
  if (has_memory(evidence, x, y)) {
    add_loop(evidence, x, y, panel);
    return {{panel}, "One loop of the nonlinearity, at the largest motion (DG-74, DG-75)."};
  }
  const BinAxis axis = axis_over(x, evidence.after.run.weight, kLawPoints);
  std::vector<double> over;
  for (std::size_t b = 0; b < axis.count; ++b) over.push_back(axis.centre(b));
  // Threshold and size of a spring that hardly bends vary together: the curve varies less.
  const auto curve_of = [&](const Model& model) {
    const SizeCase moved{model, at.which, at.signals, at.centre_hz, at.largest_argument};
    const diagnosis::Nonlinearity nonlinearity =
        diagnosis::effect_kind(moved.effect().kind).feedback(moved.effect());
    const double scale = diagnosis::output_over_argument(moved);
    const double size = diagnosis::output_over_phi(moved);
    std::vector<double> curve;
    for (const double each : over) {
      diagnosis::LoopMemory none;
      curve.push_back(size * nonlinearity.phi(each / scale, none));
    }
    return curve;
  };
  add_with_band("the nonlinearity", over, curve_of(at.model), evidence.errors.of(curve_of), panel);
  return {{panel},
          "The nonlinearity over its argument (DG-74, DG-75), with the 95 % band of its numbers."};
}

}  // namespace

Law law_of(const Evidence& evidence, std::size_t which, const EffectTrace& trace) {
  const SizeCase at =
      diagnosis::size_case(evidence.found.model, which, evidence.signals, evidence.after.run);
  const Effect& effect = at.effect();
  const diagnosis::EffectKind& kind = diagnosis::effect_kind(effect.kind);
  switch (kind.stage(effect)) {
    case Stage::kInputValue:
    case Stage::kOutputValue:
      return map_law(evidence, at, trace);
    case Stage::kFeedback:
      // A stop has no force of its own: it takes as much as its body goes beyond.
      return kind.feedback(effect).stop ? Law{} : loop_law(evidence, at);
    case Stage::kTerm:
      break;
    case Stage::kInputTime:
    case Stage::kGain:
    case Stage::kWeight:
      return {};
  }
  if (kind.path(at, at.centre_hz)) return path_law(evidence, at, trace);
  const bool over_one = effect.channels.size() == 1 && !kind.through_body(effect);
  return over_one && !kind.any_shape() ? term_law(evidence, at, trace) : Law{};
}

}  // namespace stillhand::diagnose
