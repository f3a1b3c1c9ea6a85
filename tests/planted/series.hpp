// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/planted/recording.hpp"

namespace stillhand::planted {

/// A long list of recordings: kinds, strengths and noise levels taken in turn, so that every
/// combination comes equally often; recording i is the same in every list of the same plan.
struct SeriesPlan {
  std::uint64_t seed = 1;
  std::vector<std::string> kinds;  ///< empty: all and "none"
  std::vector<double> strengths{0.10, 0.25};
  std::vector<double> snrs_db{20.0, 40.0};
  std::string
      noise;  ///< empty: white; of recordings without effect: drawn, with gaps and heavy noise
  bool gaps = false;
  std::size_t together = 1;       ///< kinds planted at once
  double least_evidence = 100.0;  ///< see Spec; ten standard deviations of the noise
  double length_s = 120.0;
  double rate_hz = 100.0;
  bool twice = false;  ///< see Spec
  double again_length_s = 0.0;
  double again_rate_hz = 0.0;

  /// @throws std::invalid_argument on a name that is no kind or noise, an empty list, a size.
  void check() const;
  [[nodiscard]] std::pair<std::uint64_t, Spec> at(std::size_t i) const;
};

}  // namespace stillhand::planted
