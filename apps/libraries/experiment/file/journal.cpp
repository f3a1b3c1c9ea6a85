// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/experiment/file/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/json_entry.hpp"

namespace stillhand::experiment {
namespace {

constexpr std::array<std::pair<const char*, EntryKind>, 10> kKinds{
    {{"session began", EntryKind::kSessionBegan},
     {"trial began", EntryKind::kTrialBegan},
     {"trial ended", EntryKind::kTrialEnded},
     {"question answered", EntryKind::kQuestionAnswered},
     {"break over", EntryKind::kBreakOver},
     {"repeat asked", EntryKind::kRepeatAsked},
     {"note", EntryKind::kNote},
     {"session ended", EntryKind::kSessionEnded},
     {"excluded", EntryKind::kExcluded},
     {"unblinded", EntryKind::kUnblinded}}};

EntryKind kind_of(const settings::JsonEntry& entry) {
  for (const auto& [name, kind] : kKinds) {
    if (entry.text() == name) return kind;
  }
  entry.refuse("a kind of entry, for example \"trial ended\"");
}

Entry entry_of(const std::string& line, const std::string& place) {
  const auto json = settings::parsed_json(line, place, "a line of a journal of stillhand");
  const settings::JsonEntry root(json, place);
  root.allow_only({"time", "what", "session", "step", "trial", "label", "completed", "dwell_ratio",
                   "answer", "digest", "text", "participant", "complete"});
  Entry entry;
  entry.kind = kind_of(root.at("what"));
  entry.time = root.at("time").text();
  if (root.has("session")) entry.session = root.at("session").whole();
  if (root.has("step")) entry.step = root.at("step").whole();
  if (root.has("trial")) entry.trial = root.at("trial").whole();
  if (root.has("label")) entry.label = root.at("label").text();
  if (root.has("completed")) entry.completed = root.at("completed").boolean();
  if (root.has("dwell_ratio")) entry.dwell_ratio = root.at("dwell_ratio").number();
  if (root.has("answer")) entry.answer = root.at("answer").whole();
  if (root.has("digest")) entry.digest = root.at("digest").text();
  if (root.has("text")) entry.text = root.at("text").text();
  if (root.has("participant")) entry.participant = root.at("participant").text();
  if (root.has("complete")) entry.complete = root.at("complete").whole();
  // An older version wrote a note.
  if (constexpr std::string_view kNoted = "unblinded: ";
      entry.kind == EntryKind::kNote && entry.text.starts_with(kNoted)) {
    entry.kind = EntryKind::kUnblinded;
    entry.text.erase(0, kNoted.size());
  }
  return entry;
}

[[noreturn]] void refuse_write(const std::filesystem::path& file) {
  throw std::runtime_error(file.string() + ": " + std::generic_category().message(errno));
}

}  // namespace

std::string line_of(const Entry& entry) {
  nlohmann::ordered_json json{{"time", entry.time}};
  json["what"] = kKinds.at(static_cast<std::size_t>(entry.kind)).first;
  if (entry.session > 0) json["session"] = entry.session;
  if (entry.step >= 0) json["step"] = entry.step;
  if (entry.trial >= 0) json["trial"] = entry.trial;
  if (!entry.label.empty()) json["label"] = entry.label;
  const bool ends = entry.kind == EntryKind::kTrialEnded || entry.kind == EntryKind::kSessionEnded;
  if (ends) json["completed"] = entry.completed;
  if (entry.dwell_ratio) json["dwell_ratio"] = *entry.dwell_ratio;
  if (entry.answer > 0) json["answer"] = entry.answer;
  if (!entry.digest.empty()) json["digest"] = entry.digest;
  if (!entry.participant.empty()) json["participant"] = entry.participant;
  if (entry.complete) json["complete"] = *entry.complete;
  if (!entry.text.empty()) json["text"] = entry.text;
  // Bytes that are no UTF-8 come from the network: they must not break the journal.
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::vector<Entry> entries_of(const std::string& text, const std::string& origin) {
  std::vector<Entry> entries;
  std::size_t from = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', from)) {
    entries.push_back(
        entry_of(text.substr(from, end - from), fmt::format("{}:{}", origin, entries.size() + 1)));
    from = end + 1;
  }
  return entries;
}

std::vector<Entry> read_journal(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return {};
  return entries_of(recording::read_file(file.string()), file.string());
}

Journal::Journal(const std::filesystem::path& file) : file_(file) {
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor_ < 0) {
    throw ConfigError(file.string(), std::generic_category().message(errno),
                      "a journal that can be written");
  }
  try {
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      throw ConfigError(file.string(), "a journal that another process writes",
                        "one `stillhand experiment` for each participant");
    }
    const std::string text = recording::read_file(file.string());
    entries_ = entries_of(text, file.string());
    whole_ = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
    if (whole_ < text.size()) cut();
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

Journal::~Journal() { close(descriptor_); }

void Journal::cut() {
  if (ftruncate(descriptor_, static_cast<off_t>(whole_)) != 0) refuse_write(file_);
}

const Entry& Journal::append(Entry entry) {
  entry.time = utc_now();
  const std::string line = line_of(entry) + "\n";
  cut();
  std::uint64_t written = 0;
  const recording::Status status =
      recording::write_all(descriptor_, file_.string(), std::as_bytes(std::span(line)), written);
  if (!status.ok()) {
    cut();
    throw std::runtime_error(status.text);
  }
  if (fsync(descriptor_) != 0) refuse_write(file_);
  whole_ += written;
  entries_.push_back(std::move(entry));
  return entries_.back();
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace stillhand::experiment
