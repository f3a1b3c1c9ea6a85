// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/output_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure_table.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::lab {
namespace {

// Everything that a session or the closed loop writes, except logs: a reader would take a report
// of an earlier session for one of the new recording.
constexpr const char* kResults[]{"session.mcap",
                                 "summary.json",
                                 "model.json",
                                 "session.html",
                                 "screen.avi",
                                 "report.html",
                                 "undeclared_effect.json",
                                 "undeclared_effect.sha256",
                                 "control_model.json",
                                 "verdict.json"};
constexpr const char* kFigures[]{"session", "tracking", "force", "adaptation",
                                 "motion",  "left",     "repair"};

std::vector<std::filesystem::path> session_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  // In the folder itself, and of a diagnosis between two trials.
  for (const std::filesystem::path& place : {folder, folder / kClosingFolder}) {
    for (const char* name : kResults) files.push_back(place / name);
    for (const char* figure : kFigures) {
      for (const std::string& name : report::figure_files(figure)) files.push_back(place / name);
    }
  }
  for (const std::string_view service : topics::kServices) {
    files.push_back(folder / "logs" / (std::string(service) + ".log"));
  }
  // Of a session over several machines: the profiles, and the lines of each host.
  files.push_back(folder / "logs" / "profiles.xml");
  files.push_back(folder / "logs" / "closing.log");
  std::error_code error;
  // Of a session with a drawn subject: its settings.
  for (const auto& entry : std::filesystem::directory_iterator(folder / "logs" / "config", error)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder / "logs", error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("host_") && name.ends_with(".log")) files.push_back(entry.path());
  }
  return files;
}

}  // namespace

OutputFolder::OutputFolder(const std::filesystem::path& path,
                           const std::vector<std::filesystem::path>& inputs)
    : path_(path), earlier_(path / ".earlier-session") {
  make();
  bool locked = false;
  try {
    prove_writable();
    lock();
    locked = true;
    for (const std::filesystem::path& input : inputs) refuse_if_needed(input);
    bring_back();  // of a lab that was killed
    if (std::error_code unseen; std::filesystem::exists(earlier_, unseen)) {
      throw ConfigError("--out", earlier_.string() + ", which cannot be moved out of the way",
                        "a folder in which an earlier session can be kept");
    }
    set_aside();
    clear();
    std::error_code error;
    std::filesystem::create_directories(path_ / "logs", error);
    if (error || !std::filesystem::is_directory(path_ / "logs")) {
      throw ConfigError("--out", path_.string() + ", in which logs is no folder",
                        "a folder whose logs can be written");
    }
    for (const std::filesystem::path& file : session_files(path_)) {
      if (std::filesystem::exists(std::filesystem::symlink_status(file, error))) {
        throw ConfigError("--out", file.string() + ", which is in the way",
                          "a folder of an earlier session, or an empty one");
      }
    }
  } catch (...) {
    if (locked) bring_back();  // otherwise they wait for the lab that has the lock
    close(descriptor_);
    std::error_code error;
    if (made_) std::filesystem::remove(path_, error);
    throw;
  }
}

OutputFolder::~OutputFolder() {
  keep_earlier();
  close(descriptor_);
}

void OutputFolder::make() {
  std::error_code error;
  made_ = std::filesystem::create_directories(path_, error);
  if (error || !std::filesystem::is_directory(path_, error)) {
    throw ConfigError(
        "--out", (path_.empty() ? "\"\"" : path_.string()) + (error ? ": " + error.message() : ""),
        "a folder that can be made and written");
  }
}

void OutputFolder::prove_writable() const {
  const std::filesystem::path probe = path_ / ".stillhand-probe";
  std::error_code error;
  std::filesystem::remove(probe,
                          error);  // a link of that name may lead to a file of another program
  std::ofstream file(probe);
  file << "probe";
  file.close();  // a full disk shows here at the latest
  const bool written = file.good();
  std::filesystem::remove(probe, error);
  if (!written) {
    throw ConfigError("--out", path_.string() + ", which cannot be written",
                      "a folder with write permission and room");
  }
}

// A lock on the folder itself: nothing stays behind however the process ends.
void OutputFolder::lock() {
  descriptor_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    throw ConfigError("--out", path_.string() + ", where another lab writes",
                      "a folder of its own for each lab");
  }
}

void OutputFolder::refuse_if_needed(const std::filesystem::path& input) const {
  if (input.empty()) return;
  for (const std::filesystem::path& file : session_files(path_)) {
    std::error_code error;
    if (std::filesystem::equivalent(file, input, error)) {
      throw ConfigError("--out",
                        path_.string() + ", whose " + file.filename().string() +
                            " is read by this session and would be replaced",
                        "another folder");
    }
  }
}

void OutputFolder::discard() {
  clear();
  bring_back();
  std::error_code error;
  if (made_) std::filesystem::remove(path_, error);
}

void OutputFolder::set_aside() const {
  std::error_code error;
  for (const std::filesystem::path& file : session_files(path_)) {
    if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, error))) continue;
    const std::filesystem::path to = earlier_ / file.lexically_relative(path_);
    std::filesystem::create_directories(to.parent_path(), error);
    std::filesystem::rename(file, to, error);
  }
}

// Where a newer session left files, the earlier one's are not mixed with them.
void OutputFolder::bring_back() const {
  std::error_code error;
  const auto exists = [&error](const std::filesystem::path& file) {
    return std::filesystem::exists(file, error);
  };
  if (std::ranges::any_of(session_files(path_), exists)) return keep_earlier();
  for (const std::filesystem::path& file : session_files(earlier_)) {
    const std::filesystem::path to = path_ / file.lexically_relative(earlier_);
    if (!exists(file)) continue;
    std::filesystem::create_directories(to.parent_path(), error);
    std::filesystem::rename(file, to, error);
  }
  for (const char* folder : {"logs/config", "logs", kClosingFolder, ""}) {
    std::filesystem::remove(earlier_ / folder, error);
  }
}

// A person's data: they stay, whatever is written next to them.
void OutputFolder::keep_earlier() const {
  std::error_code error;
  if (!std::filesystem::exists(earlier_, error)) return;
  for (int number = 1; !error; ++number) {
    const std::filesystem::path to = path_ / ("earlier-" + std::to_string(number));
    if (std::filesystem::exists(std::filesystem::symlink_status(to, error))) continue;
    std::filesystem::rename(earlier_, to, error);
    return;
  }
}

void OutputFolder::clear() const {
  std::error_code error;
  for (const std::filesystem::path& file : session_files(path_)) {
    if (!std::filesystem::is_directory(file, error)) std::filesystem::remove(file, error);
  }
  const std::filesystem::path logs = path_ / "logs";
  if (std::filesystem::is_directory(logs, error)) {
    if (std::filesystem::is_directory(logs / "config", error)) {
      std::filesystem::remove(logs / "config", error);
    }
    std::filesystem::remove(logs, error);  // unless it holds something else
  }
  std::filesystem::remove(path_ / kClosingFolder, error);  // the same
}

}  // namespace stillhand::lab
