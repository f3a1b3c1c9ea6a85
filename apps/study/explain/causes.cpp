// SPDX-License-Identifier: Apache-2.0
#include "apps/study/explain/causes.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/clamp_fields.hpp"
#include "services/core/contract/expects.hpp"

namespace stillhand::study {
namespace {

// A cause that is a mean of the population and its coefficient of variation.  It is absent at the
// population's own mean; its spread adds to the population's own.
Cause personal(Cause cause, double population::Population::* mean,
               double population::Population::* cv) {
  cause.personal = true;
  cause.none = population::Population{}.*mean;
  cause.apply = [mean](StudyOptions& options, double value) { options.population.*mean = value; };
  cause.spread = [cv](population::Population& population, double value) {
    population.*cv = std::hypot(population.*cv, value);
  };
  return cause;
}

std::vector<Cause> of_the_machine() {
  return {{.name = "paper_chain",
           .what = "The motor's force comes through the chain of the paper's data: low-pass of "
                   "10 Hz, one sample of 50 Hz, hold.",
           .source = "paper III-A for the data; it does not state what ran on line",
           .apply = [](StudyOptions& options, double) { options.canceller = "paper"; }},
          {.name = "lateness",
           .what = "The motor's force is late.",
           .source = "no range: 0 to 0.125 s, which holds every filter of the paper",
           .parameter = "delay_s",
           .grid = {0.0, 0.025, 0.05, 0.075, 0.1, 0.125},
           .most = 0.125,
           .apply = [](StudyOptions& options, double value) { options.motor.delay_s = value; }},
          {.name = "motor_gain",
           .what = "The motor gives another force than it is asked for.",
           .source = "torque constant and capstan: 0.9 to 1.05, makers' data sheets; the range is "
                     "wider, for a wrong calibration",
           .parameter = "gain [-]",
           .none = 1.0,
           .grid = {0.4, 0.6, 0.8, 1.0, 1.2},
           .most = 1.2,
           .apply = [](StudyOptions& options, double value) { options.motor.gain = value; }}};
}

std::vector<Cause> of_the_arm() {
  using P = population::Population;
  return {
      personal({.name = "cocontraction",
                .what = "The tracking arm is stiffer than the idle one, by a factor that differs "
                        "between subjects.",
                .source = "1.2 to 2: Gomi and Osu (1998); to 3 and more between tasks: Burdet et "
                          "al. (2001), recalled",
                .parameter = "factor [-]",
                .grid = {1.0, 1.3, 1.6, 2.0, 2.5, 3.0, 4.0},
                .most = 3.0},
               &P::cocontraction_factor, &P::cocontraction_cv),
      personal({.name = "stiffening_by_vibration",
                .what = "Vibration changes the stiffness of the tracking arm.",
                .source = "softening of the relaxed body: Huang and Griffin (2008); stiffening: "
                          "none",
                .parameter = "growth_s2_m",
                .grid = {-0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.5},
                .most = 1.0},
               &P::stiffening_by_vibration_s2_m, &P::stiffening_by_vibration_cv),
      personal({.name = "stiffening_by_motor",
                .what = "A motor that moves the stick by itself makes the subject stiffen the arm.",
                .source = "direction: Burdet et al. (2001), unstable force fields; range: none",
                .parameter = "growth_per_n",
                .grid = {0.0, 0.1, 0.2, 0.35, 0.5, 0.8},
                .most = 0.5},
               &P::stiffening_by_motor_n, &P::stiffening_by_motor_cv),
      personal({.name = "wander",
                .what = "Grip and posture wander within and between trials.",
                .source = "force without feedback drifts by 7 to 35 %: Ambike et al. (2015), "
                          "Smith et al. (2018); of stiffness on a stick: none",
                .parameter = "sd_ln_stiffness [-]",
                .grid = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5},
                .most = 0.4},
               &P::wander, &P::wander_cv),
      personal({.name = "reflex",
                .what = "The tracking arm has a stretch reflex; the idle one has none.",
                .source = "0 to 400 N/m, 0 to 50 N s/m, 25 to 40 ms: de Vlugt et al. (2003), "
                          "Abbink (2006), recalled",
                .parameter = "stiffness_n_m",
                .grid = {0.0, 100.0, 200.0, 300.0, 400.0, 600.0},
                .most = 400.0},
               &P::reflex_stiffness_n_m, &P::reflex_stiffness_cv),
      personal({.name = "motor_resistance",
                .what = "The hand opposes a share of the motor's force, 0.1 s later.",
                .source = "long-latency responses of 50 to 100 ms; share against a random motor: "
                          "none",
                .parameter = "share [-]",
                .grid = {0.0, 0.15, 0.3, 0.45, 0.6, 0.9},
                .most = 0.6},
               &P::motor_resistance, &P::motor_resistance_cv)};
}

std::vector<Cause> of_the_rest() {
  using P = population::Population;
  return {
      personal({.name = "cross_axis",
                .what = "Motion that a_y does not show, as fore-aft and roll, also shakes the "
                        "hand.",
                .source = "mostly in axis: Khoshnewiszadeh and Pool (2021), touch screens; range "
                          "for a stick: none",
                .parameter = "force_n_s2_m",
                .grid = {0.0, 0.75, 1.25, 2.0, 3.0},
                .most = 2.0},
               &P::unmeasured_force_n_s2_m, &P::unmeasured_force_cv),
      personal({.name = "involuntary_force",
                .what = "The hand's force fluctuates without the subject's will.",
                .source = "0.1 to 0.8 N, derived from coefficients of variation of 1 to 5 %, "
                          "Jones et al. (2002), recalled",
                .parameter = "force_n",
                .grid = {0.0, 0.4, 0.7, 1.0, 1.5},
                .most = 1.0},
               &P::involuntary_force_n, &P::involuntary_force_cv),
      personal({.name = "remnant_by_vibration",
                .what = "Vibration makes the subject's remnant larger.",
                .source = "\"dramatic increases\" with a displacement stick: Allen, Jex and "
                          "Magdaleno (1973); slope: none",
                .parameter = "growth_s2_m",
                .grid = {0.0, 0.5, 1.0, 2.0, 3.0, 5.0},
                .most = 3.0},
               &P::remnant_by_vibration_s2_m, &P::remnant_by_vibration_cv),
      personal({.name = "delay_by_vibration",
                .what = "Vibration makes the subject see and answer later.",
                .source = "0 to 0.1 s in all: Levison and Harrah (1977), recalled; \"generally "
                          "subtle\": Allen, Jex and Magdaleno (1973)",
                .parameter = "growth_s3_m",
                .grid = {0.0, 0.02, 0.04, 0.06, 0.08, 0.12},
                .most = 0.08},
               &P::delay_by_vibration_s3_m, &P::delay_by_vibration_cv)};
}

Calibrated mean(std::string name, double population::Population::* field, double prior_sd,
                std::string source) {
  return {
      std::move(name), prior_sd, std::move(source),
      [field](population::Population& population, double factor) { population.*field *= factor; }};
}

// Every coefficient of variation.
struct ScaleSpreads {
  double factor;
  void operator()(const char* name, double& value, Range range, const char*) const {
    if (std::string(name).ends_with("_cv")) value = std::min(value * factor, range.max);
  }
};

}  // namespace

