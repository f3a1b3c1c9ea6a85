// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"
#include "apps/libraries/report/provenance.hpp"
#include "apps/predict/predict.hpp"
#include "services/core/diagnosis/record/measurement.hpp"

/// How right a prediction is, where the recording holds the output.
namespace stillhand::predict {

/// Over the rows that did not give the start, r = measured - predicted, y = measured:
///
///   RMSE = sqrt(mean r^2),  VAF = 100 (1 - var r / var y),
///   fit = 100 (1 - |r| / |y - mean y|)
///
/// VAF forgives an offset, RMSE and fit do not.  Fit is the NRMSE fit of the System Identification
/// Toolbox.  NaN for a constant output.
struct Score {
  double rmse = 0.0;         ///< [unit of the output]
  double vaf_percent = 0.0;  ///< [%]
  double fit_percent = 0.0;  ///< [%]
  std::size_t rows = 0;      ///< that were scored
  /// [unit of the output] RMSE of the first tenth of each stretch, in which a guessed state of the
  /// start still shows, and of the rest.
  double start_rmse = 0.0;
  double rest_rmse = 0.0;
};

/// One model's prediction at the rows, and its score.
struct Judged {
  std::vector<double> values;
  Score score;
};

struct Judgement {
  recording::Column measured;  ///< at the rows of the prediction
  std::vector<double> time_s;
  double rate_hz = 0.0;
  Judged carried;
  std::optional<Judged> linear;  ///< none: the model file holds no linear model
  std::string unusable = {};     ///< a unit or a sign that is wrong, in the model or the recording
};

/// @param prediction  of the carried model over the measurement; its notes may grow
/// @param linear      the model without any effect, if there is one
/// @param start_samples  as in predict()
/// @return none where the measurement does not hold the output, or in another unit, or in fewer
/// than kLeastScored rows, which a note of the prediction says
std::optional<Judgement> judged(Prediction& prediction,
                                const std::optional<diagnosis::Model>& linear,
                                const diagnosis::Measurement& measurement,
                                std::size_t start_samples = 0);

/// A line a model.
std::string judgement_table(const Judgement& judgement);
/// The same for scripts, with the notes.
/// @param origin  of the model; this one and the judgement are null in the text if there is none
std::string judgement_json(const Prediction& prediction, const std::optional<Judgement>& judgement,
                           const std::optional<report::Provenance>& origin);
/// Measured, linear and carried (one line where they are the same) over an excerpt; below, the
/// residuals.  The excerpt is the one whose errors are nearest to those of the whole recording.
report::Figure judgement_figure(const Judgement& judgement);

}  // namespace stillhand::predict
