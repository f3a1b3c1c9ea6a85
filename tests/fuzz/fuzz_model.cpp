// SPDX-License-Identifier: Apache-2.0
// Models from the bus, up to the motor's force: the first byte selects the topic, the rest is the
// message.  A model that the canceller takes runs for 600 ticks; the force must stay within the
// limits of the start-up settings.
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>

#include "idl/cdr.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/messages/cancellation/codec.hpp"

namespace {

using namespace stillhand;

// Longer than a model needs to settle and to fade in.
constexpr Tick kTicks = 600;

void exercise(const cancellation::ControlModel& model) {
  const cancellation::Config config;
  cancellation::Countermeasure canceller(config, {.force = true});
  if (canceller.load_model(model) != cancellation::Refusal::kNone) return;
  double last_n = 0.0;
  for (Tick tick = 0; tick < kTicks; ++tick) {
    cancellation::ChannelSample sensed{};
    const double t = static_cast<double>(tick);
    for (std::size_t i = 0; i < sensed.size(); ++i) {
      sensed[i] = 5.0 * std::sin(0.01 * t * static_cast<double>(i + 1));
    }
    const double force_n = canceller.step({tick, sensed, kGood, true, true, {}}).force_n;
    const double most_n = config.limits.max_slew_n_s * kControlPeriod_s * (1.0 + 1e-9);
    // Written so that a NaN is found, too.
    const bool bounded = std::abs(force_n) <= config.limits.max_force_n;
    const bool slow = std::abs(force_n - last_n) <= most_n;
    if (!bounded || !slow) std::abort();
    last_n = force_n;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const auto message = std::as_bytes(std::span(bytes + 1, size - 1));
  if (bytes[0] % 2 == 0) {
    stillhand_msgs::AugmentedModel model;
    if (from_cdr(message, model)) exercise(cancellation::from_idl(model));
  } else {
    stillhand_msgs::FeedthroughModel model;
    if (from_cdr(message, model)) {
      exercise(cancellation::control_model(cancellation::from_idl(model)));
    }
  }
  return 0;
}
