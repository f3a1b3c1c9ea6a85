// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/folder/folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/experiment/folder/sealed_assignment.hpp"
#include "apps/libraries/experiment/file/experiment_file.hpp"
#include "services/bus/recording/of_experiment.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/digest/digest.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::experiment {
namespace {

constexpr const char* kDigestFile = "experiment.sha256";

// A line of `sha256sum`.
std::string digest_line(const std::string& digest, const std::string& name) {
  return digest + "  " + name + "\n";
}

// A model that changed between two participants would be two conditions of one name.
void refuse_changed_model(const std::filesystem::path& file, const std::string& name,
                          const std::string& registered) {
  if (!std::filesystem::is_regular_file(file)) {
    throw ConfigError(file.string(), "no file",
                      "the model of condition C+, as the first participant had it");
  }
  const std::string digest = digest::sha256(recording::read_file(file.string()));
  if (registered.find(digest_line(digest, name)) != std::string::npos) return;
  if (registered.find("  " + name + "\n") == std::string::npos) {
    throw ConfigError(
        (file.parent_path() / kDigestFile).string(), "no line of " + name,
        "one: an older version began this experiment. If the model is unchanged, `sha256sum " +
            name + " >> " + kDigestFile + "` in that folder adds it");
  }
  throw ConfigError(file.string(), "SHA-256 " + digest.substr(0, 12) + "...",
                    "the one in experiment.sha256: the model of condition C+ changed after the "
                    "first participant; take the change back, or begin another experiment");
}

// Why a recording does not belong where it is; empty: it does.
std::string wrong_place(const std::filesystem::path& file,
                        const recording::OfExperiment& expected) {
  recording::FileSource source(file.string());
  recording::McapReader reader(source);
  const auto* record = reader.find_metadata(recording::kExperimentRecord);
  if (record == nullptr) return "a recording of no experiment";
  const auto text = [record](const char* key) {
    const auto found = record->texts.find(key);
    return found == record->texts.end() ? std::string() : found->second;
  };
  if (text("digest") != expected.digest) return "a recording of another experiment.yaml";
  if (text("participant") != expected.participant) {
    return "a recording of participant " + text("participant");
  }
  if (text("session") != expected.session) return "the recording of session " + text("session");
  return "";
}

// What a desktop, an office program, a store or a file system leaves in a folder that somebody
// looked at.
bool is_a_desktops(const std::string& name) {
  constexpr std::array<std::string_view, 8> kNames{
      "Thumbs.db",    "ehthumbs.db", "desktop.ini", "Icon\r",
      "$RECYCLE.BIN", "@eaDir",      "lost+found",  "System Volume Information"};
  return name.starts_with('.') || name.starts_with("~$") || name.ends_with('~') ||
         std::ranges::find(kNames, name) != kNames.end();
}

}  // namespace

Folder::Folder(std::filesystem::path path) : path_(std::move(path)) {
  const std::filesystem::path file = path_ / kDesignFile;
  if (!std::filesystem::is_regular_file(file)) {
    throw ConfigError(path_.string(), "a folder without experiment.yaml",
                      "a folder that `stillhand experiment new` made");
  }
  const std::string yaml = registered_text(path_);
  digest_ = digest::sha256(yaml);
  const std::string registered = recording::read_file((path_ / kDigestFile).string());
  if (!registered.starts_with(digest_) && !participants().empty()) {
    throw ConfigError(file.string(), "SHA-256 " + digest_.substr(0, 12) + "...",
                      registered.substr(0, 12) +
                          "...: the pre-registration changed after the first participant; take "
                          "the change back, or begin another experiment");
  }
  design_ = design_of(yaml, file.string());
  if (const std::string model = design_.model_file(); !model.empty() && !participants().empty()) {
    refuse_changed_model(path_ / model, model, registered);
  }
  const std::string sealed = recording::read_file((path_ / kSealedFile).string());
  if (digest::sha256(sealed) != design_.assignment) {
    throw ConfigError((path_ / kSealedFile).string(), "another content than at the beginning",
                      "the file of this experiment: its SHA-256 is in experiment.yaml");
  }
  assignment_ = {order_seed_of(sealed, (path_ / kSealedFile).string())};
}

bool Folder::unblinded() const { return std::filesystem::exists(path_ / kOpenedFile); }

std::vector<std::size_t> Folder::participants() const {
  constexpr std::int64_t kMost = 999;
  std::vector<std::size_t> indices;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(path_ / "participants", error)) {
    const std::string name = entry.path().filename().string();
    if (is_a_desktops(name)) continue;
    try {
      indices.push_back(participant_index(name, kMost));
    } catch (const ConfigError&) {
      throw ConfigError(entry.path().string(), "a folder of no participant",
                        "P01, P02, ...: each code once, and no other name");
    }
  }
  std::ranges::sort(indices);
  return indices;
}

