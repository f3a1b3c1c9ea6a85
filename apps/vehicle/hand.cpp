// SPDX-License-Identifier: Apache-2.0
#include "apps/vehicle/hand.hpp"

#include <complex>
#include <cstddef>
#include <utility>
#include <vector>

#include "services/core/signal/difference_model.hpp"

namespace stillhand::vehicle {
namespace {

// Amplitudes: own choice, within the bounds of the admittance library's defaults.
admittance::Excitation excitation(const IdentifyPlan& plan, std::uint64_t seed) {
  admittance::ExcitationConfig config;
  config.lowest_hz = 0.4;
  config.highest_hz = 9.0;
  config.lines = plan.lines;
  config.seed = static_cast<std::int64_t>(seed & 0xffffffffu);
  return admittance::design(config);
}

IdentifiedResponse response_of(const std::vector<admittance::LineResponse>& lines) {
  IdentifiedResponse out;
  for (const admittance::LineResponse& line : lines) {
    out.frequency_hz.push_back(line.frequency_hz);
    out.response.push_back(line.response);
    out.variance.push_back(line.variance);
  }
  return out;
}

}  // namespace

IdentifiedHand identify_hand(const DriveConfigs& configs, std::uint64_t seed,
                             const IdentifyPlan& plan) {
  DriveLoop loop(configs, seed);
  IdentifiedHand hand;
  hand.model = identification::identify(loop.pegged(plan.pegged_s, seed));
  const admittance::Excitation design = excitation(plan, seed);
  FreeStick free = loop.free_stick(design, plan.periods);
  const admittance::LineEstimates stick = admittance::estimate(free.record, design);
  free.record.displacement_m = std::move(free.sensed_acceleration_m_s2);
  const admittance::LineEstimates sensed = admittance::estimate(free.record, design);

  hand.feedthrough = response_of(stick.feedthrough_to_position);
  const IdentifiedResponse per_force = response_of(stick.stick_per_force);
  hand.cancelled = hand.feedthrough;
  hand.from_pegged = hand.feedthrough;
  hand.from_pegged.variance.clear();
  for (std::size_t k = 0; k < hand.feedthrough.response.size(); ++k) {
    const double f = hand.feedthrough.frequency_hz[k];
    const std::complex<double> predicted =
        signal::response_at(hand.model.control, f) * sensed.feedthrough_to_position[k].response;
    // Force and motion lines take turns: the force line of the same number is the neighbour.
    hand.from_pegged.response[k] = per_force.at(f) * predicted;
    hand.cancelled.response[k] -= hand.from_pegged.response[k];
    hand.cancelled.variance[k] += std::norm(predicted) * per_force.variance[k];
  }
  return hand;
}

}  // namespace stillhand::vehicle
