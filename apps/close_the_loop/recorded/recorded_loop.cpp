// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/recorded/recorded_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/libraries/measurement/read.hpp"
#include "services/core/cancellation/config.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::close_the_loop {
namespace {

// Of a single pegged record: its end is kept apart for judging.
constexpr double kKeptApart = 0.3;
// A rate that differs by more is not the control rate.
constexpr double kRateTolerance = 1e-3;

diagnosis::Measurement read(const std::string& path, const std::string& trial,
                            measurement::ReadOptions options) {
  options.session_trial = trial;
  return measurement::read_measurement(path, options);
}

// The stick's own signals, at 1 kHz: the longest stretch without a long gap, whose short gaps are
// filled in.
recording::Recording read_stick(const std::string& path, const std::string& trial,
                                const measurement::ReadOptions& options,
                                std::vector<std::string>& notes) {
  const diagnosis::Measurement measured = read(path, trial, options);
  if (std::abs(measured.rate_hz / kControlRateHz - 1.0) > kRateTolerance) {
    throw ConfigError(path, fmt::format("{:.6g} Hz", measured.rate_hz),
                      "1000 Hz: the delays of the motor are a few milliseconds");
  }
  const diagnosis::Stretch& longest = *std::ranges::max_element(
      measured.stretches, {}, [](const auto& stretch) { return stretch.end - stretch.first; });
  if (measured.stretches.size() > 1) {
    notes.push_back(fmt::format("{}: the longest of {} stretches is used, {:.1f} s.", path,
                                measured.stretches.size(),
                                static_cast<double>(longest.end - longest.first) / kControlRateHz));
  }
  const auto part = [&](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(longest.first),
                               values.begin() + static_cast<std::ptrdiff_t>(longest.end));
  };
  recording::Recording out;
  out.source = path;
  out.rate_hz = kControlRateHz;
  out.time_s = part(measured.time_s());
  for (const diagnosis::Channel& channel : measured.channels) {
    out.columns.push_back({channel.name, channel.unit, part(channel.values)});
  }
  return out;
}

void want_channels(const recording::Recording& record, const std::string& path) {
  constexpr std::size_t kLeast_s = 5;
  constexpr std::array<std::pair<const char*, const char*>, 3> kWanted{
      {{"theta", "rad"}, {"f", "N"}, {"f_motor", "N"}}};
  for (const auto& [name, unit] : kWanted) {
    const recording::Column* column = record.find(name);
    if (column == nullptr || column->unit != unit) {
      throw ConfigError(path,
                        column == nullptr ? fmt::format("no channel {}", name)
                                          : fmt::format("{} in {}", name, column->unit),
                        "theta [rad], f [N] and f_motor [N] of the stick");
    }
  }
  if (record.row_count() < kLeast_s * static_cast<std::size_t>(kControlRateHz)) {
    throw ConfigError(path, fmt::format("{} rows", record.row_count()),
                      fmt::format("{} s of the stick's motion at least", kLeast_s));
  }
}

// Why the canceller would not run a model, or empty.
std::string refused(const cancellation::ControlModel& model) {
  const auto check = cancellation::check_model(model, cancellation::bounds({}));
  if (check.refusal == cancellation::Refusal::kNone) return {};
  return "the canceller refuses it: " + std::string(cancellation::describe(check.refusal));
}

// What the caller chose, or the condition's letter.
std::string trial_at(const std::vector<std::string>& trials, std::size_t index,
                     const char* letter) {
  return index < trials.size() ? trials[index] : std::string(letter);
}

// A copy, or a part of it: so many samples of a measured signal do not repeat.
bool holds_start_of(const std::vector<double>& seen, const std::vector<double>& unseen) {
  constexpr std::size_t kSamples = 200;
  const auto start = std::span(unseen).first(std::min(unseen.size(), kSamples));
  return !std::ranges::search(seen, start).empty();
}

class RecordedLoopRun {
 public:
  explicit RecordedLoopRun(const RecordedOptions& options) : options_(options) {}

