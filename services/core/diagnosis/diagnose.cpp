// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/diagnose.hpp"

#include <algorithm>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/before_effects.hpp"
#include "services/core/diagnosis/body_order.hpp"
#include "services/core/diagnosis/first_model.hpp"
#include "services/core/diagnosis/judging.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::diagnosis {
namespace {

// A reason not to look for effects, if there is one.
void settle(Diagnosis& diagnosis, std::optional<NoModel> reason) {
  if (!reason) return;
  diagnosis.no_model = std::move(reason);
  diagnosis.options.search.most_effects = 0;
}

// Channels that another reading explains: exchanged, or one of them late.
std::optional<NoModel> channels_refused(const Measurement& working, const Signals& signals,
                                        const Blocks& blocks, const Model& baseline,
                                        const DiagnoseOptions& options) {
  std::optional<NoModel> reason =
      exchanged_of(working, signals, blocks, baseline, options.order, options.heaviest_kg);
  return reason ? reason : late_of(working, signals, blocks, baseline, options.order);
}

// Eq. DG-88: the whole diagnosis again, if it does not leave more than the search at this order.
std::optional<Diagnosis> at_higher_order(const Diagnosis& lower, const Measurement& measurement,
                                         const Signals& signals, const Blocks& blocks) {
  if (lower.no_model) return std::nullopt;
  DiagnoseOptions options = lower.options;
  const std::optional<int> order =
      order_instead(lower.model, signals, blocks, options.order,
                    lower.baseline.impulse_response_rmse, options.search);
  if (!order) return std::nullopt;
  const int before = std::exchange(options.order, *order);
  Diagnosis higher = diagnose(measurement, options);
  if (outdoes(held_out(lower.model, signals, blocks), held_out(higher.model, signals, blocks),
              options.search)) {
    return std::nullopt;
  }
  higher.notes.push_back("A body of order " + std::to_string(*order) +
                         " explains what one of order " + std::to_string(before) + " left.");
  return higher;
}

}  // namespace

bool Diagnosis::has_effect_that_counts() const {
  return std::ranges::any_of(effects, &FoundEffect::counts);
}

std::string Diagnosis::verdict() const {
  if (no_model) return "no model";
  if (has_effect_that_counts()) return "effects found";
  return unexplained ? "unexplained residual" : "nothing missing";
}

Diagnosis diagnose(const Measurement& measurement, const DiagnoseOptions& options) {
  const auto step = [&options](const std::string& name) {
    if (!options.progress(name)) throw Interrupted();
    return true;
  };
  check(measurement);
  Diagnosis diagnosis;
  diagnosis.options = options;
  diagnosis.screening = measurement.screening;
  settle(diagnosis, before_any_fit(measurement, options.inputs, options.output));
  step("preparing");
  const Measurement working = working_set(measurement, options.inputs);
  diagnosis.notes = working.notes;
  diagnosis.sample_rate_hz = working.rate_hz;
  Signals signals(working, options.inputs, options.output);
  diagnosis.output_unit = signals.output().unit;
  check_excitation(signals, working.source);
  const Blocks blocks = make_blocks(signals);
  step("baseline");
  fit_first_model(diagnosis, signals, blocks);
  const Model& baseline = diagnosis.baseline.model;
  if (!diagnosis.no_model)
    settle(diagnosis, channels_refused(working, signals, blocks, baseline, options));
  const Questions questions(signals);
  diagnosis.before = questions.of(Screening(baseline, signals, blocks, questions.impulse_response));
  diagnosis.search =
      search(diagnosis.baseline, signals, blocks, diagnosis.options.search, options.for_each, step);
  step("judging");
  take_found(diagnosis, signals, blocks);
  if (auto higher = at_higher_order(diagnosis, measurement, signals, blocks)) {
    return *std::move(higher);
  }
  judge(diagnosis, working, signals, blocks);
  look_at_the_rest(diagnosis, signals, blocks, questions);
  return diagnosis;
}

}  // namespace stillhand::diagnosis
