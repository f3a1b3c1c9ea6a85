// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/export/set_files.hpp"

#include <algorithm>
#include <filesystem>

#include "services/files/digest/digest.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::experiment {

void SetFiles::write(const std::string& name, const std::string& text) {
  std::filesystem::create_directories((out_.path() / name).parent_path());
  out_.write(name, text);
  lines_.emplace_back(name, digest::digest_line(text, name));
}

void SetFiles::add(const std::string& name) {
  const std::string bytes = recording::read_file((out_.path() / name).string());
  lines_.emplace_back(name, digest::digest_line(bytes, name));
}

void SetFiles::write_sums() {
  std::ranges::sort(lines_);
  std::string text;
  for (const auto& [name, line] : lines_) text += line;
  out_.write(kSumsFile, text);
}

}  // namespace stillhand::experiment
