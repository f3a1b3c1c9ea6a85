// SPDX-License-Identifier: Apache-2.0
#include "apps/study/recorded/find_sessions.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "apps/libraries/experiment/file/experiment_file.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/experiment_record.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFileName = "session.mcap";

std::vector<fs::path> folders_in(const fs::path& parent) {
  std::vector<fs::path> out;
  if (!fs::is_directory(parent)) return out;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent)) {
    if (entry.is_directory()) out.push_back(entry.path());
  }
  std::ranges::sort(out);
  return out;
}

std::vector<fs::path> session_folders(const fs::path& folder) {
  if (!fs::is_directory(folder / "participants")) return {folder};
  // The tables name the conditions (apps/experiment/README.md, "The folder").
  if (fs::exists(folder / "experiment.yaml") && !fs::exists(folder / "assignment.json")) {
    throw ConfigError(folder.string(), "an experiment that is still blinded",
                      "`" + experiment::command_for("unblind", folder) + "` first");
  }
  std::vector<fs::path> out;
  for (const fs::path& participant : folders_in(folder / "participants")) {
    std::ranges::copy(folders_in(participant / "sessions"), std::back_inserter(out));
  }
  if (out.empty()) {
    throw ConfigError(folder.string(), "an experiment without a session",
                      "participants/*/sessions/*/" + std::string(kFileName));
  }
  return out;
}

// "01" of a folder, also of "01/".
std::string name_of(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

std::string text_of(const recording::Metadata& metadata, const std::string& key) {
  for (const auto& [name, text] : metadata.texts) {
    if (name == key) return text;
  }
  return "";
}

SessionFile session_file(const fs::path& folder) {
  SessionFile out{folder / kFileName, name_of(folder), "1", "", ""};
  if (!fs::is_regular_file(out.path)) {
    throw ConfigError(folder.string(), std::string("a folder without ") + kFileName,
                      "the folder of a session, or of an experiment");
  }
  recording::FileSource file(out.path.string());
  const recording::McapReader reader(file);
  if (!reader.status().ok()) {
    throw ConfigError(out.path.string(), reader.status().text, "an MCAP recording of a session");
  }
  if (const recording::Metadata* metadata = reader.find_metadata(recording::kExperimentRecord)) {
    out.participant = text_of(*metadata, "participant");
    out.session = text_of(*metadata, "session");
    out.digest = text_of(*metadata, "digest");
    if (out.participant.empty() || out.session.empty()) {
      throw ConfigError(out.path.string(),
                        std::string(recording::kExperimentRecord) + " without its keys",
                        "the keys participant, session and digest");
    }
  }
  return out;
}

// The reason of the journal's line "excluded" (apps/experiment/README.md, "The journal"), or empty.
std::string exclusion_of(const fs::path& participant) {
  std::ifstream journal(participant / "journal.jsonl");
  std::string reason;
  for (std::string line; std::getline(journal, line);) {
    // A crash may have cut the last line.
    const auto entry = nlohmann::json::parse(line, nullptr, false);
    const auto text = [&entry](const char* key) -> std::string {
      const auto found = entry.find(key);
      return found != entry.end() && found->is_string() ? *found : "";
    };
    if (text("what") != "excluded") continue;
    reason = text("text").empty() ? "without a reason" : text("text");
  }
  return reason;
}

// Of an experiment's folder: .../CODE/sessions/01.  A recording that does not state its participant
// has the folder's.
void of_participant(const fs::path& session, SessionFile& file) {
  const fs::path participant = session.parent_path().parent_path();
  const std::string code = name_of(participant);
  file.excluded = exclusion_of(participant);
  if (file.digest.empty()) {
    file.participant = code;
    file.session = name_of(session);
  } else if (file.participant != code) {
    throw ConfigError(file.path.string(), "a recording of participant " + file.participant,
                      "one of " + code + ", whose folder it is in");
  }
}

void check_together(const SessionFile& one, const SessionFile& next) {
  if (one.participant == next.participant && one.session == next.session) {
    throw ConfigError(next.path.string(),
                      "participant " + next.participant + ", session " + next.session + ", as in " +
                          one.path.string(),
                      "each session once, and each code for one participant");
  }
  if (one.digest != next.digest) {
    throw ConfigError(next.path.string(), "another experiment than " + one.path.string(),
                      "recordings of one experiment, with one pre-registration");
  }
}

}  // namespace

std::vector<SessionFile> find_sessions(const std::vector<fs::path>& folders) {
  std::vector<SessionFile> out;
  for (const fs::path& folder : folders) {
    for (const fs::path& session : session_folders(folder)) {
      out.push_back(session_file(session));
      if (session != folder) of_participant(session, out.back());
    }
  }
  std::ranges::sort(
      out, {}, [](const SessionFile& file) { return std::tuple(file.participant, file.session); });
  for (std::size_t i = 1; i < out.size(); ++i) check_together(out[i - 1], out[i]);
  return out;
}

}  // namespace stillhand::study
