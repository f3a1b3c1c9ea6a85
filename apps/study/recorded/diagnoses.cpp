// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/diagnoses.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <set>
#include <tuple>

#include "apps/study/recorded/whose.hpp"
#include "apps/study/subjects/conditions.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::study {
namespace {

using close_the_loop::RecordedLoop;
using close_the_loop::RecordedOptions;

// Where a session of a participant is.
std::string path_of(const std::vector<SessionFile>& files, const std::string& participant,
                    const std::string& session) {
  for (const SessionFile& file : files) {
    if (file.participant == participant && file.session == session) return file.path.string();
  }
  return "";
}

const RecordedTrial* last_of(const RecordedSource& source, const std::string& code,
                             Condition condition) {
  const RecordedTrial* out = nullptr;
  for (const RecordedTrial& trial : source.trials) {
    if (trial.participant == code && trial.condition == condition) out = &trial;
  }
  return out;
}

RecordedOptions recordings_of(const std::vector<SessionFile>& files, const RecordedSource& source,
                              const std::string& code) {
  RecordedOptions out;
  const auto add = [&](const std::string& session, std::int64_t number,
                       std::vector<std::string>& paths, std::vector<std::string>& trials) {
    paths.push_back(path_of(files, code, session));
    trials.push_back(std::to_string(number));
  };
  for (const PeggedTrial& pegged : source.pegged) {
    if (pegged.participant != code) continue;
    add(pegged.session, pegged.number, out.pegged, out.pegged_trials);
  }
  if (const RecordedTrial* moving = last_of(source, code, kB)) {
    add(moving->session, moving->number, out.moving, out.moving_trials);
  }
  for (const Condition condition : kCancelling) {
    const RecordedTrial* trial = last_of(source, code, condition);
    if (trial == nullptr) continue;
    add(trial->session, trial->number, out.cancelled, out.cancelled_trials);
    break;
  }
  return out;
}

// The note of a record that no motor ran over, without the record's name before it.
std::string reason_in(const std::string& note) {
  const std::string before = ": no motor was run: ";
  const std::size_t at = note.find(before);
  return at == std::string::npos ? note : note.substr(at + before.size());
}

PersonDiagnosis diagnosis_of(RecordedLoop loop) {
  PersonDiagnosis out;
  out.verdict = loop.verdict.conclusion();
  out.detectable_body_n = close_the_loop::detectable_n(loop.verdict, false);
  out.detectable_drive_n = close_the_loop::detectable_n(loop.verdict, true);
  out.findings = std::move(loop.verdict.findings);
  std::erase_if(out.findings, [](const close_the_loop::Finding& each) { return !each.counts; });
  close_the_loop::Judged& judged = loop.judged.back();
  out.unseen_s = judged.seconds;
  out.by_linear = std::move(judged.motor_linear);
  out.by_augmented = std::move(judged.motor_augmented);
  if (!out.by_linear || !out.by_augmented) {
    out.not_replayed = !loop.no_motor.empty()              ? loop.no_motor
                       : !loop.linear_not_carried.empty()  ? loop.linear_not_carried
                       : !loop.verdict.not_carried.empty() ? loop.verdict.not_carried
                       : !loop.notes.empty()               ? reason_in(loop.notes.back())
                                                           : "no motor was run";
  }
  return out;
}

// What became of one participant.
struct Outcome {
  std::optional<PersonDiagnosis> diagnosis;
  std::string failed;
};

Outcome diagnose_person(RecordedOptions options, const std::atomic<bool>& stopped) {
  if (options.pegged.empty()) return {std::nullopt, "no complete pegged trial"};
  options.progress = [&stopped](const std::string&) { return !stopped.load(); };
  try {
    return {diagnosis_of(close_the_loop::close_recorded_loop(options)), ""};
  } catch (const diagnosis::Interrupted&) {
    return {std::nullopt, "interrupted"};
  } catch (const std::exception& error) {
    return {std::nullopt, error.what()};
  }
}

std::optional<statistics::TTest> gain_over(const std::map<std::string, PersonDiagnosis>& people) {
  std::vector<double> by_linear;
  std::vector<double> by_augmented;
  for (const auto& [code, person] : people) {
    if (!person.gain_n()) continue;
    by_linear.push_back(person.by_linear->left.rms);
    by_augmented.push_back(person.by_augmented->left.rms);
  }
  if (by_linear.size() < 2) return std::nullopt;
  try {
    return statistics::paired_t_test(by_augmented, by_linear);
  } catch (const ConfigError&) {
    return std::nullopt;  // no variance: nobody's model changed
  }
}

// In whom the effect was found, or could have been.
std::size_t able_of(const std::map<std::string, PersonDiagnosis>& people,
                    const RecurringEffect& effect) {
  std::size_t count = effect.participants.size();
  for (const auto& [code, person] : people) {
    if (std::ranges::find(effect.participants, code) != effect.participants.end()) continue;
    const bool of_drive = effect.where == close_the_loop::kDrive;
    const double least_n = of_drive ? person.detectable_drive_n : person.detectable_body_n;
    if (effect.explained_n >= least_n) ++count;
  }
  return count;
}

}  // namespace

std::optional<double> PersonDiagnosis::gain_n() const {
  if (!by_linear || !by_augmented) return std::nullopt;
  return by_linear->left.rms - by_augmented->left.rms;
}

std::vector<RecurringEffect> recurring_in(const std::map<std::string, PersonDiagnosis>& people) {
  using Key = std::tuple<std::string, std::string, std::string>;
  std::map<Key, RecurringEffect> found;
  std::map<Key, std::vector<double>> forces;
  for (const auto& [code, person] : people) {
    std::set<Key> own;
    for (const close_the_loop::Finding& finding : person.findings) {
      const Key key{finding.kind, finding.channel, finding.where};
      if (!own.insert(key).second) continue;  // a person counts once
      RecurringEffect& effect = found[key];
      effect.kind = finding.kind;
      effect.channel = finding.channel;
      effect.where = finding.where;
      effect.participants.push_back(code);
      forces[key].push_back(finding.explained_n);
    }
  }
  std::vector<RecurringEffect> out;
  for (auto& [key, effect] : found) {
    effect.explained_n = statistics::median(forces[key]);
    effect.able = able_of(people, effect);
    effect.whose = whose(effect.participants.size(), effect.able);
    out.push_back(std::move(effect));
  }
  std::ranges::stable_sort(out, [](const RecurringEffect& a, const RecurringEffect& b) {
    return std::pair(a.participants.size(), a.explained_n) >
           std::pair(b.participants.size(), b.explained_n);
  });
  return out;
}

Diagnoses diagnose_people(const std::vector<SessionFile>& files, const RecordedSource& source,
                          unsigned threads, const OnProgress& on_progress) {
  const std::vector<std::string>& codes = source.participants;
  std::vector<Outcome> outcomes(codes.size());
  std::atomic<bool> stopped = false;
  const auto job = [&](std::size_t i) {
    outcomes[i] = diagnose_person(recordings_of(files, source, codes[i]), stopped);
  };
  const auto on_done = [&](std::size_t done) {
    const bool goes_on =
        on_progress(static_cast<std::int64_t>(done), static_cast<std::int64_t>(codes.size()));
    if (!goes_on) stopped = true;
    return goes_on;
  };
  const unsigned count = threads > 0 ? threads : runtime::core_count();
  if (!runtime::run_jobs(codes.size(), count, job, on_done)) throw Interrupted();
  Diagnoses out;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (outcomes[i].diagnosis) {
      out.people[codes[i]] = std::move(*outcomes[i].diagnosis);
    } else {
      out.failed[codes[i]] = outcomes[i].failed;
    }
  }
  out.recurring = recurring_in(out.people);
  out.gain = gain_over(out.people);
  return out;
}

}  // namespace stillhand::study