std::filesystem::path Folder::participant(std::size_t index) const {
  return path_ / "participants" / participant_code(index);
}

std::filesystem::path Folder::journal(std::size_t index) const {
  return participant(index) / "journal.jsonl";
}

std::filesystem::path Folder::session(std::size_t index, std::int64_t number) const {
  return participant(index) / "sessions" / fmt::format("{:02}", number);
}

std::filesystem::path Folder::next_planned(std::size_t index) const {
  for (int number = 1;; ++number) {
    auto path = participant(index) / "planned" / fmt::format("{:02}", number);
    if (!std::filesystem::exists(path)) return path;
  }
}

Plan Folder::plan(std::size_t index) const { return plan_of(design_, assignment_, index); }

std::size_t Folder::with_session(const std::string& code) const {
  const std::size_t index = participant_index(code, design_.participants);
  if (std::filesystem::exists(journal(index))) return index;
  throw ConfigError("--participant", code + ", who has no session", "a participant with a journal");
}

std::vector<std::string> Folder::findings(std::size_t index,
                                          const std::vector<Entry>& entries) const {
  std::vector<std::string> found;
  std::set<std::int64_t> with_trial;
  std::int64_t sessions = 0;
  for (const Entry& entry : entries) {
    if (entry.kind == EntryKind::kTrialEnded && entry.completed) with_trial.insert(entry.session);
    if (entry.kind == EntryKind::kSessionBegan) ++sessions;
  }
  for (std::int64_t number = 1; number <= sessions; ++number) {
    const std::filesystem::path file = session(index, number) / "session.mcap";
    if (!std::filesystem::exists(file)) {
      if (with_trial.contains(number)) {
        found.push_back(file.string() + ": missing, but the journal has trials of it");
      }
      continue;
    }
    const std::string why =
        wrong_place(file, {participant_code(index), digest_, fmt::format("{:02}", number)});
    if (!why.empty()) found.push_back(file.string() + ": " + why);
  }
  std::error_code error;
  for (const auto& entry :
       std::filesystem::directory_iterator(participant(index) / "sessions", error)) {
    const std::string name = entry.path().filename().string();
    const bool known = is_a_desktops(name) || std::ranges::any_of(entries, [&](const Entry& each) {
                         return fmt::format("{:02}", each.session) == name;
                       });
    if (!known)
      found.push_back(entry.path().string() + ": a session that the journal does not know");
  }
  return found;
}

std::string Folder::opening_finding() const {
  const std::string opened = (path_ / kOpenedFile).string();
  if (!unblinded() || recording::read_file(opened) == opened_text(design_, assignment_)) return "";
  return opened +
         ": differs from assignment.sealed; `stillhand experiment unblind` writes it again";
}

void Folder::refuse_findings() const {
  if (const std::string finding = opening_finding(); !finding.empty()) {
    throw ConfigError("assignment.json", finding, "what unblinding wrote");
  }
  for (const std::size_t index : participants()) {
    for (const std::string& finding : findings(index, read_journal(journal(index)))) {
      throw ConfigError(participant_code(index), finding, "the folder as the sessions left it");
    }
  }
}

void Folder::register_design() const {
  std::string lines = digest_line(digest_, kDesignFile);
  if (const std::string model = design_.model_file(); !model.empty()) {
    const std::string bytes = recording::read_file((path_ / model).string());
    lines += digest_line(digest::sha256(bytes), model);
  }
  recording::write_file(path_ / kDigestFile, lines);
}

void Folder::open_participant(std::size_t index) const {
  if (participants().empty()) register_design();
  std::filesystem::create_directories(participant(index));
}

void make_folder(const std::filesystem::path& path, Design design, std::uint64_t order_seed) {
  std::error_code error;
  if (std::filesystem::exists(path) && !std::filesystem::is_empty(path, error)) {
    throw ConfigError(path.string(), "a folder that holds something",
                      "a new folder, or an empty one");
  }
  std::filesystem::create_directories(path / "participants", error);
  if (error) throw ConfigError(path.string(), error.message(), "a folder that can be made");
  const std::string sealed = sealed_text(order_seed);
  design.assignment = digest::sha256(sealed);
  const std::string yaml = yaml_of(design);
  try {
    recording::write_file(path / kSealedFile, sealed);
    recording::write_file(path / kDigestFile, digest_line(digest::sha256(yaml), kDesignFile));
    recording::write_file(path / kDesignFile, yaml);  // last: it makes the folder an experiment
  } catch (...) {
    // A disk that was full: the same line finds an empty folder once there is room.
    for (const char* name : {kSealedFile, kDigestFile, "participants"}) {
      std::filesystem::remove(path / name, error);
    }
    throw;
  }
}

}  // namespace stillhand::experiment
