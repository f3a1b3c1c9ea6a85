// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/staged_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include "apps/libraries/report/experiment_place.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStagingPrefix = ".unfinished-";

// The outermost missing folder on the absolute `path`; empty if `path` exists.
fs::path first_missing(fs::path path) {
  fs::path missing;
  std::error_code ignored;
  for (; !fs::exists(fs::symlink_status(path, ignored)); path = path.parent_path()) missing = path;
  return missing;
}

fs::path made_absolute(const fs::path& path, const std::string& option) {
  std::error_code error;
  fs::path out = fs::weakly_canonical(fs::absolute(path, error), error);
  if (!out.has_filename()) out = out.parent_path();  // a slash at the end
  if (path.empty() || error) {
    throw ConfigError(option, "\"" + path.string() + "\"", "a folder that can be made");
  }
  refuse_place_of_experiment(out, option);
  return out;
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& out, std::string option)
    : option_(std::move(option)), out_(made_absolute(out, option_)) {
  try {
    make();
    lock();
    std::string name = (out_ / kStagingPrefix).string() + "XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category());
    staging_ = name;
  } catch (const std::system_error& error) {
    clear_away();
    throw ConfigError(option_, out_.string() + " (" + error.code().message() + ")",
                      "a folder that can be made and written");
  } catch (...) {
    clear_away();
    throw;
  }
}

StagedFolder::~StagedFolder() { clear_away(); }

void StagedFolder::make() {
  made_ = first_missing(out_);
  fs::create_directories(out_);
  if (!fs::is_directory(out_)) {
    throw std::system_error(std::make_error_code(std::errc::not_a_directory));
  }
}

void StagedFolder::lock() {
  descriptor_ = open(out_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category());
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    made_.clear();
    throw ConfigError(option_, out_.string() + ", in which another run is writing",
                      "a different folder for each run");
  }
  // The program that left such a folder was killed; otherwise it would hold the lock.
  for (const fs::directory_entry& entry : fs::directory_iterator(out_)) {
    if (entry.path().filename().string().starts_with(kStagingPrefix)) fs::remove_all(entry.path());
  }
}

void StagedFolder::clear_away() noexcept {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
  // Removes the folders that this object made, innermost first, as long as they are empty.
  if (!made_.empty()) {
    for (fs::path at = out_; fs::remove(at, ignored) && at != made_;) at = at.parent_path();
  }
  if (descriptor_ >= 0) close(descriptor_);
}

void StagedFolder::write(const std::string& name, const std::string& text) const {
  const recording::Status status =
      recording::write_file_atomically((staging_ / name).string(), text);
  if (!status.ok()) throw std::runtime_error((out_ / name).string() + ": " + status.text);
}

std::vector<std::string> StagedFolder::in_place(const std::string& begin, const std::string& end,
                                                const std::string& mark) const {
  std::vector<std::string> names;
  for (const fs::directory_entry& file : fs::directory_iterator(out_)) {
    const std::string name = file.path().filename().string();
    if (!name.starts_with(begin) || !name.ends_with(end) || !file.is_regular_file()) continue;
    if (recording::read_file(file.path().string()).find(mark) == std::string::npos) continue;
    names.push_back(name);
  }
  return names;
}

void StagedFolder::check() const {
  for (const fs::directory_entry& file : fs::directory_iterator(staging_)) {
    const fs::path target = out_ / file.path().filename();
    if (fs::is_directory(target)) {
      throw ConfigError(option_, target.string() + ", a folder",
                        "no folder in the place of a file");
    }
  }
}

void StagedFolder::publish(const std::vector<std::string>& own) {
  check();
  for (const std::string& name : own) {
    if (!fs::exists(staging_ / name) && !fs::is_directory(out_ / name)) fs::remove(out_ / name);
  }
  for (const fs::directory_entry& file : fs::directory_iterator(staging_)) {
    fs::rename(file.path(), out_ / file.path().filename());
  }
  made_.clear();
}

}  // namespace stillhand::report
