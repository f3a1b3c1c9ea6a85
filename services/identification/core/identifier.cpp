// SPDX-License-Identifier: Apache-2.0
#include "services/identification/core/identifier.hpp"

#include <iomanip>
#include <sstream>
#include <utility>

#include "services/contract/config_error.hpp"
#include "services/identification/core/paper_preprocessing.hpp"
#include "services/signal/difference_model.hpp"

namespace stillhand::identification {

namespace {

// A disturbance that is not in the acceleration, such as a tone, attracts a pole that no filter at
// 1 kHz reproduces: with fewer poles none is left for it.
void convert_refined(IdentificationSteps& steps, int order, const ConversionBand& band) {
  constexpr int kLeastOrder = 2;
  while (true) {
    try {
      steps.control = to_control_rate(steps.refined->model, band);
      return;
    } catch (const ConfigError&) {
      if (order <= kLeastOrder) throw;
    }
    --order;
    steps.refined = refine_output_error(steps.record, fit_arx(steps.record, order).model);
  }
}

// Eq. ID-21.  A load cell of the wrong sign turns the model round, and the motor would help the
// seat.
void check_sign(const DifferenceModel& model, std::int64_t expected) {
  constexpr double kLowest_hz = 0.7;  // of the identification motion, paper III-A
  const double gain = signal::response_at(model, kLowest_hz).real();
  if (gain * static_cast<double>(expected) < 0.0) {
    std::ostringstream got;
    got << std::showpos << std::setprecision(3) << gain << " N per m/s^2";
    throw ConfigError(
        "feedthrough at 0.7 Hz", got.str(),
        "the other sign: an idle hand stays behind the seat. Check the signs of the accelerometer "
        "and the load cell (stillhand calibrate)");
  }
}

}  // namespace

IdentificationSteps identify_stepwise(const Record& recorded, const Config& config,
                                      bool refine_beside) {
  validate(config, "identification");
  ConversionBand band;
  band.max_error = config.max_conversion_error;
  IdentificationSteps steps;
  steps.record = preprocessed(recorded);
  steps.paper = fit_arx(steps.record, static_cast<int>(config.order));
  if (!steps.paper.stable) {
    steps.paper_unusable = "unstable";  // a free run that diverges can't cancel anything
  } else if (!config.refine) {
    try {
      steps.control = to_control_rate(steps.paper.model, band);
    } catch (const ConfigError& error) {
      steps.paper_unusable = error.what();
    }
  }
  steps.refined_used = config.refine || !steps.paper_unusable.empty();
  if (steps.refined_used || refine_beside) {
    steps.refined = refine_output_error(steps.record, steps.paper.model);
  }
  if (steps.refined_used) convert_refined(steps, static_cast<int>(config.order), band);
  return steps;
}

FeedthroughModel identify(const Record& recorded, const Config& config) {
  const IdentificationSteps steps = identify_stepwise(recorded, config, false);
  FeedthroughModel out;
  out.refined = steps.refined_used;
  out.fit = out.refined ? steps.refined->model : steps.paper.model;
  out.heldout = out.refined ? steps.refined->heldout : steps.paper.heldout;
  out.condition_number = steps.paper.condition_number;
  out.control = steps.control.model;
  out.conversion_error = steps.control.max_error;
  return out;
}

Identification identify(const PeggedTrial& trial, const Config& config) {
  if (std::string why = why_unusable(trial); !why.empty()) return {std::nullopt, std::move(why)};
  try {
    FeedthroughModel model = identify(trial.record, config);
    check_sign(model.fit, config.expected_sign);
    return {std::move(model), {}};
  } catch (const ConfigError& error) {
    return {std::nullopt, error.what()};
  }
}

Identification identify_position(const PeggedTrial& trial, const Config& config) {
  // In millimetres the numbers are as large as those of a force.
  constexpr double kMillimetre_m = 1e-3;
  PeggedTrial in_mm = trial;
  for (double& value : in_mm.record.force_n) value /= kMillimetre_m;
  Config refined = config;
  refined.refine = true;
  Identification found = identify(in_mm, refined);
  if (!found.model) return found;
  for (DifferenceModel* model : {&found.model->fit, &found.model->control}) {
    for (double& c : model->numerator) c *= kMillimetre_m;
  }
  found.model->heldout.free_run_rms_n *= kMillimetre_m;
  return found;
}

}  // namespace stillhand::identification
