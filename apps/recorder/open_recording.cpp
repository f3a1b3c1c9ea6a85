// SPDX-License-Identifier: Apache-2.0
#include "recorder/open_recording.hpp"

#include <cstdio>
#include <stdexcept>

#include "contract/config_error.hpp"
#include "recording/core/mcap_loss.hpp"

namespace stillhand::recorder {

OpenRecording::OpenRecording(const std::string& file) : path(file), source(file), reader(source) {
  if (!reader.status().ok()) {
    throw ConfigError(path, reader.status().text, "a recording (MCAP, version 0)");
  }
}

void OpenRecording::tell_loss(std::uint64_t messages) const {
  const std::string line = recording::loss_line(path, reader, messages, source.being_written());
  if (!line.empty()) std::fprintf(stderr, "stillhand: %s\n", line.c_str());
}

void check(const recording::Status& status) {
  if (!status.ok()) throw std::runtime_error(status.text);
}

}  // namespace stillhand::recorder
