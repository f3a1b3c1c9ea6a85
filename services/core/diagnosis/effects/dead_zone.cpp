// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/loop_proposals.hpp"
#include "services/core/diagnosis/effects/map_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/loop_sizes.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kTriedWidths[] = {0.1, 0.2, 0.4, 0.8};  // [standard deviations]

double without_play(double x, double half_width) {
  return x - std::clamp(x, -half_width, half_width);
}

/// Play: nothing happens within a range of half width h:
///
///   x - clip(x, h) of input, output or a position;  feedback of clip(z, 1) inside the body
///
/// Source: METHOD Eq. DG-27; piecewise linear stiffness: Worden and Tomlinson (2001).
class DeadZone final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "dead_zone"; }
  [[nodiscard]] Stage stage(const Effect& effect) const override {
    if (effect.form == "at the input") return Stage::kInputValue;
    if (effect.form == "at the output") return Stage::kOutputValue;
    return effect.channels.empty() ? Stage::kFeedback : Stage::kTerm;
  }
  [[nodiscard]] double mapped(const Effect& effect, double value) const override {
    return without_play(value, effect.value(0));
  }
  [[nodiscard]] double slope(const Effect& effect, double value) const override {
    return std::abs(value) > effect.value(0) ? 1.0 : 0.0;
  }
  // A linear spring with play is the spring less a spring that stops at the play's ends.
  [[nodiscard]] Nonlinearity feedback(const Effect& effect) const override {
    return {[](double z, LoopMemory& /*memory*/) { return std::clamp(z, -1.0, 1.0); },
            threshold_of(effect)};
  }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const Signal& position = signals.at(effect.channels.at(0));
    columns.push_back(position.values);
    for (double& x : columns.back()) x = without_play(x - effect.value(1), effect.value(0));
  }
  [[nodiscard]] std::string column_unit(const Effect& effect, const Signals& signals,
                                        std::size_t /*i*/) const override {
    return signals.at(effect.channels.at(0)).unit;
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override;
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    if (effect.parameters.empty()) return "nothing happens within a range: " + effect.form;
    return "nothing happens within +-" + with_unit(effect.value(0), effect.parameters[0].unit) +
           ": play " + effect.form +
           (effect.channels.empty() ? std::string() : " (" + effect.channels.front() + ")");
  }
};

std::vector<Size> DeadZone::sizes(const SizeCase& at) const {
  const Effect& effect = at.effect();
  if (stage(effect) == Stage::kFeedback) {
    return {force_at_threshold(at, "gap_width", 2.0,
                               "swing of the output, from end to end, that stays inside the gap"),
            stiffness_ratio(at, 1.0, 0.0, "inside the gap, over that outside")};
  }
  return {{"gap_width", effect.parameters.at(0).unit, 2.0 * effect.value(0), "from end to end"}};
}

std::vector<Proposal> DeadZone::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  std::vector<Proposal> proposals;
  append(proposals,
         loop_proposals(
             screening, "dead_zone", "play",
             [](double z, LoopMemory& /*memory*/) { return std::clamp(z, -1.0, 1.0); }, false));
  const auto widths = [](double deviation) {
    std::vector<double> values;
    for (const double width : kTriedWidths) values.push_back(width * deviation);
    return values;
  };
  const auto lost = [](double x, double width) { return -std::clamp(x, -width, width); };
  const Signal& input = signals.inputs().front();
  append(proposals,
         input_map_proposals(screening,
                             {"dead_zone",
                              "at the input",
                              {input.name},
                              {{"half_width", input.unit, 0.0, 0.0, 3.0 * input.deviation}},
                              {}},
                             widths(input.deviation), lost));
  const double deviation = signals.output().deviation;
  append(proposals,
         output_map_proposals(screening,
                              {"dead_zone",
                               "at the output",
                               {},
                               {{"half_width", signals.output().unit, 0.0, 0.0, 3.0 * deviation}},
                               {}},
                              widths(deviation), lost,
                              [](double y, double width) { return y + std::copysign(width, y); }));
  std::vector<Proposal> of_channels;
  for (const Signal& signal : signals.all()) {
    if (signal.quantity != Quantity::kPosition || signal.derived) continue;
    for (const double width : widths(signal.deviation)) {
      of_channels.push_back(screening.with_coefficients(
          {"dead_zone",
           "beside the body",
           {signal.name},
           {{"half_width", signal.unit, width, 0.0, 3.0 * signal.deviation},
            constant("centre", signal.unit, signal.mean)},
           {}}));
    }
  }
  append(proposals, best_of(std::move(of_channels), 1));
  return proposals;
}

}  // namespace

const EffectKind& dead_zone_kind() {
  static const DeadZone kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis
