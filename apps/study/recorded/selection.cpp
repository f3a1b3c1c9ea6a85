// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <span>

#include "apps/study/recorded/average.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::study {
namespace {

// The conditions that most people have.
std::vector<Condition> wanted_conditions(const std::vector<Person>& people) {
  std::map<Condition, std::size_t> count;
  for (const Person& person : people) {
    std::set<Condition> own;
    for (const RecordedTrial& trial : person.trials) own.insert(trial.condition);
    for (const Condition condition : own) ++count[condition];
  }
  std::vector<Condition> out;
  for (const auto& [condition, number] : count) {
    if (2 * number > people.size()) out.push_back(condition);
  }
  return out;
}

// Eq. SU-14: of the trials of one place of the plan, the last one.
std::vector<const RecordedTrial*> counted(const Person& person,
                                          std::span<const Condition> conditions) {
  std::vector<const RecordedTrial*> out;
  for (const RecordedTrial& trial : person.trials) {
    if (std::ranges::find(conditions, trial.condition) == conditions.end()) continue;
    std::erase_if(out, [&](const RecordedTrial* earlier) {
      return trial.step > 0 && earlier->step == trial.step;
    });
    out.push_back(&trial);
  }
  return out;
}

SubjectResult result_of(const Person& person, std::span<const Condition> conditions,
                        std::set<TrialId>& used) {
  SubjectResult out;
  out.identification = *person.identification;
  std::map<Condition, std::vector<const TrackedTrial*>> trials;
  for (const RecordedTrial* trial : counted(person, conditions)) {
    used.insert(id_of(*trial));
    if (trials[trial->condition].empty()) out.order.push_back(trial->condition);
    trials[trial->condition].push_back(&trial->tracked);
  }
  for (const auto& [condition, each] : trials) out.trials[condition] = averaged(each);
  return out;
}

// Conditions that too few people have.
std::vector<std::string> rare_conditions(const std::vector<Person>& people,
                                         std::span<const Condition> wanted) {
  std::map<Condition, std::set<std::string>> owners;
  for (const Person& person : people) {
    for (const RecordedTrial& trial : person.trials) owners[trial.condition].insert(person.code);
  }
  std::vector<std::string> out;
  for (const auto& [condition, codes] : owners) {
    if (std::ranges::find(wanted, condition) != wanted.end()) continue;
    out.push_back(fmt::format("condition {}: only {} of {} participants have it ({})",
                              name_of(condition), codes.size(), people.size(),
                              fmt::join(codes, ", ")));
  }
  return out;
}

// Who has fewer trials of a condition than is usual: the mean is over what is there.
std::vector<std::string> short_of_trials(const std::vector<Person>& people,
                                         const std::vector<std::string>& selected,
                                         std::span<const Condition> conditions) {
  std::vector<std::string> out;
  for (const Condition condition : conditions) {
    std::map<std::string, std::ptrdiff_t> own;
    std::map<std::ptrdiff_t, std::size_t> people_with;
    for (const Person& person : people) {
      if (std::ranges::find(selected, person.code) == selected.end()) continue;
      own[person.code] = std::ssize(counted(person, {&condition, 1}));
      ++people_with[own[person.code]];
    }
    if (people_with.size() < 2) continue;
    // Of as many people the larger number.
    const auto usual = std::ranges::max_element(people_with, [](const auto& a, const auto& b) {
      return std::pair(a.second, a.first) < std::pair(b.second, b.first);
    });
    for (const auto& [code, count] : own) {
      if (count >= usual->first) continue;
      out.push_back(fmt::format("{}: {} of the usual {} trials of condition {}; their mean counts",
                                code, count, usual->first, name_of(condition)));
    }
  }
  return out;
}

// Why a person cannot be in the tables, or empty.
std::string lacking(const Person& person, std::span<const Condition> conditions) {
  if (!person.identification) return "no complete pegged trial";
  for (const Condition condition : conditions) {
    if (std::ranges::find(person.trials, condition, &RecordedTrial::condition) ==
        person.trials.end()) {
      return fmt::format("no complete trial of condition {}", name_of(condition));
    }
  }
  return "";
}

// Completed share of the planned trials; a repetition does not stand for another condition.
double completed_share(const Person& person, const Registration& registration) {
  std::int64_t done = 0;
  for (const Condition condition : registration.conditions) {
    const auto own = std::ssize(counted(person, {&condition, 1}));
    done += std::min<std::int64_t>(own, registration.trials_a_condition);
  }
  const auto planned = static_cast<double>(registration.conditions.size()) *
                       static_cast<double>(registration.trials_a_condition);
  return static_cast<double>(done) / planned;
}

std::optional<double> dwell_ratio_a(const Person& person) {
  std::vector<double> ratios;
  for (const RecordedTrial* trial : counted(person, std::array{kA})) {
    ratios.push_back(trial->tracked.metrics.dwell_ratio);
  }
  if (ratios.empty()) return std::nullopt;
  return statistics::mean(ratios);
}

// The rule that excludes a person for what the person alone did, or empty.
std::string excluded_alone(const Person& person, const Registration& registration) {
  const experiment::Exclusion& rules = registration.rules;
  if (person.broken_trials > rules.most_broken_trials) {
    return fmt::format("{} trials ended early, more than most_broken_trials {}",
                       person.broken_trials, rules.most_broken_trials);
  }
  const double share = completed_share(person, registration);
  if (share < rules.least_completed_share) {
    return fmt::format("{:.4g} of the planned trials, less than least_completed_share {:.4g}",
                       share, rules.least_completed_share);
  }
  const auto dwell = dwell_ratio_a(person);
  if (dwell && *dwell < rules.least_dwell_ratio_a) {
    return fmt::format("mean dwell ratio {:.4g} in A, less than least_dwell_ratio_a {:.4g}", *dwell,
                       rules.least_dwell_ratio_a);
  }
  return "";
}

// {code: why} of those whose RMS error is too far from the others'.
std::map<std::string, std::string> outliers(const std::vector<Person>& people, double most) {
  std::map<std::string, std::string> out;
  const Selection all = select(people);
  if (!(most > 0.0) || all.results.size() < 2) return out;
  for (const auto& [condition, unused] : all.results.front().trials) {
    std::vector<double> errors_mm;
    for (const SubjectResult& result : all.results) {
      errors_mm.push_back(result.trials.at(condition).metrics.rms_error_mm);
    }
    const double mean_mm = statistics::mean(errors_mm);
    const double deviation_mm = statistics::standard_deviation(errors_mm);
    for (std::size_t i = 0; i < errors_mm.size(); ++i) {
      const double deviations = std::abs(errors_mm[i] - mean_mm) / deviation_mm;
      if (!(deviations > most)) continue;
      out.emplace(all.participants[i],
                  fmt::format("RMS error {:.4g} mm in {}, {:.3g} standard deviations from the "
                              "mean, more than most_rms_deviations {:.4g}",
                              errors_mm[i], name_of(condition), deviations, most));
    }
  }
  return out;
}

}  // namespace

