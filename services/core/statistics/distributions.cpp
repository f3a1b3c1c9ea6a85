// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/distributions.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace stillhand::statistics {

using boost::math::chi_squared;
using boost::math::complement;
using boost::math::fisher_f;
using boost::math::normal;
using boost::math::students_t;

double normal_below(double z) { return cdf(normal(), z); }
double normal_above(double z) { return cdf(complement(normal(), z)); }

double t_above(double t, double degrees_of_freedom) {
  return cdf(complement(students_t(degrees_of_freedom), t));
}
double t_quantile(double p, double degrees_of_freedom) {
  return quantile(students_t(degrees_of_freedom), p);
}
double t_upper_quantile(double p, double degrees_of_freedom) {
  return quantile(complement(students_t(degrees_of_freedom), p));
}

double chi_squared_above(double x, double degrees_of_freedom) {
  return cdf(complement(chi_squared(degrees_of_freedom), x));
}
double chi_squared_quantile(double p, double degrees_of_freedom) {
  return quantile(chi_squared(degrees_of_freedom), p);
}

double f_above(double f, double numerator_df, double denominator_df) {
  return cdf(complement(fisher_f(numerator_df, denominator_df), f));
}
double f_quantile(double p, double numerator_df, double denominator_df) {
  return quantile(fisher_f(numerator_df, denominator_df), p);
}

}  // namespace stillhand::statistics
