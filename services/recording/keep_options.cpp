// SPDX-License-Identifier: Apache-2.0
#include "recording/keep_options.hpp"

#include <CLI/CLI.hpp>

#include "recording/within.hpp"

namespace stillhand::recording {
namespace {

// At most 1 s is lost on kill -9: the interval, one round of the writing thread (20 ms) and a
// write to a disk that is not idle.
constexpr int kLeastFlush_ms = 10;
constexpr int kMostFlush_ms = 800;
constexpr double kBytesPerMb = 1e6;
constexpr double kMostMb = 1e9;

}  // namespace

void add_keep_options(CLI::App& cli, KeepOptions& options) {
  cli.add_option_function<std::string>(
         "--compression",
         [&options](const std::string& name) {
           options.compression = *compression_of(name == "none" ? "" : name);
         },
         "of the chunks: zstd, lz4 or none [zstd]")
      ->check(CLI::IsMember({"zstd", "lz4", "none"}));
  cli.add_option_function<int>(
         "--flush-ms",
         [&options](int interval_ms) {
           options.flush_interval = std::chrono::milliseconds(interval_ms);
         },
         "to the file at least that often [ms]; a kill loses no more than this and a write [500]")
      ->check(CLI::Range(kLeastFlush_ms, kMostFlush_ms));
  cli.add_flag_callback(
      "--fsync", [&options] { options.durability = Durability::kPower; },
      "wait for the disk after each chunk: a loss of power loses no more than a kill");
  cli.add_option("--min-free-mb", options.min_free_mb,
                 "stop, with a whole file, when less is left on the disk [MB]")
      ->check(within(0.0, kMostMb))
      ->capture_default_str();
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
