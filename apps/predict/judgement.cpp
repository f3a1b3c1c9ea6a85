// SPDX-License-Identifier: Apache-2.0
#include "apps/predict/judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/libraries/measurement/screening_json.hpp"
#include "apps/libraries/report/or_null.hpp"
#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/share_words.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::predict {
namespace {

using nlohmann::ordered_json;
using report::or_null;

// The first tenth of each stretch of rows.
std::vector<bool> starts_of(const std::vector<double>& time_s, double rate_hz) {
  std::vector<bool> at_start(time_s.size(), false);
  for (std::size_t first = 0, end = 0; first < time_s.size(); first = end) {
    for (end = first + 1; end < time_s.size(); ++end) {
      if ((time_s[end] - time_s[end - 1]) * rate_hz > 1.5) break;
    }
    for (std::size_t n = first; n < first + (end - first) / 10; ++n) at_start[n] = true;
  }
  return at_start;
}

Judged judged_against(const std::vector<double>& all, const std::vector<bool>& given,
                      const std::vector<bool>& at_start, std::vector<double> predicted) {
  std::vector<double> start;
  std::vector<double> rest;
  std::vector<double> measured;
  std::vector<double> residual;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (given[n]) continue;
    measured.push_back(all[n]);
    residual.push_back(all[n] - predicted[n]);
    (at_start[n] ? start : rest).push_back(residual.back());
  }
  const double square = signal::mean_square(residual);
  const double whole = signal::variance(measured);
  const double not_known = std::numeric_limits<double>::quiet_NaN();
  Score score{signal::rms(residual), not_known,          not_known,
              residual.size(),       signal::rms(start), signal::rms(rest)};
  // A constant output leaves rounding about its mean.
  if (whole > 1e-18 * signal::mean_square(measured)) {
    score.vaf_percent = 100.0 * (1.0 - signal::variance(residual) / whole);
    score.fit_percent = 100.0 * (1.0 - std::sqrt(square / whole));
  }
  return {std::move(predicted), score};
}

// The measured output at the prediction's rows, which are samples of the measurement.
std::vector<double> at_rows(const std::vector<double>& time_s, const diagnosis::Channel& channel,
                            const diagnosis::Measurement& measurement) {
  const std::vector<double> all_s = measurement.time_s();
  std::vector<double> values;
  std::size_t n = 0;
  for (const double at_s : time_s) {
    while (all_s[n] != at_s) ++n;
    values.push_back(channel.values[n]);
  }
  return values;
}

ordered_json json_of(const Score& score) {
  return {{"rmse", or_null(score.rmse)},
          {"vaf_percent", or_null(score.vaf_percent)},
          {"fit_percent", or_null(score.fit_percent)},
          {"rows", score.rows},
          {"start_rmse", or_null(score.start_rmse)},
          {"rest_rmse", or_null(score.rest_rmse)}};
}

std::string line_of(const char* name, const Score& score, const std::string& unit) {
  return fmt::format(
      "{:<9}RMSE {:.4g} {}, {}, fit {}\n", name, score.rmse, unit,
      diagnosis::vaf_in_words(score.vaf_percent),
      score.fit_percent < -100.0 ? "below -100 %" : fmt::format("{:.2f} %", score.fit_percent));
}

std::string scored_line(const Score& score, const std::string& unit) {
  std::string line = fmt::format("scored   {} rows", score.rows);
  if (std::isfinite(score.start_rmse)) {
    line += fmt::format(
        "; RMSE {:.4g} {} in the first tenth of each stretch, where a guessed start still shows, "
        "and {:.4g} {} in the rest",
        score.start_rmse, unit, score.rest_rmse, unit);
  }
  return line + "\n";
}

