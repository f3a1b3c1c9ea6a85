// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/choices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "apps/study/subjects/study.hpp"
#include "services/core/signal/reference.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::study {
namespace {

using cancellation::PartKind;

// Values tried, each list from gentle to strong.
constexpr std::array kLowPass_hz{4.0, 2.5, 1.6, 1.0, 0.7, 0.5};
constexpr std::array kNotchDamping{0.2, 0.4, 0.7, 1.0};
constexpr double kNotch_hz = 1.2;  // the middle of 0.7 to 2 Hz on a logarithmic scale
constexpr std::array kDamping_n_s_m{10.0, 20.0, 40.0, 60.0, 90.0};
constexpr std::array kSteps{0.002, 0.005, 0.01, 0.02, 0.05};

// A condition that is asked for has such a part.
bool wants(const CampaignOptions& options,
           const std::function<bool(const cancellation::Part&)>& such) {
  return std::ranges::any_of(options.mitigations, [&](Condition condition) {
    return std::ranges::any_of(session::row_of(condition).parts, such);
  });
}

bool shapes(const cancellation::Part& part) {
  return part.kind == PartKind::kLowPass || part.kind == PartKind::kNotch;
}
bool damps(const cancellation::Part& part) {
  return part.kind == PartKind::kImpedance && part.values[0] == 0.0;  // without stiffness
}
bool learns(const cancellation::Part& part) {
  return part.kind == PartKind::kLmsSignal || part.kind == PartKind::kLmsForce;
}

// Trials of one parameter's values on all tutors.
class Trying {
 public:
  Trying(const CampaignOptions& options, const std::vector<Tutor>& tutors, std::uint64_t seed,
         unsigned threads)
      : threads_(threads), scenes_(tutors.size() * options.motions.size()) {
    none_mm_.resize(scenes_.size());
    runtime::run_jobs(scenes_.size(), threads_, [&](std::size_t at) {
      const std::size_t i = at / options.motions.size();
      const TrialMotion motion = options.motions[at % options.motions.size()];
      TrialScene scene =
          scene_of(options, tutors[i].subject, person_seed(seed, static_cast<std::int64_t>(i)),
                   TrialTask::kTrack, motion);
      scene.motion = trial_motion(motion, scene.duration_ticks, scene.ramp_ticks, scene.rig_seed);
      none_mm_[at] = run_mitigated(scene, {}, false).error_mm;
      scenes_[at] = std::move(scene);
    });
  }

  // Mean over tutors and motions of the error over that without a mitigation.
  double ratio(const cancellation::Recipe& recipe) const {
    std::vector<double> ratios(scenes_.size());
    runtime::run_jobs(scenes_.size(), threads_, [&](std::size_t at) {
      ratios[at] = run_mitigated(scenes_[at], recipe, false).error_mm / none_mm_[at];
    });
    double sum = 0.0;
    for (const double one : ratios) sum += one;
    return sum / static_cast<double>(ratios.size());
  }

 private:
  unsigned threads_;
  std::vector<TrialScene> scenes_;
  std::vector<double> none_mm_;
};

// The value with the least ratio; says what every value gave.
template <typename Values, typename Made>
double least(const Trying& trying, const char* what, const Values& values, const Made& made,
             std::vector<std::string>& log, const OnCampaign& on_stage) {
  double best = values.front();
  double best_ratio = INFINITY;
  std::string line = fmt::format("{}:", what);
  for (const double value : values) {
    if (!on_stage(fmt::format("choosing: {}", what), 0.0)) throw Interrupted();
    const double ratio = trying.ratio(made(value));
    line += fmt::format(" {} {:.3f},", value, ratio);
    if (ratio < best_ratio) {
      best_ratio = ratio;
      best = value;
    }
  }
  log.push_back(fmt::format("{} chosen {}", line, best));
  return best;
}

// Power of the motions over the band: that of 0.7 to 2 Hz, and that of the road (MO-12: as f^2 in
// acceleration to 6 Hz), each with the paper's or its own RMS.
std::vector<PowerLine> motion_lines() {
  std::vector<PowerLine> out;
  constexpr double kLine_hz = 0.1;
  constexpr double kBandPower = 1.6 * 1.6 / (2.0 - 0.7);
  // G0 n0^2 u (2 pi)^4 of class B at 20 m/s.
  constexpr double kRoadPower = 64e-6 * 0.01 * 20.0 * 1558.5;
  for (int k = 3; k <= 60; ++k) {
    const double f = kLine_hz * k;
    const double band = f >= 0.7 && f <= 2.0 ? kBandPower : 0.0;
    out.push_back({f, kLine_hz * (band + kRoadPower * f * f)});
  }
  return out;
}

// The target's lines that a person follows: up to a little above the crossover, 0.3 Hz.
std::vector<PowerLine> target_lines() {
  constexpr double kDuration_s = 180.0;
  constexpr double kFollowed_hz = 0.5;
  const signal::ReferenceDesign design = signal::reference_design(kDuration_s);
  std::vector<PowerLine> out;
  for (std::size_t k = 0; k < design.harmonics.size(); ++k) {
    const double f = static_cast<double>(design.harmonics[k]) / kDuration_s;
    if (f < kFollowed_hz) out.push_back({f, design.amplitudes[k] * design.amplitudes[k]});
  }
  return out;
}

}  // namespace

