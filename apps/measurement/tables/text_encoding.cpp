// SPDX-License-Identifier: Apache-2.0
#include "apps/measurement/tables/text_encoding.hpp"

#include <iconv.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "services/contract/config_error.hpp"

namespace stillhand::measurement {
namespace {

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

bool is_ascii(std::string_view text) {
  unsigned char all = 0;
  for (const char c : text) all = static_cast<unsigned char>(all | static_cast<unsigned char>(c));
  return all < 0x80;
}

bool is_utf8(std::string_view text) {
  if (is_ascii(text)) return true;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text.substr(i));
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

}  // namespace

DecodedText to_utf8(std::string bytes, const std::string& path) {
  const std::string_view all = bytes;
  if (all.starts_with("\xEF\xBB\xBF")) {
    bytes.erase(0, 3);
  } else if (all.starts_with("\xFF\xFE") && all.size() > 2) {
    return from(all.substr(2), "UTF-16LE", path);
  } else if (all.starts_with("\xFE\xFF") && all.size() > 2) {
    return from(all.substr(2), "UTF-16BE", path);
  }
  if (bytes.find('\0') != std::string::npos) {
    throw ConfigError(path, "binary data", "a text table (CSV), or MATLAB, HDF5, MCAP or WAV");
  }
  if (is_utf8(bytes)) return {std::move(bytes), {}};
  return from(bytes, "WINDOWS-1252", path);
}

}  // namespace stillhand::measurement
