// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/result_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "apps/libraries/report/experiment_place.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/expects.hpp"

namespace stillhand::report {
namespace {

namespace fs = std::filesystem;

std::string reason(int error) { return std::generic_category().message(error); }

// The file to which a path leads, even if it does not exist yet.
fs::path followed(const fs::path& path) {
  std::error_code error;
  fs::path place = fs::weakly_canonical(fs::absolute(path), error);
  return error ? path : place;
}

void check_place(const ResultFile& file, const fs::path& place) {
  const std::string name = file.path.string();
  refuse_place_of_experiment(place, file.option);
  std::error_code error;
  if (fs::is_directory(place, error)) {
    throw ConfigError(file.option, name + ", a folder", "the name of a file");
  }
  if (fs::exists(place, error)) {
    if (::access(place.c_str(), W_OK) != 0) {
      throw ConfigError(file.option, name + ": " + reason(errno), "a file that can be written");
    }
    if (!fs::is_regular_file(place, error)) return;
  }
  const fs::path folder = place.parent_path();
  if (!place.has_filename() || !fs::is_directory(folder, error)) {
    throw ConfigError(file.option, name, "a file in a folder that exists");
  }
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw ConfigError(file.option, folder.string() + ": " + reason(errno),
                      "a folder that can be written");
  }
}

void write(const fs::path& path, const std::string& text) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw std::runtime_error(path.string() + ": cannot be written: " + reason(errno));
}

// What is printed from here on goes to standard error.
int standard_output_apart() {
  std::fflush(stdout);
  // A reader that ends early is an error to report: the other files must not stay half done.
  std::signal(SIGPIPE, SIG_IGN);
  const int descriptor = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
  if (descriptor < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    throw std::runtime_error("standard output: " + reason(errno));
  }
  return descriptor;
}

void write(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw std::runtime_error("standard output cannot be written: " + reason(errno));
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

// Temporary files next to their places.  Removes those that were not moved.
struct Staged {
  std::vector<fs::path> paths;
  ~Staged() {
    for (const fs::path& path : paths) ::unlink(path.c_str());
  }
};

}  // namespace

ResultFiles::ResultFiles(const std::vector<ResultFile>& files,
                         const std::vector<fs::path>& inputs) {
  std::ranges::copy_if(inputs, std::back_inserter(inputs_),
                       [](const fs::path& input) { return !input.empty(); });
  for (const ResultFile& file : files) {
    if (file.path.empty()) continue;
    if (file.path == "-") {
      if (std::ranges::any_of(entries_, [](const Entry& e) { return e.descriptor >= 0; })) {
        throw ConfigError(file.option, "-", "one result on standard output");
      }
      entries_.push_back({file, {}, false, standard_output_apart(), {}});
      continue;
    }
    Entry entry{file, followed(file.path), true, -1, {}};
    check_place(file, entry.place);
    std::error_code error;
    entry.plain = !fs::exists(entry.place, error) || fs::is_regular_file(entry.place, error);
    for (const fs::path& input : inputs) {
      if (input.empty()) continue;  // the option that names it was not given
      if (followed(input) == entry.place || fs::equivalent(input, entry.place, error)) {
        throw ConfigError(file.option, file.path.string(),
                          "a file other than " + input.string() + ", which is read");
      }
    }
    for (const Entry& other : entries_) {
      if (other.plain && other.place == entry.place) {
        throw ConfigError(file.option, file.path.string(),
                          "a file other than that of " + other.file.option);
      }
    }
    entries_.push_back(std::move(entry));
  }
}

bool ResultFiles::wants(const std::string& option) const {
  return std::ranges::any_of(entries_, [&](const Entry& e) { return e.file.option == option; });
}

void ResultFiles::set(const std::string& option, std::string text) {
  const auto entry =
      std::ranges::find_if(entries_, [&](const Entry& e) { return e.file.option == option; });
  STILLHAND_EXPECTS(entry != entries_.end());
  entry->text = std::move(text);
}

void ResultFiles::set_json(const std::string& option, const std::string& json) {
  if (wants(option)) set(option, with_provenance(json, provenance_of_this_call(inputs_)));
}

void ResultFiles::publish() {
  Staged staged_files;
  for (const Entry& entry : entries_) {
    if (!entry.plain) continue;
    // The process number keeps two runs apart.
    fs::path staged = entry.place;
    staged += ".new-" + std::to_string(::getpid());
    staged_files.paths.push_back(staged);
    write(staged, entry.text);
  }
  // What cannot be taken back comes before the files that replace others.
  for (const Entry& entry : entries_) {
    if (entry.descriptor >= 0) {
      write(entry.descriptor, entry.text);
    } else if (!entry.plain) {
      write(entry.place, entry.text);
    }
  }
  std::size_t next = 0;
  for (const Entry& entry : entries_) {
    if (!entry.plain) continue;
    if (std::rename(staged_files.paths[next++].c_str(), entry.place.c_str()) != 0) {
      throw std::runtime_error(entry.file.path.string() + ": cannot be replaced: " + reason(errno));
    }
  }
}

}  // namespace stillhand::report
