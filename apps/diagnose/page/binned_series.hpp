// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "apps/diagnose/page/binning.hpp"
#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::diagnose {

/// Means by bins, each with a bar of one standard error up and down.
inline report::Series with_errors(const std::string& label, report::Colour colour,
                                  const BinnedMeans& means) {
  report::Series series{.label = label,
                        .kind = report::Kind::kErrorBars,
                        .colour = colour,
                        .x = means.centre,
                        .y = means.mean};
  for (std::size_t b = 0; b < means.mean.size(); ++b) {
    series.y_low.push_back(means.mean[b] - means.standard_error[b]);
    series.y_high.push_back(means.mean[b] + means.standard_error[b]);
  }
  return series;
}

}  // namespace stillhand::diagnose
