// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/pending_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "services/core/contract/config_error.hpp"

namespace stillhand::recordings {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

[[noreturn]] void fail(const std::string& place, const char* step) {
  throw std::runtime_error(place + ": cannot " + step + ": " + reason(errno));
}

// The process number keeps two runs apart.
std::string beside(const std::string& place) {
  return place + ".new-" + std::to_string(::getpid());
}

}  // namespace

PendingFile::PendingFile(std::string place) : place_(std::move(place)), path_(beside(place_)) {
  // A device or a folder would be replaced by a file: renaming does not ask.
  std::error_code none;
  if (const auto folder = std::filesystem::absolute(place_).parent_path();
      !std::filesystem::is_directory(folder, none)) {
    throw ConfigError(place_, "a name in a folder that does not exist",
                      "a name in a folder that exists");
  }
  const auto status = std::filesystem::status(place_, none);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw ConfigError(place_, "something that is not a regular file",
                      "a file, or a name that does not exist yet");
  }
}

PendingFile::~PendingFile() { ::unlink(path_.c_str()); }

void PendingFile::to_disk() const {
  const int descriptor = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) fail(path_, "open");
  const bool done = ::fsync(descriptor) == 0;
  const int error = errno;
  ::close(descriptor);
  errno = error;
  if (!done) fail(path_, "synchronise");
}

void PendingFile::publish() {
  to_disk();
  if (std::rename(path_.c_str(), place_.c_str()) != 0) fail(place_, "replace");
}

void PendingFile::publish_new() {
  to_disk();
  // A second name is refused where one is; renaming would write over it.
  if (::link(path_.c_str(), place_.c_str()) == 0) return;
  if (errno == EEXIST)
    throw ConfigError(place_, "a file that exists", "a name that does not exist yet");
  // A file system without second names.
  if (std::filesystem::exists(place_)) {
    throw ConfigError(place_, "a file that exists", "a name that does not exist yet");
  }
  if (std::rename(path_.c_str(), place_.c_str()) != 0) fail(place_, "make");
}

}  // namespace stillhand::recordings
