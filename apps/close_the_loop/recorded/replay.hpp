// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/diagnosis/carried.hpp"
#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/statistics/ratio.hpp"

namespace stillhand::close_the_loop {

/// RMS of a signal about its mean over a record, METHOD Eq. CL-6.
struct Level {
  double rms = 0.0;                                     ///< in the output's unit
  std::optional<std::pair<double, double>> interval95;  ///< none with fewer than three blocks
  std::vector<double> block_mean_squares;               ///< of blocks of 10 s, in order
};

/// Twelve seconds from the middle of the longest stretch, for figures.
struct Excerpt {
  double rate_hz = 0.0;
  std::vector<double> force;
  std::vector<double> left;
};

/// What a record of the pegged stick keeps of its force under a model, METHOD Eq. CL-6.
struct Remaining {
  Level without;  ///< the force itself
  Level left;     ///< the force less the prediction, or plus the motor's
  Excerpt excerpt;
  double limited_share = 0.0;  ///< [-] of the time in which the canceller's limits held the motor
  /// 1 - rms(left) / rms(without), with its 95 % interval over the blocks where there is one.
  [[nodiscard]] double cut() const { return 1.0 - left.rms / without.rms; }
  [[nodiscard]] std::optional<std::pair<double, double>> cut_interval95() const;
};

/// Subtracts the model's free run from the record, as a canceller without limits or delay would.
/// @throws stillhand::ConfigError as predict()
Remaining left_by_prediction(const diagnosis::CarriedModel& model,
                             const diagnosis::Measurement& record);

/// Runs the record's channels through canceller and motor of the rig at 1 kHz and adds the motor's
/// force: limits, fades, lags and the delay of a tick act as in a session.
/// @param output  channel of the force [N]
/// @param late_s  [s] delay of the motor path beyond the rig's
/// @param from_s  [s] of each stretch that at least do not count, so that two models are judged on
///                the same samples; as long as the model needs if it is less
/// @throws stillhand::ConfigError if the canceller refuses the model; it reports why
Remaining left_by_motor(const cancellation::ControlModel& model,
                        const diagnosis::Measurement& record, const std::string& output,
                        double late_s = 0.0, double from_s = 0.0);

/// A channel of one stretch at 1 kHz.
std::vector<double> at_control_rate(const std::vector<double>& values,
                                    const diagnosis::Stretch& stretch, double rate_hz);
/// Every channel that a model may read, at 1 kHz; those that the record lacks are 0.
std::vector<cancellation::ChannelSample> sensed(const diagnosis::Measurement& record,
                                                const diagnosis::Stretch& stretch);

/// [s] of each stretch that do not count: until the model has settled and faded in.
double settled_after_s(const cancellation::ControlModel& model);

/// Several records as one: over all of their whole blocks, or, where these are too few for an
/// interval, over their time.
/// @param seconds  [s] length of each record
Level pooled(const std::vector<Level>& levels, const std::vector<double>& seconds);

/// RMS that the better of two models of one record explains beyond the other, over the blocks of
/// both (diagnosis, Eq. DG-76); 0 if it leaves more.
Level explained_beyond(const Level& left_before, const Level& left_after);

/// The last part of a record, and what comes before it.
std::pair<diagnosis::Measurement, diagnosis::Measurement> split_off_end(
    const diagnosis::Measurement& record, double share);

}  // namespace stillhand::close_the_loop
