// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"
#include "services/core/diagnosis/record/excited_band.hpp"

namespace stillhand::diagnosis {

/// The body, each input's response times the number that brings it next to the other body's within
/// the band (least squares).
Body scaled_to(const Body& other, const Body& body, const std::vector<ExcitedBand>& bands,
               double rate_hz);

/// What is assumed of a body's response where the input did not excite it: that of another body,
/// METHOD Eq. DG-67.  Terms of a least-squares fit next to the samples'.
class ResponsePrior {
 public:
  /// @param body     with the response that is assumed
  /// @param bands    [inputs] where the samples alone decide
  /// @param rate_hz  [Hz] of the model
  /// @param noise    [unit of the output] root mean square of what the fit leaves
  /// @param spread   [-] standard deviation of the response, of its RMS in the band
  ResponsePrior(const Body& body, const std::vector<ExcitedBand>& bands, double rate_hz,
                double noise, double spread);

  /// What is assumed of paths from other channels through the body, Eq. DG-67: above the band
  /// of its channel the response is 0, with the standard deviation of its RMS within the band.
  /// @param model  fitted, with the paths
  ResponsePrior(const Model& model, const Signals& signals, double noise);

  /// True where the input excites every frequency: no terms.
  [[nodiscard]] bool empty() const noexcept { return lines_.empty() && paths_.empty(); }
  /// Sum of squares [(unit of the output)^2] of a model with as many inputs.
  [[nodiscard]] double error(const Model& model) const;
  /// Adds products of the terms' columns [jacobian | residual], as in Grams, of the model's numbers
  /// in the order of packed().
  void add(const Model& model, Eigen::MatrixXd& gram) const;

 private:
  struct Line {
    std::size_t input;
    std::complex<double> step;      ///< q^-1 = exp(-j 2 pi f / rate)
    std::complex<double> response;  ///< of the body that is assumed
    double weight;                  ///< [unit of the output / unit of the response]
  };
  struct PathLine {
    std::string channel;
    std::complex<double> step;
    double weight;
  };
  // Calls line(coefficients of the path, place of the first among the numbers, line).
  template <class Visit>
  void visit_paths(const Model& model, const Visit& line) const;
  void add_lines_of_body(const Body& body, Eigen::MatrixXd& gram) const;
  void add_lines_of_paths(const Model& model, Eigen::MatrixXd& gram) const;

  std::vector<Line> lines_;
  std::vector<PathLine> paths_;
};

}  // namespace stillhand::diagnosis