// Eq. DG-79, the gain of one of several recordings: a unit or a sign that is not that of
// the recording to which the model was fitted.
std::string why_unusable(const recording::Column& measured, const std::vector<bool>& given,
                         const std::vector<double>& predicted) {
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t n = 0; n < given.size(); ++n) {
    if (given[n]) continue;
    x.push_back(predicted[n]);
    y.push_back(measured.values[n]);
  }
  constexpr double kClearly = 0.5;  // of the power; with that explained, chance is no question
  const auto [gain, share] = diagnosis::likeness(x, y);
  if (share < kClearly) return {};
  if (gain < 0.0) {
    return fmt::format(
        "{0} follows the prediction with the other sign ({1:.3g} times): the sign of "
        "an input or of {0} is wrong",
        measured.name, gain);
  }
  if (gain <= diagnosis::kAnotherUnit && gain >= 1.0 / diagnosis::kAnotherUnit) return {};
  return fmt::format(
      "{0} is {1:.3g} times what the model predicts: the unit of an input or of {0} is "
      "wrong",
      measured.name, gain);
}

}  // namespace

std::optional<Judgement> judged(Prediction& prediction,
                                const std::optional<diagnosis::Model>& linear,
                                const diagnosis::Measurement& measurement,
                                std::size_t start_samples) {
  const recording::Column& model = prediction.table.columns.front();
  const diagnosis::Channel* output = measurement.find(prediction.output);
  if (output == nullptr) return {};
  if (output->unit != model.unit) {
    prediction.notes.push_back("not judged: the model predicts " + output->name + " in " +
                               model.unit + ", and the recording holds it in " + output->unit);
    return {};
  }
  const auto rows = std::ranges::count(prediction.given, false);
  if (static_cast<std::size_t>(rows) < kLeastScored) {
    prediction.notes.push_back(
        fmt::format("not judged: {} rows, and a score takes {}", rows, kLeastScored));
    return {};
  }
  Judgement judgement;
  judgement.time_s = prediction.table.time_s;
  judgement.rate_hz = measurement.rate_hz;
  judgement.measured = {output->name, output->unit,
                        at_rows(judgement.time_s, *output, measurement)};
  const std::vector<bool> at_start = starts_of(judgement.time_s, judgement.rate_hz);
  judgement.carried =
      judged_against(judgement.measured.values, prediction.given, at_start, model.values);
  judgement.unusable = why_unusable(judgement.measured, prediction.given, judgement.carried.values);
  if (linear) {
    Prediction without = predict(diagnosis::carried_as_it_is(*linear), measurement, start_samples);
    judgement.linear = judged_against(judgement.measured.values, prediction.given, at_start,
                                      std::move(without.table.columns.front().values));
  }
  return judgement;
}

std::string judgement_table(const Judgement& judgement) {
  const std::string& unit = judgement.measured.unit;
  return (judgement.unusable.empty() ? "" : "usable   no: " + judgement.unusable + "\n") +
         (judgement.linear ? line_of("linear", judgement.linear->score, unit) : std::string()) +
         line_of(judgement.linear ? "effects" : "model", judgement.carried.score, unit) +
         scored_line(judgement.carried.score, unit);
}

std::string judgement_json(const Prediction& prediction, const std::optional<Judgement>& judgement,
                           const std::optional<report::Provenance>& origin) {
  const recording::Column& column = prediction.table.columns.front();
  ordered_json json{{"output", prediction.output},
                    {"output_unit", column.unit},
                    {"samples", prediction.table.row_count()},
                    {"linear", nullptr},
                    {"carried", nullptr},
                    {"usable", nullptr},
                    {"why", ""},
                    {"screening", measurement::screening_json(prediction.screening)},
                    {"notes", prediction.notes},
                    {"provenance", nullptr}};
  if (judgement) json["carried"] = json_of(judgement->carried.score);
  if (judgement) {
    json["usable"] = judgement->unusable.empty();
    json["why"] = judgement->unusable;
  }
  if (judgement && judgement->linear) json["linear"] = json_of(judgement->linear->score);
  if (origin) json["provenance"] = report::json_of(*origin);
  return json.dump(2) + "\n";
}

}  // namespace stillhand::predict