  RecordedLoop run() {
    step("reading");
    read_pegged();
    read_sticks(options_.moving, options_.moving_trials, "B", moving_);
    read_sticks(options_.cancelled, options_.cancelled_trials, "C", cancelled_);
    diagnose();
    convert_linear();
    if (out_.verdict.not_carried.empty()) {
      out_.verdict.not_carried = refused(out_.verdict.control.model);
    }
    if (!out_.verdict.not_carried.empty()) {
      for (Treatment& each : out_.verdict.control.treatments) {
        each.cancelled = false;
        each.how = "C+ does not run: " + out_.verdict.not_carried;
      }
    }
    for (const diagnosis::Measurement& record : unseen_) judge(record);
    const bool same =
        !out_.verdict.body.has_effect_that_counts() && out_.verdict.control.treatments.empty();
    out_.decision =
        decide(out_.judged, same, out_.no_motor.empty(), out_.verdict.not_carried.empty());
    return std::move(out_);
  }

 private:
  void step(const std::string& name) const {
    if (!options_.progress(name)) throw diagnosis::Interrupted();
  }

  void read_sticks(const std::vector<std::string>& paths, const std::vector<std::string>& trials,
                   const char* letter, std::vector<recording::Recording>& into) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      into.push_back(read_stick(paths[i], trial_at(trials, i, letter), options_.read, out_.notes));
      want_channels(into.back(), paths[i]);
    }
  }

  void read_pegged() {
    std::vector<diagnosis::Measurement> parts;
    for (std::size_t i = 0; i < options_.pegged.size(); ++i) {
      parts.push_back(
          read(options_.pegged[i], trial_at(options_.pegged_trials, i, "I"), options_.read));
    }
    for (const std::string& path : options_.unseen)
      unseen_.push_back(read(path, "I", options_.read));
    if (unseen_.empty() && parts.size() > 1) {
      unseen_.push_back(std::move(parts.back()));
      parts.pop_back();
    } else if (unseen_.empty()) {
      auto [seen, unseen] = split_off_end(parts.front(), kKeptApart);
      unseen.source += fmt::format(", the last {:.0f} %", 100.0 * kKeptApart);
      parts.front() = std::move(seen);
      unseen_.push_back(std::move(unseen));
    }
    refuse_copies(parts);
    pegged_ = parts.size() == 1 ? std::move(parts.front()) : measurement::join(std::move(parts));
    const diagnosis::Channel* output = pegged_.find(options_.diagnose.output);
    if (output == nullptr) {
      throw ConfigError(pegged_.source, "no channel " + options_.diagnose.output,
                        "--output with its name");
    }
    out_.unit = output->unit;
    out_.notes = pegged_.notes;
    for (const diagnosis::Measurement& record : unseen_) check_unseen(record);
  }

  // Under another name, too.
  void refuse_copies(const std::vector<diagnosis::Measurement>& seen) const {
    for (const diagnosis::Measurement& record : unseen_) {
      const diagnosis::Channel* own = record.find(options_.diagnose.output);
      for (const diagnosis::Measurement& part : seen) {
        const diagnosis::Channel* other = part.find(options_.diagnose.output);
        if (own == nullptr || other == nullptr || !holds_start_of(other->values, own->values)) {
          continue;
        }
        throw ConfigError(record.source, "the same samples as " + part.source,
                          "a record that no fit has seen");
      }
    }
  }

  void check_unseen(const diagnosis::Measurement& record) {
    std::vector<std::string> wanted = options_.diagnose.inputs;
    wanted.push_back(options_.diagnose.output);
    for (const std::string& name : wanted) {
      if (record.find(name) == nullptr) {
        throw ConfigError(record.source, "no channel " + name, "those of the first --pegged");
      }
    }
    for (const std::string& note : record.notes) {
      if (std::ranges::find(out_.notes, note) == out_.notes.end()) out_.notes.push_back(note);
    }
  }

  void diagnose() {
    diagnosis::DiagnoseOptions diagnose = options_.diagnose;
    diagnose.progress = [&](const std::string& what) {
      return options_.progress("diagnosis: " + what);
    };
    Evidence evidence{&pegged_};
    evidence.session_goes_on = false;  // the unseen records are of others
    for (const recording::Recording& record : moving_) evidence.moving.push_back(&record);
    for (const recording::Recording& record : cancelled_) evidence.cancelled.push_back(&record);
    out_.verdict = diagnose_all(evidence, options_.declared, diagnose);
  }

  // The linear model at the canceller's rate, for C next to C+.
  void convert_linear() {
    const auto carried = [](const std::string& name) {
      return std::ranges::any_of(cancellation::kChannelFacts,
                                 [&](const auto& facts) { return facts.name == name; });
    };
    if (out_.unit != "N" || !std::ranges::all_of(options_.diagnose.inputs, carried)) {
      out_.no_motor = "the canceller reads a_x, a_y, a_z, roll, theta and omega, and gives N";
      return;
    }
    const std::vector<std::string>& inputs = options_.diagnose.inputs;
    const diagnosis::Signals signals(diagnosis::working_set(pegged_, inputs), inputs,
                                     options_.diagnose.output);
    ControlOptions control;
    control.lead_s =
        out_.verdict.latency ? out_.verdict.latency->motor_s : options_.declared.motor_delay_s;
    try {
      out_.linear_control =
          to_control_model(out_.verdict.body.baseline.model, signals, control).model;
      out_.linear_not_carried = refused(*out_.linear_control);
    } catch (const ConfigError& error) {
      out_.linear_not_carried = error.what();
    }
    if (!out_.linear_not_carried.empty()) out_.linear_control.reset();
  }

  [[nodiscard]] bool verdict_runs() const {
    return out_.no_motor.empty() && out_.verdict.not_carried.empty();
  }

  // What the motor leaves; none for a record that ends before the model has settled.
  std::optional<Remaining> by_motor(const cancellation::ControlModel& model,
                                    const diagnosis::Measurement& record) {
    const double late_s = out_.verdict.latency
                              ? out_.verdict.latency->motor_s - options_.declared.motor_delay_s
                              : 0.0;
    // Both models are judged on the same samples.
    double from_s = 0.0;
    if (out_.linear_control) from_s = settled_after_s(*out_.linear_control);
    if (verdict_runs()) from_s = std::max(from_s, settled_after_s(out_.verdict.control.model));
    try {
      return left_by_motor(model, record, options_.diagnose.output, std::max(late_s, 0.0), from_s);
    } catch (const ConfigError& error) {
      out_.notes.push_back(fmt::format("{}: no motor was run: {}", record.source, error.what()));
      return std::nullopt;
    }
  }

  void judge(const diagnosis::Measurement& as_measured) {
    step("judging " + as_measured.source);
    const Verdict& verdict = out_.verdict;
    // A late load cell is late here, too.
    const diagnosis::Measurement record =
        advanced(as_measured, options_.diagnose.output,
                 verdict.cell_is_late ? verdict.latency->cell_s : 0.0);
    Judged judged;
    judged.source = std::filesystem::path(record.source).filename().string();
    judged.seconds = static_cast<double>(record.size()) / record.rate_hz;
    judged.linear =
        left_by_prediction(diagnosis::carried_as_it_is(verdict.body.baseline.model), record);
    judged.augmented = left_by_prediction(verdict.carried(), record);
    if (out_.linear_control) {
      judged.motor_linear = by_motor(*out_.linear_control, record);
    }
    if (verdict_runs()) {
      judged.motor_augmented = by_motor(verdict.control.model, record);
    }
    out_.judged.push_back(std::move(judged));
  }

  const RecordedOptions& options_;
  diagnosis::Measurement pegged_;
  std::vector<diagnosis::Measurement> unseen_;
  std::vector<recording::Recording> moving_;
  std::vector<recording::Recording> cancelled_;
  RecordedLoop out_;
};

}  // namespace

RecordedLoop close_recorded_loop(const RecordedOptions& options) {
  return RecordedLoopRun(options).run();
}

}  // namespace stillhand::close_the_loop
