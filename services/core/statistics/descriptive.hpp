// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace stillhand::statistics {

/// Describing one sample, README Eq. ST-1 to ST-4.  Results carry the unit of the values.  Every
/// function is pure and leaves the order of its argument alone.
/// All throw stillhand::ConfigError for an empty sample or a value that is not finite.

/// Arithmetic mean, Eq. ST-1.
double mean(const std::vector<double>& values);

/// Sample standard deviation with n - 1, Eq. ST-1; needs two values.
double standard_deviation(const std::vector<double>& values);

/// Quantile of type 7 of Hyndman and Fan (1996), Eq. ST-2: R's and NumPy's default.
/// @param probability  [-] 0 to 1
double quantile(const std::vector<double>& values, double probability);

double median(const std::vector<double>& values);

/// Two-sided interval of a mean from Student's t, Eq. ST-3.
struct MeanInterval {
  double mean = 0.0;
  double low = 0.0;
  double high = 0.0;
  double confidence = 0.95;  ///< [-] as asked for
};

/// Needs two values.  @param confidence  [-] between 0 and 1
MeanInterval mean_interval(const std::vector<double>& values, double confidence = 0.95);

/// Box-and-whisker plot, Eq. ST-4.  Quartiles are of type 7 (as in ggplot2 and Matplotlib; R's
/// boxplot() takes hinges, which differ a little).
struct BoxPlot {
  double lower_quartile = 0.0;
  double median = 0.0;
  double upper_quartile = 0.0;
  double minimum = 0.0;  ///< for whiskers over the whole range, as in the paper's Fig. 10
  double maximum = 0.0;
};

BoxPlot box_plot(const std::vector<double>& values);

}  // namespace stillhand::statistics
