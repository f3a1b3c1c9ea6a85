// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "apps/study/explain/causes.hpp"

namespace stillhand::study {
namespace {

using P = population::Population;
using S = PersonalSpread;

Cause within(Cause cause, double S::* field) {
  cause.none = S{}.*field;
  cause.most = cause.grid.back();
  cause.apply = [field](StudyOptions& options, double value) {
    if (!options.personal) options.personal.emplace();
    (*options.personal).*field = value;
  };
  return cause;
}

// Another coefficient of variation of the population.
Cause wider(Cause cause, double P::* cv) {
  cause.none = P{}.*cv;
  cause.most = cause.grid.back();
  cause.apply = [cv](StudyOptions& options, double value) { options.population.*cv = value; };
  return cause;
}

// What some have and others do not: a mean with a deviation of the same size.
Cause in_some(Cause cause, double P::* mean, double P::* cv) {
  cause.most = cause.grid.back();
  cause.apply = [mean, cv](StudyOptions& options, double value) {
    options.population.*mean = value;
    options.population.*cv = value == 0.0 ? 0.0 : 1.0;
  };
  return cause;
}

std::vector<Cause> on_the_peg() {
  return {
      within({.name = "pegged_stiffness",
              .what = "The hand on the peg is stiffer or slacker than the same hand tracking, "
                      "by a factor of the person's own.",
              .source = "1.2 to 2 between tasks, Gomi and Osu (1998), is 0.13; to 3, Burdet et "
                        "al. (2001), recalled, is 0.3",
              .parameter = "sd_ln",
              .grid = {0.0, 0.15, 0.3}},
             &S::pegged_stiffness),
      within({.name = "pegged_grip",
              .what = "The grip on the peg is tighter or looser than while tracking.",
              .source = "stiffness in proportion to grip force: Hoeppner et al. (2013); half to "
                        "twice the force: assumed",
              .parameter = "sd_ln",
              .grid = {0.0, 0.5}},
             &S::pegged_grip),
      within({.name = "pegged_posture",
              .what = "The person sits otherwise: mass and stiffness of the arm at the hand "
                      "differ between peg and tracking.",
              .source = "both depend on the posture: Mussa-Ivaldi et al. (1985); to 0.3: assumed",
              .parameter = "sd_ln",
              .grid = {0.0, 0.3}},
             &S::pegged_posture),
      within({.name = "noisy_model",
              .what = "The two minutes on the peg hold more, or less, force that the model "
                      "cannot explain.",
              .source = "0 to models that explain 60 %, recalled for sticks (rig, Next to "
                        "measured hands)",
              .parameter = "factor [-]",
              .grid = {0.0, 1.0, 3.0}},
             &S::pegged_noise)};
}

std::vector<Cause> of_the_skill() {
  return {
      within({.name = "learning",
              .what = "Some get better from trial to trial, others tire.",
              .source = "the sign goes both ways after hours of practice; to 0.1 a trial: assumed",
              .parameter = "sd_ln_a_trial",
              .grid = {0.0, 0.1}},
             &S::learning),
      within({.name = "trial_skill",
              .what = "The skill of a person differs from trial to trial.",
              .source = "some 0.1 from run to run: McRuer et al. (1965), recalled",
              .parameter = "sd_ln",
              .grid = {0.0, 0.15}},
             &S::trial_skill),
      within({.name = "motor_skill",
              .what = "With the motor some track better, others worse.",
              .source = "none; the paper's people felt the motor",
              .parameter = "sd_ln",
              .grid = {0.0, 0.15, 0.3}},
             &S::motor_skill),
      wider({.name = "crossover",
             .what = "People differ more in their crossover.",
             .source = "0.1 to 0.35: 0.1 to 0.6 Hz expected, paper III-B",
             .parameter = "cv [-]",
             .grid = {0.15, 0.35}},
            &P::crossover_cv),
      wider({.name = "regression",
             .what = "People differ more in the error at which they regress their crossover.",
             .source = "considerably: Beerens et al. (2009), abstract; to 0.5: assumed",
             .parameter = "cv [-]",
             .grid = {0.15, 0.5}},
            &P::regression_cv),
      wider({.name = "remnant",
             .what = "People differ more in their remnant.",
             .source = "0.01 to 0.03, Levison et al. (1969), is 0.3; to 0.5: assumed",
             .parameter = "cv [-]",
             .grid = {0.25, 0.5}},
            &P::remnant_cv),
      wider({.name = "own_delay",
             .what = "People differ more in their delay.",
             .source = "0.15 to 0.3 s between people, McRuer and Jex (1967), recalled",
             .parameter = "cv [-]",
             .grid = {0.08, 0.24}},
            &P::delay_cv),
      in_some({.name = "delay_by_vibration",
               .what = "Vibration delays some people, others not.",
               .source = "0 to 0.1 s in all: Levison and Harrah (1977), recalled",
               .parameter = "growth_s3_m",
               .grid = {0.0, 0.04}},
              &P::delay_by_vibration_s3_m, &P::delay_by_vibration_cv)};
}

std::vector<Cause> of_the_tracking_arm() {
  return {wider({.name = "cocontraction",
                 .what = "People differ more in how much stiffer the tracking arm is.",
                 .source = "as pegged_stiffness",
                 .parameter = "cv [-]",
                 .grid = {0.1, 0.3}},
                &P::cocontraction_cv),
          in_some({.name = "stiffening_by_vibration",
                   .what = "Vibration stiffens the arm of some people.",
                   .source = "none",
                   .parameter = "growth_s2_m",
                   .grid = {0.0, 0.2, 0.4}},
                  &P::stiffening_by_vibration_s2_m, &P::stiffening_by_vibration_cv),
          in_some({.name = "stiffening_by_motor",
                   .what = "The motor makes some people stiffen the arm.",
                   .source = "direction: Burdet et al. (2001); range: none",
                   .parameter = "growth_per_n",
                   .grid = {0.0, 0.1, 0.2}},
                  &P::stiffening_by_motor_n, &P::stiffening_by_motor_cv),
          in_some({.name = "reflex",
                   .what = "Some tracking arms have a stretch reflex.",
                   .source = "0 to 400 N/m: de Vlugt et al. (2003), Abbink (2006), recalled",
                   .parameter = "stiffness_n_m",
                   .grid = {0.0, 200.0, 400.0}},
                  &P::reflex_stiffness_n_m, &P::reflex_stiffness_cv),
          in_some({.name = "motor_resistance",
                   .what = "Some hands oppose a share of the motor's force, 0.1 s later.",
                   .source = "long-latency responses of 50 to 100 ms; of the share: none",
                   .parameter = "share [-]",
                   .grid = {0.0, 0.2, 0.45}},
                  &P::motor_resistance, &P::motor_resistance_cv),
          wider({.name = "wander",
                 .what = "Grip and posture wander more.",
                 .source = "0.05 to 0.4: Ambike et al. (2015), Smith et al. (2018), of force",
                 .parameter = "sd_ln_stiffness",
                 .grid = {0.1, 0.4}},
                &P::wander),
          wider({.name = "cross_axis",
                 .what = "People differ more in the force from motion that a_y does not show.",
                 .source = "none",
                 .parameter = "cv [-]",
                 .grid = {0.3, 1.0}},
                &P::unmeasured_force_cv)};
}

std::vector<Cause> of_the_day() {
  return {
      within({.name = "motor_gain_of_a_day",
              .what = "Motor or load cell has another gain on each day.",
              .source = "torque constant and capstan: 0.9 to 1.05, makers' data sheets",
              .parameter = "sd_ln",
              .grid = {0.0, 0.1}},
             &S::motor_gain),
      // Only useful in a combination: it makes room for what weakens the cancellation.
      {.name = "less_late",
       .what = "What ran on line was not the whole chain of the paper's data.",
       .source = "30 ms: sampling at 50 Hz alone, one sample and hold; 81.5 ms: the chain, CC-16",
       .parameter = "delay_s",
       .none = kPaperChain_s,
       .grid = {0.03, 0.055, kPaperChain_s},
       .most = 0.03,
       .apply = [](StudyOptions& options, double value) {
         if (value >= kPaperChain_s) return;
         options.canceller = "now";
         options.motor.delay_s = value;
       }}};
}

}  // namespace

const std::vector<Cause>& spread_causes() {
  static const std::vector<Cause> kAll = [] {
    std::vector<Cause> all;
    for (const auto& some : {on_the_peg(), of_the_skill(), of_the_tracking_arm(), of_the_day()}) {
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }();
  return kAll;
}

}  // namespace stillhand::study
