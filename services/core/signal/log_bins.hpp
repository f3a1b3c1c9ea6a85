// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace stillhand::signal {

/// Bins of a histogram of whole numbers: 2^kBitsPerOctave bins an octave, and bins of width 1 below
/// 2^(kBitsPerOctave + 1).  The upper edge of a bin exceeds a value in it by at most the share
/// 2^-kBitsPerOctave.  Pure.
template <int kBitsPerOctave>
struct LogBins {
  static constexpr std::size_t kLinear = std::size_t{1} << kBitsPerOctave;  ///< bins an octave

  /// @param value  not negative
  static constexpr std::size_t bin_of(std::int64_t value) noexcept {
    const auto natural = static_cast<std::uint64_t>(value);
    if (natural < kLinear) return natural;
    const auto octave = static_cast<std::size_t>(std::bit_width(natural)) - kBitsPerOctave - 1;
    return kLinear * octave + (natural >> octave);
  }
  /// Largest value of a bin.
  static constexpr std::int64_t upper_edge(std::size_t bin) noexcept {
    if (bin < kLinear) return static_cast<std::int64_t>(bin);
    const std::size_t octave = bin / kLinear - 1;
    return static_cast<std::int64_t>(((bin - kLinear * octave + 1) << octave) - 1);
  }
};

}  // namespace stillhand::signal
