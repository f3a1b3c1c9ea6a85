// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/experiment/file/standing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "apps/libraries/experiment/file/journal.hpp"

namespace stillhand::experiment {

Standing standing_of(const std::filesystem::path& folder, const Design& design) {
  Standing out;
  for (std::size_t index = 0; index < static_cast<std::size_t>(design.participants); ++index) {
    const std::string code = participant_code(index);
    const Plan plan = plan_of(design, {}, index);
    Progress progress(design, plan);
    for (const Entry& entry : read_journal(folder / "participants" / code / "journal.jsonl")) {
      progress.take(entry);
    }
    if (!progress.excluded().empty()) {
      out.excluded.emplace_back(code, progress.excluded());
    } else if (progress.complete()) {
      out.complete.push_back(code);
    } else {
      out.incomplete.emplace_back(
          code, progress.sessions() == 0
                    ? "not begun"
                    : fmt::format("{} of {} trials", progress.trials_done(), trials_of(plan)));
    }
  }
  std::ranges::copy_if(read_journal(folder / "journal.jsonl"), std::back_inserter(out.openings),
                       [](const Entry& each) { return each.kind == EntryKind::kUnblinded; });
  return out;
}

std::string in_words(const std::vector<std::pair<std::string, std::string>>& participants) {
  std::string out;
  for (const auto& [code, what] : participants) {
    out += fmt::format("{}{} ({})", out.empty() ? "" : ", ", code, what);
  }
  return out;
}

std::string in_words(const Standing& standing) {
  const auto part = [](const auto& participants, const char* what) {
    return participants.empty()
               ? std::string()
               : fmt::format("; {} {}: {}", participants.size(), what, in_words(participants));
  };
  return fmt::format("{} of {} participants complete", standing.complete.size(),
                     standing.planned()) +
         part(standing.excluded, "excluded") + part(standing.incomplete, "not complete") + ".";
}

std::string in_words(const Entry& opening, std::size_t planned) {
  const std::string who =
      opening.participant.empty() ? "All conditions were" : opening.participant + " alone was";
  const std::string state = opening.complete ? fmt::format(", with {} of {} participants complete",
                                                           *opening.complete, planned)
                                             : "";
  return fmt::format("{} unblinded at {}{}: {}.", who, opening.time, state, opening.text);
}

}  // namespace stillhand::experiment
