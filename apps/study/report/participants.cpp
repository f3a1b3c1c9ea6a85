// SPDX-License-Identifier: Apache-2.0
#include "apps/study/report/participants.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace stillhand::study {
namespace {

std::string plain(const std::string& code) {
  std::string out;
  for (const char each : code) {
    const bool keeps =
        std::isalnum(static_cast<unsigned char>(each)) != 0 || each == '-' || each == '_';
    out += keeps && static_cast<unsigned char>(each) < 128 ? each : '_';
  }
  return out;
}

}  // namespace

std::map<std::string, std::string> participant_files(const RecordedSource& source) {
  std::map<std::string, std::string> out;
  std::set<std::string> taken;
  for (const RecordedTrial& trial : source.trials) {
    if (out.contains(trial.participant)) continue;
    const std::string stem = kParticipantPage + plain(trial.participant);
    std::string file = stem + kPageEnding;
    for (int n = 2; !taken.insert(file).second; ++n) {
      file = stem + "-" + std::to_string(n) + kPageEnding;
    }
    out[trial.participant] = file;
  }
  return out;
}

std::string state_of(const StudyRecord& record) {
  if (!record.recorded || !record.recorded->registered) return "";
  const experiment::Standing& standing = record.recorded->registered->registration.standing;
  std::string out = in_words(standing);
  for (const experiment::Entry& entry : standing.openings) {
    out += " " + in_words(entry, standing.planned());
  }
  return out;
}

std::vector<std::string> remarks_on(const RecordedSource& source, const std::string& code) {
  std::vector<std::string> out;
  const auto take = [&](const std::vector<std::string>& lines, const char* before) {
    for (const std::string& line : lines) {
      // "P05: excluded, ..." and "P04, session 01, trial 1: ..."
      const bool own = line.starts_with(code + ": ") || line.starts_with(code + ", session ");
      if (own) out.push_back(before + line.substr(code.size() + 2));
    }
  };
  take(source.left_out, "Left out: ");
  take(source.remarks, "");
  if (source.registered) take(source.registered->excluded, "Excluded by a rule: ");
  return out;
}

const SubjectResult* result_of(const StudyRecord& record, const std::string& code) {
  const RecordedSource& source = *record.recorded;
  const auto find = [&code](const std::vector<std::string>& participants,
                            const std::vector<SubjectResult>& results) -> const SubjectResult* {
    const auto found = std::ranges::find(participants, code);
    if (found == participants.end()) return nullptr;
    return &results[static_cast<std::size_t>(found - participants.begin())];
  };
  const SubjectResult* out = find(source.participants, record.results);
  if (out != nullptr || !source.registered) return out;
  return find(source.registered->without.participants, source.registered->without.results);
}

}  // namespace stillhand::study
