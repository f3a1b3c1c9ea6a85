// SPDX-License-Identifier: Apache-2.0
#include "apps/measurement/read.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "apps/measurement/grid.hpp"
#include "apps/measurement/session.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/core/csv.hpp"
#include "services/recording/file_io.hpp"

namespace stillhand::measurement {
namespace {

// A table of short numbers has fewer bytes than its doubles; one of 20-digit numbers has more.
// 2 GiB of text hold 60 million 20-digit numbers.
constexpr std::uint64_t kMostCsv_bytes = std::uint64_t{2} << 30;

bool is_mcap(const std::string& path) {
  // MCAP specification, "Magic".  Only five of its eight bytes: the rest may be cut off.
  constexpr std::array<std::byte, 5> kMagic{std::byte{0x89}, std::byte{'M'}, std::byte{'C'},
                                            std::byte{'A'}, std::byte{'P'}};
  recording::FileSource file(path);
  if (file.size() < kMagic.size()) return false;
  std::array<std::byte, kMagic.size()> begin{};
  const recording::Status status = file.read_at(0, begin);
  if (!status.ok()) throw ConfigError(path, status.text, "a file that can be read");
  return begin == kMagic;
}

// Length in bytes of the first character of the text; 0 if it is no UTF-8 (RFC 3629).
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead < 0xC2   ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  }
  // Overlong, a surrogate, or beyond U+10FFFF.
  if ((lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) > 0x9F) ||
      (lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) > 0x8F)) {
    return 0;
  }
  return length;
}

// Names and units are written to JSON and HTML, so they must be UTF-8.
void check_titles(const std::string& path, std::string_view text) {
  const std::string_view header = text.substr(0, text.find('\n'));
  for (std::size_t i = 0; i < header.size();) {
    const std::size_t length = character_length(header.substr(i));
    if (length == 0) {
      throw ConfigError(path + ":1:" + std::to_string(i + 1), "a title that is no UTF-8",
                        "CSV text in UTF-8");
    }
    i += length;
  }
}

// Checks the number of values before the table is built.
void check_table_size(const std::string& path, const std::string& text, std::size_t most_values) {
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n'));
  const std::size_t rows = std::max<std::size_t>(lines, 1) - 1;  // without the header
  const auto header =
      text.begin() + static_cast<std::ptrdiff_t>(std::min(text.find('\n'), text.size()));
  const auto columns = static_cast<std::size_t>(std::count(text.begin(), header, ','));
  if (columns > 0 && rows > most_values / columns) {
    throw ConfigError(path,
                      std::to_string(rows) + " rows of " + std::to_string(columns) + " channels",
                      "at most " + std::to_string(most_values) +
                          " values; use a part of the file, fewer columns or a lower rate");
  }
}

recording::Recording read_table(const std::string& path, std::size_t most_values) {
  const std::uint64_t bytes = recording::FileSource(path).size();
  if (bytes > kMostCsv_bytes) {
    throw ConfigError(path, std::to_string(bytes >> 20) + " MiB",
                      "at most " + std::to_string(kMostCsv_bytes >> 20) +
                          " MiB; use a part of the file, fewer columns or a lower rate");
  }
  const std::string text = recording::read_file(path);
  check_table_size(path, text, most_values);
  check_titles(path, text);
  return recording::parse_csv(text, path);
}

}  // namespace

diagnosis::Measurement read_measurement(const std::string& path, const ReadOptions& options) {
  if (!is_mcap(path)) {
    if (!options.trial.empty()) {
      throw ConfigError("--trial", options.trial + " with the table " + path,
                        "no --trial, or the recording of a session (MCAP)");
    }
    return on_grid(read_table(path, options.most_values), options.most_values);
  }
  SessionRows session = options.session_trial.empty()
                            ? read_session_rows(path, options.trial)
                            : read_session_rows(path, options.session_trial, true);
  if (!session.loss.empty()) std::fprintf(stderr, "stillhand: %s\n", session.loss.c_str());
  diagnosis::Measurement out = on_grid(std::move(session.rows), options.most_values);
  out.notes.insert(out.notes.begin(), session.notes.begin(), session.notes.end());
  return out;
}

}  // namespace stillhand::measurement