const std::vector<Cause>& causes() {
  static const std::vector<Cause> kAll = [] {
    std::vector<Cause> all;
    for (const auto& some : {of_the_machine(), of_the_arm(), of_the_rest()}) {
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }();
  return kAll;
}

const std::vector<Calibrated>& calibrated() {
  using P = population::Population;
  static const std::vector<Calibrated> kAll{
      mean("seat_frequency_hz", &P::seat_frequency_hz, 0.2, "1.5 to 4 Hz, Fairley and Griffin"),
      mean("shoulder_stiffness_n_m", &P::shoulder_stiffness_n_m, 0.3,
           "200 to 1200 N/m, Perreault et al. (2002)"),
      mean("crossover_hz", &P::crossover_hz, 0.3, "none"),
      mean("remnant_ratio", &P::remnant_ratio, 0.4, "0.01 to 0.03, Levison et al. (1969)"),
      mean("regression_error_m", &P::regression_error_m, 0.5, "none"),
      {"spread of every quantity", 0.5, "0.1 to 0.4, assumed",
       [](population::Population& population, double factor) {
         ScaleSpreads visit{factor};
         P::fields(visit, population);
       }}};
  return kAll;
}

population::Population shifted(population::Population population,
                               const std::vector<double>& shift) {
  STILLHAND_EXPECTS(shift.size() == calibrated().size());
  for (std::size_t i = 0; i < shift.size(); ++i) {
    calibrated()[i].scale(population, std::exp(shift[i]));
  }
  settings::clamp_fields(population);
  return population;
}

}  // namespace stillhand::study
