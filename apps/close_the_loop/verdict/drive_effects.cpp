// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/drive_effects.hpp"

#include "apps/close_the_loop/verdict/control_laws.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::close_the_loop {

namespace control = diagnosis::control;
using cancellation::Channel;

void add_drive_effect(const diagnosis::Effect& effect, double share, ConvertedModel& to) {
  const auto channel = channel_of(effect.channels.empty() ? "" : effect.channels.front());
  const diagnosis::ControlRole role = diagnosis::effect_kind(effect.kind).drive_role(effect);
  const auto treat = [&](bool cancelled, std::string how) {
    to.treatments.push_back({effect.kind, cancelled, std::move(how)});
  };
  if (const auto* friction = std::get_if<control::Friction>(&role);
      friction != nullptr && channel == Channel::kOmega) {
    // The motor's force is minus the model's: it pushes with the motion.
    to.model.paths.push_back(
        friction_path(*channel, friction->transition, -share * effect.coefficients.at(0)));
    treat(true, "the motor pushes with the motion");
  } else if (const auto* ripple = std::get_if<control::Waves>(&role);
             ripple != nullptr && channel == Channel::kTheta) {
    add_waves(effect, channel, ripple->frequency, -1.0, to.model);
    treat(true, "the motor opposes the ripple at each position");
  } else {
    const auto* left_out = std::get_if<control::LeftOut>(&role);
    treat(false, left_out != nullptr ? left_out->reason
                                     : "the canceller has no law for the drive from this channel");
  }
}

}  // namespace stillhand::close_the_loop
