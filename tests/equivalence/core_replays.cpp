// SPDX-License-Identifier: Apache-2.0
#include "tests/equivalence/core_replays.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "services/bus/trial_codec.hpp"
#include "services/core/cancellation/parts/recipe.hpp"
#include "services/core/human_operator/subject_config.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/vehicle/vehicle_settings.hpp"
#include "services/messages/cancellation/codec.hpp"
#include "services/messages/display/codec.hpp"
#include "services/messages/human_operator/codec.hpp"
#include "services/messages/motion/codec.hpp"
#include "services/messages/rig/codec.hpp"
#include "services/messages/sensing/codec.hpp"
#include "services/messages/vehicle/codec.hpp"
#include "tests/equivalence/recorded_trial.hpp"

namespace stillhand::equivalence {
namespace {

namespace msgs = stillhand_msgs;

/// Seeds of the cores are 32-bit numbers.
std::int64_t core_seed(const SessionSettings& settings) {
  return static_cast<std::int64_t>(settings.seed & 0xffffffffu);
}

/// For cores whose steps depend on their input alone.
constexpr auto kAlways = [](const auto&, const auto&) { return true; };
constexpr auto kSameTrial = [](const auto& a, const auto& b) { return a.trial() == b.trial(); };

/// The parts of a trial, of the model of position that the session had identified before it.
cancellation::PartList recorded_parts(const SessionRecording& session,
                                      const cancellation::Config& config, std::int64_t trial) {
  std::optional<signal::DifferenceModel> position;
  for (const msgs::FeedthroughModel& model : session.models) {
    if (!model.usable() || model.trial() >= trial || !model.to_position()) continue;
    position = {model.control_rate_hz(), model.control_numerator(), model.control_denominator()};
  }
  return cancellation::PartList(recipe_of(
      cancellation::parts_of(of_trial(session.trial_assignments, trial)), position, config));
}

/// What the display took off the stick's angle.  In recordings from before it did so, `tick` is 0.
display::TakenOff taken_off(const ByTick<msgs::MotorCommand>& commands, Tick tick) {
  if (tick <= 0) return {};
  // A command that only the recorder lost, where the one before took nothing off.
  const bool nothing =
      !commands.has(tick) && commands.has(tick - 1) && commands.at(tick - 1).taken_off_rad() == 0.0;
  return nothing ? display::TakenOff{tick, 0.0} : display::from_idl(commands.at(tick));
}

}  // namespace

Replay replay_sensing(const SessionRecording& session, const SessionSettings& settings) {
  sensing::Conditioner core(settings.of<sensing::Config>("sensing"));
  const ByTick raws("raw_sample", session.raw_samples);
  const auto step = [&](Tick tick, const msgs::Sensed&) {
    const msgs::RawSample& raw = raws.at(tick);
    return sensing::to_idl(core.step(sensing::from_idl(raw)), raw);
  };
  return replay("sensing", session.sensed, step, kAlways);
}

Replay replay_motion(const SessionRecording& session, const SessionSettings& settings) {
  const auto config = settings.of<motion::MotionGenerator::Config>("motion");
  motion::MotionGenerator core(config);
  std::int64_t armed = -1;
  const auto step = [&](Tick tick, const msgs::PlatformCommand& like) {
    if (like.trial() != armed) {
      const Trial trial = runtime::from_idl(of_trial(session.trial_controls, like.trial()));
      const auto profile =
          motion::from_idl(of_trial(session.trial_assignments, like.trial()), trial);
      if (profile.kind == motion::MotionKind::kRide) {
        throw NotRecorded("the ride's own samples are not in the recording");
      }
      core.arm(motion::MotionTrajectory(profile, config.limits), trial);
      armed = like.trial();
    }
    return motion::to_idl(core.step(tick), tick, armed);
  };
  return replay("motion", session.platform_commands, step, kSameTrial);
}

Replay replay_vehicle(const SessionRecording& session, const SessionSettings& settings,
                      const std::string& vehicle) {
  const auto limits = settings.of<motion::MotionGenerator::Config>("motion").limits;
  vehicle::DrivenMotion core(
      vehicle::driven_config(limits, settings.of<vehicle::VehicleSettings>("vehicle"), vehicle));
  const ByTick sensed("sensed", session.sensed);
  std::int64_t armed = -1;
  const auto step = [&](Tick tick, const msgs::PlatformCommand& like) {
    if (like.trial() != armed) {
      const Trial trial = runtime::from_idl(of_trial(session.trial_controls, like.trial()));
      const auto& assignment = of_trial(session.trial_assignments, like.trial());
      const bool driven = vehicle::driven(assignment, trial);
      motion::MotionTrajectory trajectory;
      if (!driven)
        trajectory = motion::MotionTrajectory(motion::from_idl(assignment, trial), limits);
      core.arm(std::move(trajectory), trial, driven);
      armed = like.trial();
    }
    // The first commands answer ticks before the first sample.  Later, a sample that the live core
    // did not get is flagged stale; the command that ends a drive is a brake, which is so, too.
    const Tick of_stick = tick - vehicle::kLead_ticks;
    vehicle::StickSample sample{of_stick, 0.0, false};
    const bool lost = (like.flags() & kInputStale) != 0 && (like.flags() & kFault) == 0;
    if (!lost && sensed.has(of_stick)) sample = vehicle::from_idl(sensed.at(of_stick));
    return motion::to_idl(core.step(sample), tick, armed);
  };
  return replay("vehicle", session.platform_commands, step, kSameTrial);
}

Replay replay_cancellation(const SessionRecording& session, const SessionSettings& settings) {
  const auto config = settings.of<cancellation::Config>("cancellation");
  cancellation::Countermeasure core(config);
  std::map<std::int64_t, cancellation::PartList> parts;  // of C by 0, and of trials
  parts.emplace(0, cancellation::Recipe{.force = true});
  const ByTick sensed("sensed", session.sensed);
  std::int32_t offered = -1;
  std::int32_t control_model = -1;
  // The canceller's model by its number; one that was refused is never named.
  const auto load_control_model = [&](std::int32_t number) {
    if (number < cancellation::kFirstControlModel || number == control_model) return;
    const auto model =
        std::find_if(session.control_models.begin(), session.control_models.end(),
                     [&](const auto& candidate) { return candidate.model() == number; });
    if (model == session.control_models.end()) {
      throw NotRecorded("model " + std::to_string(number) + " is not in the recording");
    }
    core.load_model(cancellation::from_idl(*model));
    control_model = number;
  };
  const auto step = [&](Tick tick, const msgs::MotorCommand& like) {
    load_control_model(like.model());
    // A model changes the core in the step that names it; one that was refused is never named.
    for (; like.model() < cancellation::kFirstControlModel && offered < like.model(); ++offered) {
      const auto model =
          std::find_if(session.models.begin(), session.models.end(),
                       [&](const auto& candidate) { return candidate.model() == offered + 1; });
      if (model == session.models.end()) {
        throw NotRecorded("model " + std::to_string(offered + 1) + " is not in the recording");
      }
      if (model->usable() && !model->to_position())
        core.load_model(cancellation::control_model(cancellation::from_idl(*model)));
    }
    const msgs::Sensed& sample = sensed.at(tick);
    const std::int64_t trial = like.mitigated_trial();
    if (!parts.contains(trial)) parts.emplace(trial, recorded_parts(session, config, trial));
    if (!core.runs(parts.at(trial))) core.use(parts.at(trial));
    const auto input = cancellation::from_idl(sample, like.enabled(), like.permitted());
    return cancellation::to_idl(core.step(input), input, sample, like.model(), trial);
  };
  const auto agree = [](const msgs::MotorCommand& a, const msgs::MotorCommand& b) {
    return a.enabled() == b.enabled() && a.permitted() == b.permitted() && a.model() == b.model() &&
           a.mitigated_trial() == b.mitigated_trial();
  };
  return replay("cancellation", session.motor_commands, step, agree);
}

Replay replay_display(const SessionRecording& session, const SessionSettings& settings) {
  const auto config = settings.of<display::TrackingDisplay::Config>("display");
  display::TrackingDisplay core(config);
  const ByTick sensed("sensed", session.sensed);
  const ByTick commands("motor_command", session.motor_commands);
  std::int64_t armed = -1;
  const auto step = [&](Tick tick, const msgs::TrackingSample& like) {
    if (like.trial() != armed) {
      const msgs::TrialControl& control = of_trial(session.trial_controls, like.trial());
      const Trial trial = runtime::from_idl(control);
      if (trial.phase == TrialPhase::kTracking) {
        core.arm(
            display::reference_on_screen(config, trial.duration_ticks, control.reference_seed()),
            trial);
      } else {
        core.disarm();
      }
      armed = like.trial();
    }
    const display::TakenOff off = taken_off(commands, like.command_tick());
    return display::to_idl(core.step(display::from_idl(sensed.at(tick), off)), tick, armed,
                           like.command_tick());
  };
  return replay("display", session.tracking_samples, step, kSameTrial);
}

Replay replay_human_operator(const SessionRecording& session, const SessionSettings& settings) {
  auto config = settings.of<human_operator::SubjectConfig>("human_operator");
  config.crossover.seed = core_seed(settings);
  human_operator::CrossoverOperator core(config.crossover);
  const ByTick tracking("tracking_sample", session.tracking_samples);
  const ByTick sensed("sensed", session.sensed);
  std::int64_t armed = -1;
  const auto step = [&](Tick tick, const msgs::OperatorForce& like) {
    if (like.trial() != armed) {
      core.arm(runtime::from_idl(of_trial(session.trial_controls, like.trial())));
      armed = like.trial();
    }
    const auto input =
        human_operator::from_idl(tracking.at(tick), like.active(), sensed.at(tick).accel_y_m_s2());
    return human_operator::to_idl(core.step(input), input, armed);
  };
  const auto agree = [](const msgs::OperatorForce& a, const msgs::OperatorForce& b) {
    return a.active() == b.active() && a.trial() == b.trial();
  };
  return replay("human_operator", session.operator_forces, step, agree);
}

Replay replay_rig(const SessionRecording& session, const SessionSettings& settings) {
  auto config = settings.of<rig::RigConfig>("rig");
  config.seed = core_seed(settings);
  rig::Rig core(config);
  const ByTick commands("platform_command", session.platform_commands);
  const ByTick motors("motor_command", session.motor_commands);
  const ByTick forces("operator_force", session.operator_forces);
  std::vector<msgs::RawSample> raws;
  const auto step = [&](Tick tick, const msgs::RigTruth& like) {
    if (raws.empty() && tick != 0) throw NotRecorded("the rig's first ticks are not recorded");
    auto input =
        rig::make_input(tick, commands.used(like.command_tick()), motors.used(like.motor_tick()),
                        forces.used(like.operator_tick()), like.pegged(), like.motor_permitted());
    if (like.command_tick() == rig::UsedTicks::kHeld) input.leave = MotionLeave::kHold;
    const bool same_tick = config.motor.answers_in_tick();
    auto output = same_tick ? core.sample(input) : core.step(input);
    raws.push_back(rig::to_idl(output, tick));
    if (same_tick) core.drive(input, output);
    return rig::to_idl(output, tick, input,
                       {like.command_tick(), like.motor_tick(), like.operator_tick()});
  };
  // The inputs of a lost truth are not recorded anywhere else.
  const auto never = [](const msgs::RigTruth&, const msgs::RigTruth&) { return false; };
  Replay result = replay("rig", session.rig_truths, step, never);
  result.recorded += std::ssize(session.raw_samples);
  const ByTick recorded("raw_sample", session.raw_samples);
  for (const msgs::RawSample& raw : raws) {
    if (recorded.has(raw.tick())) {
      compare(raw, recorded.at(raw.tick()), raw.tick(), result);
    } else {
      ++result.unrecorded;
    }
  }
  return result;
}

}  // namespace stillhand::equivalence
