// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/keep_options.hpp"

#include <sstream>

#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::recording {
namespace {

// A kill -9 loses at most 1 s: the interval, one round of the writing thread (20 ms) and one write
// to a busy disk.
constexpr int kLeastFlush_ms = 10;
constexpr int kMostFlush_ms = 800;
constexpr double kBytesPerMb = 1e6;
constexpr double kMostMb = 1e9;
constexpr const char* kNotPacked = "none";  // "" in the file

}  // namespace

void add_keep_options(command_line::Command& cli, KeepOptions& options) {
  const std::string group = "Recording";
  cli.add_option_function<std::string>(
         "--compression",
         [&options](const std::string& name) {
           options.compression = *compression_of(name == kNotPacked ? "" : name);
         },
         "compression of the chunks: zstd, lz4 or none [zstd]")
      .one_of({"zstd", "lz4", kNotPacked})
      .group(group);
  cli.add_option_function<int>(
         "--flush-ms",
         [&options](int interval_ms) {
           options.flush_interval = std::chrono::milliseconds(interval_ms);
         },
         "longest time between two chunks [ms]; a kill loses at most this time and one write [500]")
      .between(kLeastFlush_ms, kMostFlush_ms)
      .group(group);
  cli.add_flag_callback(
         "--fsync", [&options] { options.durability = Durability::kPower; },
         "wait for the disk after each chunk; a power failure then loses no more than a kill")
      .group(group);
  cli.add_option(
         "--min-free-mb", options.min_free_mb,
         "smallest free space on the disk [MB]; below it close the file completely and stop")
      .check(settings::number_between(0.0, kMostMb))
      .capture_default_str()
      .group(group);
}

std::vector<std::string> keep_words(const KeepOptions& options) {
  const std::string_view packing = compression_name(options.compression);
  std::ostringstream min_free_mb;
  min_free_mb.precision(17);  // every bit of a double
  min_free_mb << options.min_free_mb;
  std::vector<std::string> words{
      "--compression", packing.empty() ? kNotPacked : std::string(packing),
      "--flush-ms",    std::to_string(options.flush_interval.count()),
      "--min-free-mb", min_free_mb.str()};
  if (options.durability == Durability::kPower) words.emplace_back("--fsync");
  return words;
}

TapeOptions tape_options(const KeepOptions& keep, const std::string& path) {
  TapeOptions options;
  options.path = path;
  options.writer.compression = keep.compression;
  options.durability = keep.durability;
  options.flush_interval_ns = std::chrono::nanoseconds(keep.flush_interval).count();
  options.min_free_bytes = static_cast<std::uint64_t>(keep.min_free_mb * kBytesPerMb);
  return options;
}

}  // namespace stillhand::recording
