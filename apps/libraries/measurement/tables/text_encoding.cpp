// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/text_encoding.hpp"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "apps/libraries/report/text/text.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

bool is_ascii(std::string_view text) {
  unsigned char all = 0;
  for (const char c : text) all = static_cast<unsigned char>(all | static_cast<unsigned char>(c));
  return all < 0x80;
}

bool is_utf8(std::string_view text) {
  if (is_ascii(text)) return true;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = report::character_length(text.substr(i));
    if (length == 0) return false;
    i += length;
  }
  return true;
}

// Empty where the bytes are no text of that encoding.
std::string in_utf8(std::string_view bytes, const char* encoding) {
  const iconv_t state = iconv_open("UTF-8", encoding);
  if (state == reinterpret_cast<iconv_t>(-1)) return {};
  // Three bytes of UTF-8 at most for each byte of Windows-1252 and each pair of UTF-16.
  std::string out(3 * bytes.size(), '\0');
  std::string input(bytes);
  char* from = input.data();
  char* to = out.data();
  std::size_t left = input.size();
  std::size_t room = out.size();
  const std::size_t outcome = iconv(state, &from, &left, &to, &room);
  iconv_close(state);
  if (outcome == static_cast<std::size_t>(-1) || left != 0) return {};
  out.resize(out.size() - room);
  return out;
}

DecodedText from(std::string_view bytes, const char* encoding, const std::string& path) {
  DecodedText out{in_utf8(bytes, encoding), "Text in " + std::string(encoding) + "."};
  if (out.text.empty() || out.text.find('\0') != std::string::npos) {
    throw ConfigError(path, "text that is no " + std::string(encoding), "text in UTF-8");
  }
  return out;
}

// Encoding of a text by its byte order mark, or by its zeros: a table has mostly characters below
// 256, so that each second byte of UTF-16 is 0.  Null: one byte a character.
const char* wide_encoding(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("\xFF\xFE\0\0"sv) && bytes.size() > 4) return "UTF-32";
  if (bytes.starts_with("\xFF\xFE") && bytes.size() > 2) return "UTF-16LE";
  if (bytes.starts_with("\xFE\xFF") && bytes.size() > 2) return "UTF-16BE";
  constexpr std::size_t kLookedAt_bytes = 1024;
  std::array<std::size_t, 2> zeros{};  // at even and odd places
  const std::size_t count = std::min(bytes.size(), kLookedAt_bytes) / 2 * 2;
  for (std::size_t i = 0; i < count; ++i) zeros.at(i % 2) += bytes[i] == '\0' ? 1 : 0;
  if (count == 0) return nullptr;
  if (zeros[0] == 0 && zeros[1] > count * 2 / 5) return "UTF-16LE";
  if (zeros[1] == 0 && zeros[0] > count * 2 / 5) return "UTF-16BE";
  return nullptr;
}

// A file that was made longer in advance and not closed ends in zeros.
std::string without_zeros_at_end(std::string& bytes) {
  const std::size_t end = bytes.find_last_not_of('\0') + 1;
  const std::size_t zeros = bytes.size() - end;
  if (zeros == 0 || end == 0) return {};
  bytes.resize(end);
  return std::to_string(zeros) + " zero bytes at the end are left out.";
}

// Signs that programs write for a blank, a minus and the end of a line.
void take_plain_signs(std::string& text) {
  if (!is_ascii(text)) {
    report::replace_all(text, "\u00A0", " ");  // no-break space
    for (const char* blank : {"\u202F", "\u2007", "\u2009"}) report::replace_all(text, blank, " ");
    report::replace_all(text, "\u2212", "-");  // minus sign
    report::replace_all(text, "\uFEFF", "");   // byte order mark within a joined file
  }
  if (text.find('\n') == std::string::npos) std::ranges::replace(text, '\r', '\n');
}

DecodedText decoded(std::string bytes, const std::string& path) {
  const std::string_view all = bytes;
  if (const char* encoding = wide_encoding(all)) {
    const bool marked = all.starts_with("\xFF\xFE") || all.starts_with("\xFE\xFF");
    const bool strips = std::string_view(encoding) == "UTF-32";  // by itself
    return from(all.substr(marked && !strips ? 2 : 0), encoding, path);
  }
  std::string note = without_zeros_at_end(bytes);
  if (const std::size_t zero = bytes.find('\0'); zero != std::string::npos) {
    const auto line =
        std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(zero), '\n') + 1;
    throw ConfigError(line > 1 ? path + ":" + std::to_string(line) : path, "binary data",
                      "a text table (CSV), or MATLAB, HDF5, MCAP or WAV");
  }
  if (is_utf8(bytes)) return {std::move(bytes), std::move(note)};
  DecodedText out = from(bytes, "WINDOWS-1252", path);
  if (!note.empty()) out.note += " " + note;
  return out;
}

}  // namespace

DecodedText to_utf8(std::string bytes, const std::string& path) {
  DecodedText out = decoded(std::move(bytes), path);
  take_plain_signs(out.text);
  return out;
}

}  // namespace stillhand::measurement