std::uint64_t person_seed(std::uint64_t seed, std::int64_t index) {
  std::seed_seq mix{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                    std::uint32_t{0x4d697469}, static_cast<std::uint32_t>(index)};
  std::array<std::uint32_t, 2> words{};
  mix.generate(words.begin(), words.end());
  return std::uint64_t{words[1]} << 32 | words[0];
}

TrialScene scene_of(const CampaignOptions& options, const population::Subject& subject,
                    std::uint64_t seed, TrialTask task, TrialMotion motion) {
  TrialScene scene;
  scene.subject = subject;
  scene.task = task;
  scene.number = static_cast<std::int64_t>(motion) + 1;
  scene.rig_seed = seed + 100 * static_cast<std::uint64_t>(scene.number);
  scene.reference_seed = scene.rig_seed + 1;
  scene.duration_ticks = ticks_in(options.trial_s);
  scene.settle_ticks = scene.duration_ticks / 3;
  return scene;
}

Chosen choose(const CampaignOptions& options, const std::vector<Tutor>& tutors, std::uint64_t seed,
              unsigned threads, const OnCampaign& on_stage) {
  Chosen out;
  std::vector<KnownPerson> people;
  people.reserve(tutors.size());
  for (const Tutor& tutor : tutors) people.push_back(known(tutor.models));
  out.reduced = choose_reduced(people, motion_lines(), {});
  out.impedance = choose_impedance(people, motion_lines(), target_lines(), {});
  const auto& shaped = out.impedance.impedance;
  out.log.push_back(fmt::format(
      "reduced model: order {}, gain {:.2f}, {:.0f} % of the motion left in the worst case",
      out.reduced.order, out.reduced.gain, 100.0 * out.reduced.worst));
  out.log.push_back(fmt::format(
      "impedance: {:.0f} N/m, {:.0f} N s/m, {:.2f} kg; {:.0f} % of the motion left in the worst "
      "arm, {:.2f} times the force for the target, passive to {:.0f} Hz",
      shaped.stiffness_n_m, shaped.damping_n_s_m, shaped.mass_kg, 100.0 * out.impedance.worst,
      out.impedance.effort, out.impedance.passive_hz));
  const bool filters = wants(options, shapes);
  const bool dampers = wants(options, damps);
  const bool adaptive = wants(options, learns);
  if (!filters && !dampers && !adaptive) return out;
  const Trying trying(options, tutors, seed, threads);
  // The values of `part` with the least ratio, `place` of which is tried.
  const auto tried = [&](const char* what, const auto& values, cancellation::Part part,
                         std::size_t place) {
    const auto made = [&part, place](double value) {
      part.values[place] = value;
      return cancellation::Recipe{.parts = {part}};
    };
    part.values[place] = least(trying, what, values, made, out.log, on_stage);
    return part;
  };
  if (filters) {
    out.low_pass = tried("low-pass [Hz]", kLowPass_hz, out.low_pass, 0);
    out.notch.values[0] = kNotch_hz;
    out.notch = tried("notch at 1.2 Hz, damping ratio", kNotchDamping, out.notch, 1);
  }
  if (dampers) {
    const cancellation::Part damper{PartKind::kImpedance, {0.0, 0.0, 0.0}};
    out.damping_n_s_m = tried("damping [N s/m]", kDamping_n_s_m, damper, 1).values[1];
  }
  if (adaptive) {
    out.lms_signal_step =
        tried("step of the signal's LMS", kSteps, {PartKind::kLmsSignal, {0.0}}, 0).values[0];
    const auto feel = population::mean_subject(options.population).who.arm;
    const cancellation::Part lms{
        PartKind::kLmsForce,
        {0.0, feel.effective_mass_kg, feel.effective_damping_n_s_m, feel.effective_stiffness_n_m}};
    out.lms_force_step = tried("step of the force's LMS", kSteps, lms, 0).values[0];
  }
  return out;
}

}  // namespace stillhand::study
