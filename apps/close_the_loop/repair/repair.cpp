// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/repair/repair.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "apps/close_the_loop/recorded/replay.hpp"
#include "apps/close_the_loop/repair/recorded_trial.hpp"
#include "apps/close_the_loop/verdict/control_laws.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/human_operator/fast_error.hpp"
#include "services/core/population/population.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::close_the_loop {
namespace {

namespace control = diagnosis::control;
using cancellation::ControlModel;
using diagnosis::Effect;
using diagnosis::Model;

constexpr std::size_t kSeeds = 10;

Model without(Model model, const Effect& effect) {
  std::erase_if(model.effects,
                [&](const Effect& each) { return diagnosis::is_same(each, effect); });
  return model;
}

Drive drive_of(const Verdict& verdict, const DeclaredDrive& declared) {
  Drive out;
  out.friction_n = declared.stick.coulomb_friction_n;
  if (verdict.latency && !verdict.cell_is_late) {
    const double late_s = verdict.latency->motor_s - declared.motor_delay_s;
    if (late_s >= kWorthLatency_s) out.late_s = late_s;
  }
  if (!verdict.drive || verdict.cell_is_late) return out;
  for (const diagnosis::FoundEffect& found : verdict.drive->effects) {
    if (!found.counts) continue;
    const auto role = diagnosis::effect_kind(found.effect.kind).drive_role(found.effect);
    if (std::holds_alternative<control::Friction>(role)) {
      out.friction_n += std::max(found.effect.coefficients.at(0), 0.0);
    } else if (const auto* waves = std::get_if<control::Waves>(&role); waves != nullptr) {
      ControlModel ripple;  // minus what the hand needs, as the force acts on the stick
      add_waves(found.effect, cancellation::Channel::kTheta, waves->frequency, -1.0, ripple);
      out.ripple = ripple.waves;
    }
  }
  return out;
}

// Half of the interval of an effect's size, of the size.
double relative_error(const Finding& finding) {
  if (!finding.interval95 || finding.explained_n <= 0.0) return 0.0;
  const auto& [low, high] = *finding.interval95;
  return (high - low) / (2.0 * finding.explained_n);
}

std::vector<double> differences(const std::vector<double>& from, const std::vector<double>& to) {
  std::vector<double> out;
  for (std::size_t i = 0; i < from.size(); ++i) out.push_back(to[i] - from[i]);
  return out;
}

// Eq. CL-13: the seeds' scatter, and that the size of the effect is not known better.
Estimate widened(Estimate change, double relative) {
  if (!change.interval95) return change;
  const double half = (change.interval95->second - change.interval95->first) / 2.0;
  const double wide = std::hypot(half, relative * change.mean);
  change.interval95 = {change.mean - wide, change.mean + wide};
  return change;
}

// Without the regression of Eq. HO-5 that the errors of the trial cause.
double crossover_at_rest_hz(const TrialRun& trial, const human_operator::CrossoverConfig& who) {
  const std::vector<double>& target = trial.measured.find("x_r")->values;
  const std::vector<double>& cursor = trial.measured.find("x_p")->values;
  human_operator::FastError fast(who.regression_above_hz, who.regression_memory_s);
  double slowing = 0.0;
  for (std::size_t n = 0; n < target.size(); ++n) {
    fast.step(target[n] - cursor[n]);
    slowing += fast.mean_square_m2() / (who.regression_error_m * who.regression_error_m);
  }
  const double measured_hz = trial.metrics.crossover_reference_hz;
  const double regressed = 1.0 + slowing / static_cast<double>(target.size());
  return std::isfinite(measured_hz) ? std::clamp(measured_hz * regressed, 0.05, 0.8)
                                    : who.crossover_hz;
}

// The argument at which a falling function has the value.
double where(double value, double low, double high, const std::function<double(double)>& falling) {
  constexpr int kSteps = 6;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = std::sqrt(low * high);
    (falling(middle) > value ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

// A rig or a person without the effect, and what a canceller then knows.
struct Case {
  Model body;
  Drive drive;
  ControlModel mended;
};

class Repair {
 public:
  Repair(const LoopResult& result, const LoopOptions& options)
      : result_(result),
        options_(options),
        verdict_(result.verdict()),
        pegged_(recorded_trial(advanced(record_of(result.trial("I")), options.diagnose.output,
                                        verdict_.cell_is_late ? verdict_.latency->cell_s : 0.0),
                               body())),
        carried_(verdict_.carried()),
        drive_(drive_of(verdict_, options.declared)) {
    for (const char* label : {"B", "C'"}) {
      courses_.push_back(recorded_trial(record_of(result.trial(label)), body()));
    }
    find_unexplained();
    fit_person();
  }

  RepairList run() const;

 private:
  [[nodiscard]] ControlModel followed(ControlModel model) const {
    model.adapts = options_.hand;
    return model;
  }
  [[nodiscard]] const Model& body() const { return verdict_.model(); }
  [[nodiscard]] const Round& round() const { return result_.rounds[result_.final_round]; }
  void find_unexplained();
  void fit_person();
  [[nodiscard]] Worth worth_of(const Finding& finding) const;
  void predict(const Finding& finding, Worth& out) const;
  [[nodiscard]] Case case_of(const Finding& finding) const;
  /// The paper's model of the pegged trial without what the model says of the difference.
  [[nodiscard]] ControlModel identified_without(const Model& mended) const;
  /// That knows this effect alone.
  [[nodiscard]] ControlModel knows(const Finding& finding) const;
  /// Seed by seed.
  [[nodiscard]] std::vector<double> errors(const Model& body, const Drive& drive,
                                           const ControlModel* model) const;
  [[nodiscard]] double mean_error(const PersonModel& person, const Course& course,
                                  const std::vector<double>& unexplained_n) const;

  const LoopResult& result_;
  const LoopOptions& options_;
  const Verdict& verdict_;
  RecordedTrial pegged_;
  diagnosis::CarriedModel carried_;
  Drive drive_;
  PersonModel person_;
  cancellation::AdaptiveGain::Pair track_{1.0, 0.0};  // of the tracking hand's body, Eq. CL-12
  std::vector<double> unexplained_n_;
  std::vector<RecordedTrial> courses_;
};

void Repair::find_unexplained() {
  const std::vector<double> run = diagnosis::free_run(body(), pegged_.signals).prediction;
  std::vector<double> left = pegged_.signals.output().values;
  double mean = 0.0;
  double count = 0.0;
  for (std::size_t n = 0; n < left.size(); ++n) {
    left[n] = pegged_.signals.weight()[n] * (left[n] - run[n]);
    mean += left[n];
    count += pegged_.signals.weight()[n];
  }
  // It grows with the motion: what no channel shows of it, and what the model misses.
  const double quieter = signal::rms(courses_.front().signals.at(body().inputs.front()).values) /
                         signal::rms(pegged_.signals.at(body().inputs.front()).values);
  for (double& each : left) each = quieter * (each - mean / count);
  unexplained_n_ = at_1_khz(left, pegged_);
}

double Repair::mean_error(const PersonModel& person, const Course& course,
                          const std::vector<double>& unexplained_n) const {
  constexpr std::size_t kFew = 3;
  std::vector<double> each(kFew);
  options_.diagnose.for_each(kFew, [&](std::size_t s) {
    each[s] = tracking_error_mm(person, course, drive_, nullptr, unexplained_n, s + 1);
  });
  return estimate(each).mean;
}

// Eq. CL-12.
void Repair::fit_person() {
  const population::Subject mean = population::mean_subject({});
  person_.who = mean.who;
  person_.hand = options_.hand;
  // Those of C' follow the paper's model, whose gain is another one.
  const TrialRun& followed = round().augmented ? round().trial : result_.trial("C'");
  if (const auto& weights = followed.weights; !weights.empty()) {
    const std::size_t half = weights.size() / 2;
    track_ = {0.0, 0.0};
    for (std::size_t n = half; n < weights.size(); ++n) {
      for (std::size_t i = 0; i < 2; ++i) {
        track_[i] += weights[n][i] / static_cast<double>(weights.size() - half);
      }
    }
  }
  const Course quiet = still_course(record_of(result_.trial("A")));
  person_.who.crossover_hz = crossover_at_rest_hz(result_.trial("A"), person_.who);
  person_.who.remnant_ratio =
      1.0 / where(result_.trial("A").metrics.rms_error_mm, 10.0, 1000.0, [&](double over) {
        PersonModel person = person_;
        person.who.remnant_ratio = 1.0 / over;
        return mean_error(person, quiet, {});
      });
  const auto stiffer = [&](double factor) {
    PersonModel person = person_;
    for (double* each :
         {&person.hand.mass_kg, &person.hand.damping_n_s_m, &person.hand.stiffness_n_m,
          &person.who.arm.effective_mass_kg, &person.who.arm.effective_damping_n_s_m,
          &person.who.arm.effective_stiffness_n_m}) {
      *each *= factor;
    }
    return person;
  };
  const Course moving = course_of(courses_.front(), body(), pegged_.signals, track_);
  person_ = stiffer(where(result_.trial("B").metrics.rms_error_mm, 0.4, 2.5, [&](double factor) {
    return mean_error(stiffer(factor), moving, unexplained_n_);
  }));
}

std::vector<double> Repair::errors(const Model& body, const Drive& drive,
                                   const ControlModel* model) const {
  std::vector<Course> courses;
  for (const RecordedTrial& each : courses_)
    courses.push_back(course_of(each, body, pegged_.signals, track_));
  std::vector<double> out(kSeeds);
  options_.diagnose.for_each(kSeeds, [&](std::size_t s) {
    out[s] = tracking_error_mm(person_, courses[s % courses.size()], drive, model, unexplained_n_,
                               s + 1);
  });
  return out;
}

ControlModel Repair::identified_without(const Model& mended) const {
  const auto run = [&](const Model& model) {
    return at_1_khz(diagnosis::free_run(model, pegged_.signals).prediction, pegged_);
  };
  const std::vector<double> with_n = run(body());
  const std::vector<double> without_n = run(mended);
  const auto from = static_cast<std::ptrdiff_t>(longest(pegged_.record.stretches).first);
  const auto to = from + static_cast<std::ptrdiff_t>(with_n.size());
  const auto part = [&](const std::string& channel) {
    const std::vector<double>& values = pegged_.record.find(channel)->values;
    return std::vector<double>(values.begin() + from, values.begin() + to);
  };
  identification::Record record{kControlRateHz, part(body().inputs.front()), part(body().output)};
  for (std::size_t n = 0; n < with_n.size(); ++n) record.force_n[n] += without_n[n] - with_n[n];
  return followed(cancellation::control_model(identification::identify(record).control));
}

ControlModel Repair::knows(const Finding& finding) const {
  if (std::ranges::count_if(verdict_.findings, &Finding::counts) == 1) return round().model;
  Model known = carried_.in_session;
  std::erase_if(known.effects, [&](const Effect& each) {
    return finding.where == kDrive || each.kind != finding.kind;
  });
  const bool leads = finding.where == kMotorPath;
  ControlOptions control;
  control.lead_s = leads ? verdict_.latency->motor_s : options_.declared.motor_delay_s;
  ConvertedModel out =
      to_control_model(fitted_again(known, pegged_.signals), pegged_.signals, control);
  if (finding.where == kDrive) add_drive_effects(*verdict_.drive, out);
  return followed(out.model);
}

Case Repair::case_of(const Finding& finding) const {
  Case out{body(), drive_, result_.followed_model};
  if (finding.where == kMotorPath) {
    out.drive.late_s = 0.0;
    return out;
  }
  if (finding.where == kDrive) {
    out.drive.friction_n = options_.declared.stick.coulomb_friction_n;
    out.drive.ripple.clear();
    return out;
  }
  for (const diagnosis::FoundEffect& each : verdict_.body.effects) {
    if (each.effect.kind == finding.kind && each.channel == finding.channel) {
      out.body = without(body(), each.effect);
    }
  }
  // A late load cell has no effect here: it only spoils what is identified.
  out.mended = identified_without(out.body);
  return out;
}

void Repair::predict(const Finding& finding, Worth& out) const {
  const Case one = case_of(finding);
  const std::vector<double> left = errors(body(), drive_, &result_.followed_model);
  const std::vector<double> mended = errors(one.body, one.drive, &one.mended);
  std::vector<double> cancelled = left;
  if (out.is_cancelled) {
    const ControlModel knowing = knows(finding);
    cancelled = errors(body(), drive_, &knowing);
  }
  out.left_mm = estimate(left);
  out.mended_mm = estimate(mended);
  out.cancelled_mm = estimate(cancelled);
  const double relative = relative_error(finding);
  out.by_mending_mm = widened(estimate(differences(left, mended)), relative);
  out.by_cancelling_mm = widened(estimate(differences(left, cancelled)), relative);
}

Worth Repair::worth_of(const Finding& finding) const {
  Worth out;
  out.kind = finding.kind;
  out.channel = finding.channel;
  out.where = finding.where;
  const auto treatment =
      std::ranges::find_if(verdict_.control.treatments, [&](const Treatment& each) {
        return each.kind == finding.kind && each.channel == finding.channel;
      });
  const bool left_alone = treatment != verdict_.control.treatments.end() && !treatment->cancelled;
  out.is_cancelled = round().augmented && !left_alone;
  if (std::ranges::any_of(verdict_.body.effects, [&](const diagnosis::FoundEffect& each) {
        return each.effect.kind == finding.kind && is_past(each.effect);
      })) {
    out.why_not = "of time alone: no other trial repeats it";
    return out;
  }
  try {
    predict(finding, out);
  } catch (const ConfigError& error) {
    out.why_not = error.what();
  }
  return out;
}

RepairList Repair::run() const {
  RepairList out;
  for (const Finding& finding : verdict_.findings) {
    if (finding.counts) out.effects.push_back(worth_of(finding));
  }
  std::ranges::stable_sort(out.effects, {}, [](const Worth& each) {
    return each.why_not.empty() ? each.by_mending_mm.mean : 0.0;
  });
  out.modelled_mm = estimate(errors(body(), drive_, &result_.followed_model)).mean;
  out.measured_mm = result_.trial("C'").metrics.rms_error_mm;
  return out;
}

bool gains(const Estimate& change) { return change.interval95 && change.interval95->second < 0.0; }

}  // namespace

const char* Worth::advice() const {
  if (!why_not.empty()) return "not known";
  if (!gains(by_mending_mm)) return gains(by_cancelling_mm) ? "cancel" : "leave";
  const double half = (by_mending_mm.interval95->second - by_mending_mm.interval95->first) / 2.0;
  const bool more = by_mending_mm.mean < by_cancelling_mm.mean - half;
  return more || !gains(by_cancelling_mm) ? "mend" : "cancel";
}

RepairList repair_list(const LoopResult& result, const LoopOptions& options) {
  const bool any = std::ranges::any_of(result.verdict().findings, &Finding::counts);
  return any ? Repair(result, options).run() : RepairList{};
}

}  // namespace stillhand::close_the_loop
