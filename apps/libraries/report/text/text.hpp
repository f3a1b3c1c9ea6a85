// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace stillhand::report {

/// Length in bytes of the first character of a text that has one, 0 if it is no UTF-8 (RFC 3629).
std::size_t character_length(std::string_view text);

/// Text on one line that every XML reader accepts: control characters become spaces, and bytes that
/// are no UTF-8 or no XML character become U+FFFD.
std::string clean(std::string_view text);

/// clean(), with & < > " ' as entities: for HTML text and for attributes in either quotes.
std::string html_escaped(std::string_view text);

/// clean() as a gnuplot string constant.  Single quotes, in which gnuplot substitutes nothing; a
/// quote inside is doubled.
std::string gnuplot_quoted(std::string_view text);

/// As a cell of CSV, RFC 4180: in quotes where it has a comma, a quote or an end of line.
std::string csv_quoted(std::string_view text);

/// Each `from` becomes `to`; what was put in is not searched again.
void replace_all(std::string& text, std::string_view from, std::string_view to);

/// For scripts: decimal text of up to nine significant digits, with an ASCII minus, in any locale.
std::string decimal(double value);

/// For people: `decimals` digits after the point, U+2212 as minus, no "−0.0", an en dash for a
/// value that is not finite.
std::string number(double value, int decimals);

/// For people: as short as three significant digits allow, powers of ten as "2×10⁻⁵" outside
/// 1e-4 .. 1e6.
std::string short_number(double value);

/// "12.3 %" of the share 0.123; an en dash in place of a number that is not finite.
std::string percent(double share, int decimals);

/// A probability for people; "< 10⁻³⁰⁰" where a double cannot hold it.
std::string p_value(double p);

/// Of what the motion took, a share is given back: "47 % [30, 60]".  Without an interval the text
/// says so, and a share outside of 0 to 1 has its meaning: "130 % (no interval), better than A".
std::string restored(double share, const std::optional<std::pair<double, double>>& interval95 = {});

/// In the place of restored(): nothing was taken.
inline constexpr const char* kNotWorse = "–, B is not worse than A";

/// factor×10^exponent for people, with superscripts: "10⁻⁵", "2×10³".
std::string power_of_ten(int factor, int exponent);

/// Upper estimate of the width of a text in DejaVu Sans [px].  Other sans-serif fonts are narrower.
double text_width_px(std::string_view text, double font_size_px);

}  // namespace stillhand::report
