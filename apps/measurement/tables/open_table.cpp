// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <initializer_list>
#include <span>
#include <string_view>
#include <utility>

#include "apps/measurement/tables/bag_table.hpp"
#include "apps/measurement/tables/guarded_table.hpp"
#include "apps/measurement/tables/table_file.hpp"
#include "apps/measurement/tables/text_encoding.hpp"
#include "apps/measurement/tables/text_table.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/file_io.hpp"

namespace stillhand::measurement {
namespace {

// A table of short numbers has fewer bytes than its doubles; one of 20-digit numbers has more.
// 2 GiB of text hold 60 million 20-digit numbers.
constexpr std::uint64_t kMostText_bytes = std::uint64_t{2} << 30;

std::string first_bytes(const std::string& path) {
  recording::FileSource file(path);
  std::array<std::byte, 128> begin{};
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), begin.size()));
  const recording::Status status = file.read_at(0, std::span(begin).first(count));
  if (!status.ok()) throw ConfigError(path, status.text, "a file that can be read");
  return {reinterpret_cast<const char*>(begin.data()), count};
}

bool is_any_of(std::string_view begin, std::initializer_list<std::string_view> magics) {
  return std::ranges::any_of(magics,
                             [&](std::string_view magic) { return begin.starts_with(magic); });
}

}  // namespace

FileKind kind_of(const std::string& path) {
  const std::string begin = first_bytes(path);
  // MCAP specification, "Magic".  Only five of its eight bytes: the rest may be cut off.
  if (begin.starts_with("\x89MCAP")) return FileKind::kMcap;
  if (is_any_of(begin, {"MATLAB 5.0", "MATLAB 7.3"})) return FileKind::kMatlab;
  if (begin.starts_with("\x89HDF\r\n\x1a\n")) return FileKind::kHdf5;
  if (is_any_of(begin, {"RIFF", "RF64", "riff", "FORM", "fLaC", "caff"})) return FileKind::kSound;
  // MATLAB's versions before 5, and HDF5 behind a user block, have no magic: the name decides.
  const auto named = [&](std::string_view ending) { return path.ends_with(ending); };
  const bool binary = begin.find('\0') != std::string::npos;
  if (binary && named(".mat")) return FileKind::kMatlab;
  if (binary && (named(".h5") || named(".hdf5"))) return FileKind::kHdf5;
  return FileKind::kText;
}

std::string read_text(const std::string& path) {
  const std::uint64_t bytes = recording::FileSource(path).size();
  if (bytes > kMostText_bytes) {
    throw ConfigError(path, std::to_string(bytes >> 20) + " MiB",
                      "at most " + std::to_string(kMostText_bytes >> 20) +
                          " MiB; use a part of the file, fewer columns or a lower rate");
  }
  return recording::read_file(path);
}

std::unique_ptr<TableFile> open_table(const std::string& path, const TextForm& form,
                                      std::size_t most_values) {
  switch (kind_of(path)) {
    case FileKind::kMcap:
      return bag_table(path, most_values);
    case FileKind::kMatlab:
      return guarded_table(path, mat_reader(), most_values);
    case FileKind::kHdf5:
      return guarded_table(path, hdf5_reader(), most_values);
    case FileKind::kSound:
      return guarded_table(path, sound_reader(), most_values);
    case FileKind::kText:
      break;
  }
  DecodedText decoded = to_utf8(read_text(path), path);
  return text_table(std::move(decoded), path, form, most_values);
}

}  // namespace stillhand::measurement
