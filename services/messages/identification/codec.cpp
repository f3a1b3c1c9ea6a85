// SPDX-License-Identifier: Apache-2.0
#include "services/messages/identification/codec.hpp"

namespace stillhand::identification {

stillhand_msgs::FeedthroughModel to_idl(const FeedthroughModel& model, std::int32_t number,
                                        std::int32_t trial) {
  stillhand_msgs::FeedthroughModel message;
  message.model(number);
  message.trial(trial);
  message.fit_rate_hz(model.fit.rate_hz);
  message.fit_numerator(model.fit.numerator);
  message.fit_denominator(model.fit.denominator);
  message.control_rate_hz(model.control.rate_hz);
  message.control_numerator(model.control.numerator);
  message.control_denominator(model.control.denominator);
  message.heldout_vaf_percent(model.heldout.free_run_vaf_percent);
  message.heldout_rmse_n(model.heldout.free_run_rms_n);
  message.conversion_error(model.conversion_error);
  message.usable(true);
  return message;
}

stillhand_msgs::FeedthroughModel to_idl(const Identification& outcome, std::int32_t number,
                                        std::int32_t trial) {
  if (outcome.model) return to_idl(*outcome.model, number, trial);
  stillhand_msgs::FeedthroughModel message;
  message.model(number);
  message.trial(trial);
  message.usable(false);
  constexpr std::size_t kRoom = 199;  // string<200> in idl/model.idl
  message.text(outcome.why_not.substr(0, kRoom));
  return message;
}

FeedthroughModel from_idl(const stillhand_msgs::FeedthroughModel& message) {
  FeedthroughModel model;
  model.fit = {message.fit_rate_hz(), message.fit_numerator(), message.fit_denominator()};
  model.control = {message.control_rate_hz(), message.control_numerator(),
                   message.control_denominator()};
  model.heldout.free_run_vaf_percent = message.heldout_vaf_percent();
  model.heldout.free_run_rms_n = message.heldout_rmse_n();
  model.conversion_error = message.conversion_error();
  return model;
}

}  // namespace stillhand::identification
