// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/identifier.hpp"

#include <algorithm>
#include <functional>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/identification/paper_preprocessing.hpp"
#include "services/core/signal/difference_model.hpp"

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

// What answers the platform, in the words of a refusal.
struct Answer {
  const char* unit;
  const char* stays;   ///< who stays behind the seat
  const char* sensor;  ///< whose sign may be wrong
};
constexpr Answer kForce{"N", "an idle hand", "the load cell"};
constexpr Answer kPosition{"mm", "a hand that holds a free stick", "the stick's angle"};

// Eq. ID-21.  A load cell, or an angle, of the wrong sign turns the model round, and the motor, or
// what is taken off the command, would help the seat.
void check_sign(const DifferenceModel& model, std::int64_t expected, const Answer& answer) {
  constexpr double kLowest_hz = 0.7;  // of the identification motion, paper III-A
  const double gain = signal::response_at(model, kLowest_hz).real();
  if (gain * static_cast<double>(expected) < 0.0) {
    std::ostringstream got;
    got << std::showpos << std::setprecision(3) << gain << ' ' << answer.unit << " per m/s^2";
    throw ConfigError("feedthrough at 0.7 Hz", got.str(),
                      std::string("the other sign: ") + answer.stays +
                          " stays behind the seat. Check the signs of the accelerometer and " +
                          answer.sensor + " (stillhand calibrate)");
  }
}

Identification identified(const PeggedTrial& trial, const Config& config, const Answer& answer) {
  if (std::string why = why_unusable(trial); !why.empty()) return {std::nullopt, std::move(why)};
  try {
    FeedthroughModel model = identify(trial.record, config);
    check_sign(model.fit, config.expected_sign, answer);
    return {std::move(model), {}};
  } catch (const ConfigError& error) {
    return {std::nullopt, error.what()};
  }
}

bool stands_still(const std::vector<double>& positions) {
  return std::ranges::adjacent_find(positions, std::not_equal_to<>()) == positions.end();
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
  return identified(trial, config, kForce);
}

Identification identify_position(const PeggedTrial& trial, const Config& config) {
  // In millimetres the numbers are as large as those of a force.
  constexpr double kMillimetre_m = 1e-3;
  // The chain would ask for the load cell.
  if (why_unusable(trial).empty() && stands_still(trial.record.force_n)) {
    return {std::nullopt,
            "the stick's angle is constant: is the stick free and its encoder connected?"};
  }
  PeggedTrial in_mm = trial;
  for (double& value : in_mm.record.force_n) value /= kMillimetre_m;
  Config refined = config;
  refined.refine = true;
  Identification found = identified(in_mm, refined, kPosition);
  if (!found.model) return found;
  for (DifferenceModel* model : {&found.model->fit, &found.model->control}) {
    for (double& c : model->numerator) c *= kMillimetre_m;
  }
  found.model->heldout.free_run_rms_n *= kMillimetre_m;
  return found;
}

}  // namespace stillhand::identification
