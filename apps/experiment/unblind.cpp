// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/unblind.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <istream>
#include <optional>

#include "apps/experiment/folder/sealed_assignment.hpp"
#include "apps/libraries/experiment/file/standing.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::experiment {
namespace {

void refuse_incomplete(const Standing& standing) {
  throw ConfigError(
      "unblind",
      fmt::format("{} of {} participants not complete: {}", standing.incomplete.size(),
                  standing.planned(), in_words(standing.incomplete)),
      "every participant complete or excluded (--participant opens one person alone, for that "
      "person's safety; --incomplete opens all)");
}

void confirm(const Folder& folder, const Standing& standing, std::istream& typed) {
  const auto path = std::filesystem::absolute(folder.path() / "").lexically_normal();
  const std::string name = path.parent_path().filename().string();
  if (isatty(STDIN_FILENO) == 1) {
    fmt::print(stderr,
               "{}\nThis shows the conditions of all participants, including those who are not "
               "complete. Type {} to continue: ",
               in_words(standing), name);
  }
  std::string line;
  std::getline(typed, line);
  if (line == name || line == folder.design().title) return;
  throw ConfigError("--incomplete", line.empty() ? "no line on standard input" : line,
                    name + " typed as confirmation, or piped in; nothing is opened");
}

}  // namespace

std::string unblind(const Folder& folder, const Unblinding& asked, std::istream& typed) {
  const Standing standing = standing_of(folder.path(), folder.design());
  std::optional<std::size_t> only;
  if (!asked.participant.empty()) {
    only = folder.with_session(asked.participant);
  } else if (!standing.incomplete.empty()) {
    if (!asked.incomplete) refuse_incomplete(standing);
    confirm(folder, standing, typed);
  }
  Journal journal(folder.path() / "journal.jsonl");
  journal.append({.kind = EntryKind::kUnblinded,
                  .text = asked.reason,
                  .participant = asked.participant,
                  .complete = static_cast<std::int64_t>(standing.complete.size())});
  const std::string text = opened_text(folder.design(), folder.assignment(), only);
  const auto place = only ? folder.participant(*only) : folder.path();
  recording::write_file(place / kOpenedFile, text);
  return text;
}

}  // namespace stillhand::experiment
