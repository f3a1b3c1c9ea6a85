// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/text/text.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace stillhand::report {
namespace {

constexpr std::string_view kReplacement = "\uFFFD";
constexpr std::string_view kMinus = "\u2212";

std::string superscript(int exponent) {
  static constexpr std::array<std::string_view, 10> kDigits = {"⁰", "¹", "²", "³", "⁴",
                                                               "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out;
  for (const char c : std::to_string(exponent)) {
    out += c == '-' ? std::string_view("⁻") : kDigits.at(static_cast<std::size_t>(c - '0'));
  }
  return out;
}

std::string with_minus_sign(std::string_view ascii) {
  const bool negative = !ascii.empty() && ascii.front() == '-';
  return negative ? std::string(kMinus) + std::string(ascii.substr(1)) : std::string(ascii);
}

std::string to_text(double value, std::chars_format format, int precision) {
  std::array<char, 400> buffer;  // the longest fixed double has 309 digits before the point
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, precision);
  return end.ec == std::errc() ? std::string(buffer.data(), end.ptr) : std::string("?");
}

}  // namespace

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

std::string clean(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    // XML has no U+FFFE and no U+FFFF.
    if (length == 0 || text.starts_with("\uFFFE") || text.starts_with("\uFFFF")) {
      out += kReplacement;
      text.remove_prefix(1);
      continue;
    }
    const auto lead = static_cast<std::uint8_t>(text.front());
    // U+0080 .. U+009F are control characters as well.
    const bool control =
        lead < 0x20 || lead == 0x7F || (lead == 0xC2 && static_cast<std::uint8_t>(text[1]) < 0xA0);
    out += control ? std::string_view(" ") : text.substr(0, length);
    text.remove_prefix(length);
  }
  return out;
}

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : clean(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string gnuplot_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : clean(text)) {
    if (c == '\'') out += c;
    out += c;
  }
  return out + "'";
}

std::string csv_quoted(std::string_view text) {
  std::string out(text);
  if (out.find_first_of(",\"\r\n") == std::string::npos) return out;
  replace_all(out, "\"", "\"\"");
  return '"' + out + '"';
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

std::string decimal(double value) { return to_text(value, std::chars_format::general, 9); }

std::string number(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  std::string text = to_text(value, std::chars_format::fixed, decimals);
  if (text.find_first_of("123456789") == std::string::npos && text.front() == '-') text.erase(0, 1);
  return with_minus_sign(text);
}

std::string short_number(double value) {
  if (!std::isfinite(value)) return "–";
  const double size = std::abs(value);
  if (size == 0.0) return "0";
  if (size >= 1e-4 && size < 999500.0) {
    const std::string text = to_text(value, std::chars_format::general, 3);
    if (text.find('e') == std::string::npos) return with_minus_sign(text);
    return number(std::stod(text), 0);
  }
  const std::string text = to_text(value, std::chars_format::scientific, 2);
  const std::size_t e = text.find('e');
  std::string mantissa = text.substr(0, e);
  mantissa.erase(mantissa.find_last_not_of('0') + 1);
  if (mantissa.back() == '.') mantissa.pop_back();
  std::string power = "10" + superscript(std::stoi(text.substr(e + 1)));
  if (mantissa == "1") return power;
  if (mantissa == "-1") return std::string(kMinus) + power;
  return with_minus_sign(mantissa) + "×" + power;
}

std::string percent(double share, int decimals) { return number(100.0 * share, decimals) + " %"; }

std::string p_value(double p) { return p > 0.0 ? short_number(p) : "< 10⁻³⁰⁰"; }

std::string restored(double share, const std::optional<std::pair<double, double>>& interval95) {
  std::string out = percent(share, 0) + " ";
  out += interval95 ? fmt::format("[{}, {}]", number(100.0 * interval95->first, 0),
                                  number(100.0 * interval95->second, 0))
                    : "(no interval)";
  if (share > 1.0) out += ", better than A";
  if (share < 0.0) out += ", worse than B";
  return out;
}

std::string power_of_ten(int factor, int exponent) {
  const std::string power = "10" + superscript(exponent);
  return factor == 1 ? power : std::to_string(factor) + "×" + power;
}

double text_width_px(std::string_view text, double font_size_px) {
  double width_em = 0.0;
  for (const char c : text) {
    if ((static_cast<std::uint8_t>(c) & 0xC0) == 0x80) continue;  // inside a UTF-8 sequence
    if (std::string_view("ijl|!.,:;' ()[]frtI").find(c) != std::string_view::npos) {
      width_em += 0.41;
    } else if (static_cast<std::uint8_t>(c) >= 0x80 ||  // a minus sign is as wide
               std::string_view("#&+<=>^~").find(c) != std::string_view::npos) {
      width_em += 0.84;
    } else if (std::string_view("mwMW@%").find(c) != std::string_view::npos) {
      width_em += 1.0;
    } else {
      width_em += c >= 'A' && c <= 'Z' ? 0.79 : 0.64;
    }
  }
  return width_em * font_size_px;
}

}  // namespace stillhand::report
