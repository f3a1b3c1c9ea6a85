// SPDX-License-Identifier: Apache-2.0
#include "apps/study/subjects/trial_analysis.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "services/core/signal/reference.hpp"

namespace stillhand::study {
namespace {

using session::PlannedTrial;

const int kOrder = static_cast<int>(identification::Config{}.order);
// Welch segments of Fig. 4: 5.12 s, 0.2 Hz a line, 45 averages of two minutes.  They are shorter
// for a record that is shorter than four segments.
constexpr std::size_t kSegmentSamples = 256;
// Length and thinning of Fig. 7.
constexpr double kExcerpt_s = 20.0;
constexpr std::size_t kExcerptStride = 5;

// One value a second: entry i of a moving average covers the window that starts at second i.
void thin(std::vector<double>& series, double rate_hz) {
  std::vector<double> kept;
  for (std::size_t n = 0; n < series.size(); n += static_cast<std::size_t>(rate_hz)) {
    kept.push_back(series[n]);
  }
  series = std::move(kept);
}

}  // namespace

Identification identified(const identification::Record& pegged) {
  identification::IdentificationSteps steps = identification::identify_stepwise(pegged, {}, true);
  Identification out;
  out.paper = std::move(steps.paper);
  out.refined = std::move(*steps.refined);
  out.fit = steps.refined_used ? out.refined.model : out.paper.model;
  out.control = std::move(steps.control);
  out.paper_unusable = std::move(steps.paper_unusable);
  out.factor = identification::factor_arx(steps.record, kOrder);
  const std::size_t segment = std::min(kSegmentSamples, steps.record.size() / 8 * 2);
  out.estimate = signal::transfer_estimate(signal::cross_spectra(
      steps.record.acceleration_m_s2, steps.record.force_n, steps.record.rate_hz, segment));
  return out;
}

TrackedTrial evaluated(const session::TrialSignals& signals, const PlannedTrial& planned) {
  TrackedTrial out;
  const auto& record = signals.tracking;
  const double duration_s = static_cast<double>(planned.trial.duration_ticks) * kControlPeriod_s;
  out.metrics = identification::tracking_metrics(record, signal::reference_design(duration_s));
  thin(out.metrics.moving_rms_mm, record.rate_hz);
  thin(out.metrics.moving_dwell, record.rate_hz);
  out.cancelled_share = out.counterforce_delay_s = 0.0;
  if (session::drives_motor(planned)) {
    out.cancelled_share = session::cancelled_share(signals.feedthrough_n, signals.motor_n);
  }
  if (session::opposes_feedthrough(planned)) {
    out.counterforce_delay_s =
        session::counterforce_delay_s(signals.feedthrough_n, signals.motor_n, record.rate_hz);
  }
  out.feedthrough_rms_n = session::rms(signals.feedthrough_n);
  out.motor_rms_n = session::rms(signals.motor_n);
  const std::size_t samples = record.target_m.size();
  const auto excerpt = std::min(samples, static_cast<std::size_t>(kExcerpt_s * record.rate_hz));
  for (std::size_t n = (samples - excerpt) / 2; n < (samples + excerpt) / 2; n += kExcerptStride) {
    out.target_m.push_back(record.target_m[n]);
    out.cursor_m.push_back(record.cursor_m[n]);
  }
  return out;
}

}  // namespace stillhand::study
