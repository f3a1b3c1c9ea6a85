// SPDX-License-Identifier: Apache-2.0
#include "report/staged_folder.hpp"

#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include "contract/config_error.hpp"
#include "recording/file_io.hpp"

namespace stillhand::report {
namespace {

namespace fs = std::filesystem;

// The outermost folder on the way to `path` that is not there yet.
fs::path first_missing(const fs::path& path) {
  fs::path missing;
  std::error_code ignored;
  for (fs::path at = fs::absolute(path).lexically_normal(); !fs::exists(at, ignored);
       at = at.parent_path()) {
    if (at == at.parent_path()) break;
    missing = at;
  }
  return missing;
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& out) : out_(out) {
  if (out.empty()) throw ConfigError("--out", "\"\"", "a folder");
  const fs::path missing = first_missing(out);
  std::error_code error;
  fs::create_directories(out, error);
  made_ = error ? fs::path() : missing;
  if (!error && !fs::is_directory(out, error))
    error = std::make_error_code(std::errc::not_a_directory);
  std::string name = (out / ".unfinished-XXXXXX").string();
  if (!error && mkdtemp(name.data()) == nullptr) error = {errno, std::generic_category()};
  if (error) {
    std::error_code ignored;
    if (!made_.empty()) fs::remove_all(made_, ignored);
    throw ConfigError("--out", out.string() + " (" + error.message() + ")",
                      "a folder that can be made and written");
  }
  staging_ = name;
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  if (made_.empty()) return;
  // Published, or somebody else's files came: it stays.
  for (fs::path at = out_; fs::is_empty(at, ignored) && fs::remove(at, ignored);
       at = at.parent_path()) {
    if (fs::equivalent(at, made_, ignored) || fs::absolute(at) == made_) break;
  }
}

void StagedFolder::write(const std::string& name, const std::string& text) const {
  const std::string path = (staging_ / name).string();
  const recording::Status status = recording::write_file_atomically(path, text);
  if (!status.ok()) throw std::runtime_error((out_ / name).string() + ": " + status.text);
}

void StagedFolder::publish() {
  for (const fs::directory_entry& file : fs::directory_iterator(staging_)) {
    std::error_code error;
    fs::rename(file.path(), out_ / file.path().filename(), error);
    if (error) {
      throw std::runtime_error((out_ / file.path().filename()).string() + ": " + error.message());
    }
  }
  made_.clear();
}

}  // namespace stillhand::report