Selection select(const std::vector<Person>& people) {
  Selection out;
  const std::vector<Condition> conditions = wanted_conditions(people);
  for (const Person& person : people) {
    const std::string why = conditions.empty() ? "no tracking trial" : lacking(person, conditions);
    if (!why.empty()) {
      out.left_out.push_back(fmt::format("{}: {}", person.code, why));
      continue;
    }
    out.participants.push_back(person.code);
    out.results.push_back(result_of(person, conditions, out.used));
  }
  std::ranges::copy(rare_conditions(people, conditions), std::back_inserter(out.remarks));
  std::ranges::copy(short_of_trials(people, out.participants, conditions),
                    std::back_inserter(out.remarks));
  return out;
}

std::vector<std::string> apply_rules(const Registration& registration,
                                     std::vector<Person>& people) {
  std::vector<std::string> lines;
  const double most_lost = registration.rules.most_lost_tick_share;
  for (Person& person : people) {
    std::erase_if(person.trials, [&](const RecordedTrial& trial) {
      if (!(trial.lost_share > most_lost)) return false;
      lines.push_back(fmt::format(
          "{}, session {}, trial {}: {:.4g} of its samples lost, more than most_lost_tick_share "
          "{:.4g}",
          person.code, trial.session, trial.number, trial.lost_share, most_lost));
      return true;
    });
  }
  std::erase_if(people, [&](const Person& person) {
    const std::string why = excluded_alone(person, registration);
    if (!why.empty()) lines.push_back(person.code + ": " + why);
    return !why.empty();
  });
  // Once: mean and deviation are those of everybody who is left by the other rules.
  const auto far = outliers(people, registration.rules.most_rms_deviations);
  std::erase_if(people, [&](const Person& person) {
    const auto found = far.find(person.code);
    if (found == far.end()) return false;
    lines.push_back(person.code + ": " + found->second);
    return true;
  });
  return lines;
}

}  // namespace stillhand::study
