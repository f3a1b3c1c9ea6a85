// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/open_recording.hpp"

#include <cstdio>
#include <stdexcept>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/mcap/mcap_loss.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::recordings {

void go_on_unless(const Stopped& stopped) {
  if (stopped && stopped()) throw Interrupted();
}

StoppableFile::StoppableFile(const std::string& path, Stopped stopped)
    : FileSource(path), stopped_(std::move(stopped)) {}

recording::Status StoppableFile::read_at(std::uint64_t offset, std::span<std::byte> into) {
  go_on_unless(stopped_);
  return FileSource::read_at(offset, into);
}

OpenRecording::OpenRecording(const std::string& file, Stopped stopped)
    : path(file), source(file, std::move(stopped)), reader(source) {
  if (!reader.status().ok()) {
    throw ConfigError(path, reader.status().text, "a recording (MCAP, version 0)");
  }
}

void OpenRecording::report_loss(std::uint64_t messages) const {
  const std::string line = recording::loss_line(path, reader, messages, source.being_written());
  if (!line.empty()) runtime::remark(line);
  const std::string clock = recording::clock_line(path, reader);
  if (!clock.empty()) runtime::remark(clock);
}

void check(const recording::Status& status) {
  if (!status.ok()) throw std::runtime_error(status.text);
}

}  // namespace stillhand::recordings
