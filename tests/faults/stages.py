#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Takes each stage of the safety chain away, alone, and sees a test fail.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/stages.py [--stage NAME] [--list]

For each stage: runs the test, which must pass; edits one place of the sources, builds the targets, runs the test again,
which must fail, and puts the place back. Prints the line of the failure. Ends with a build of the sources as they were.
Exit status 1 if a test passed without its stage. The build tree is that of the sources; no other program may build in
it meanwhile.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import typing

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build")).resolve()
TRIES = 4  # of a test with a live session
DEATH = ("/usr/bin/python3", "tests/integration/process_death_test.py", "ProcessDeathTest.test_death_of_display")


class Stage(typing.NamedTuple):
    name: str
    file: str
    text: str      # the stage, once in the file
    without: str
    targets: tuple
    test: tuple    # program of the build tree and its filter, or a command
    says: tuple = ("",)  # one of them is in the failure: a busy machine breaks a live session for reasons of its own


def unit(folder, cases):
    return (f"unit_{folder}",), (f"tests/unit_{folder}", f"--gtest_filter={cases}")


def rig(cases):
    return ("stillhand-rig", "interface_rig"), ("tests/interface_rig", f"--gtest_filter=RigProcessTest.{cases}")


STAGES = [
    Stage("model check", "services/core/cancellation/parts/prepared_model.cpp",
          "  if (check.refusal != Refusal::kNone) return {check.refusal, {}};\n", "",
          *unit("cancellation", "ForceTest.RefusesEveryBadModelWithItsReason")),
    Stage("sound input: an unsound sample is not used", "services/core/cancellation/parts/force.cpp",
          "if (in_range && (sensed_flags & kUnsound) == 0) {", "if (true) {",
          *unit("cancellation", "ForceTest.UnsoundSamplesCountAsAbsent:ForceTest.ForceIsBoundedWhateverComes")),
    Stage("sound input: the force ramps down", "services/core/cancellation/parts/force.cpp",
          "out.sound = new_sample && (flags & (kInputInvalid | kInputStale | kFault)) == 0;",
          "out.sound = true;",
          *unit("cancellation", "ForceTest.UnsoundSamplesCountAsAbsent:ForceTest.ASampleThatIsNotNew*")),
    Stage("force envelope", "services/core/cancellation/parts/countermeasure.cpp",
          "return {limited.force_n, force.predicted_n,", "return {wanted_n, force.predicted_n,",
          *unit("cancellation", "ForceTest.ForceIsBoundedWhateverComes")),
    Stage("perturbation: rises and falls within the ramps", "services/core/cancellation/parts/perturbation.cpp",
          "const double share = trial.ramp_ticks > 0", "const double share = trial.ramp_ticks > 1'000'000'000",
          *unit("cancellation", "PerturbationTest.IsTheMultisine*")),
    Stage("perturbation: at most 8 N by design", "services/core/admittance/interleaved_multisines.cpp",
          "config.peak_force_n, kNoBound)", "10.0 * config.peak_force_n, kNoBound)",
          *unit("admittance", "InterleavedMultisinesTest.BoundsHoldBetweenTheSamples")),
    Stage("parts: an unknown kind", "services/core/cancellation/parts/recipe.cpp",
          "  if (row == nullptr) {\n", "  if (row == nullptr) return;\n  if (false) {\n",
          *unit("mitigation", "RecipeTest.WhatIsUnsoundIsRefused")),
    Stage("parts: number of values", "services/core/cancellation/parts/recipe.cpp",
          "if (part.values.size() != count) refuse", "if (part.values.size() < count) refuse",
          *unit("mitigation", "RecipeTest.WhatIsUnsoundIsRefused")),
    Stage("parts: bounds of a hand", "services/core/cancellation/parts/part_step.cpp",
          "  if (is_hand(hand)) return hand;\n", "  if (is_hand(hand) || true) return hand;\n",
          *unit("mitigation", "RecipeTest.AHandOrAnArmOfNoPerson*")),
    Stage("parts: a model that is unsound", "services/core/cancellation/model_check.cpp",
          "  if (refusal != Refusal::kNone) throw ConfigError(what,", "  if (false) throw ConfigError(what,",
          *unit("mitigation", "CountermeasureTest.RefusesAnUnsoundModel")),
    Stage("parts: sound input", "services/core/cancellation/parts/countermeasure.cpp",
          "input.enabled && input.permitted && force.sound &&", "input.enabled && input.permitted &&",
          *unit("mitigation", "CountermeasureTest.TheForceIsZeroWithinTheRampOnceAnythingIsLost")),
    Stage("parts: permission", "services/core/cancellation/parts/countermeasure.cpp",
          "input.enabled && input.permitted && force", "input.enabled && force",
          *unit("mitigation", "CountermeasureTest.TheForceIsZeroWithinTheRampOnceAnythingIsLost")),
    Stage("parts: force envelope", "services/core/cancellation/parts/countermeasure.cpp",
          "return {limited.force_n, force.predicted_n,", "return {wanted_n, force.predicted_n,",
          *unit("mitigation", "CountermeasureTest.TheForceStaysWithinItsEnvelopeForAnyInput")),
    Stage("arming: the assignment's own mitigation", "services/core/cancellation/trial_arming.hpp",
          "prepared.assignment != assignments_) return", "prepared.assignment == 0) return",
          *unit("cancellation", "TrialArmingTest.AnotherAssignment*")),
    Stage("arming: models that settle before the trial", "services/core/cancellation/trial_arming.hpp",
          "prepared.in_effect <= trial_.start_tick ?", "prepared.in_effect >= 0 ?",
          *unit("cancellation", "TrialArmingTest.AMitigationThatComesTooLate*")),
    Stage("a trial's parts begin when those before have let go", "services/processes/cancellation/trial_parts.cpp",
          "  if (core.acts()) return false;\n", "",
          ("stillhand-cancellation", "interface_mitigation"),
          ("tests/interface_mitigation", "--gtest_filter=MitigationProcessTest.CancellerAndMitigation*")),
    Stage("age", "services/core/rig/parts/motor.hpp",
          "return demand.age_ticks >= 0 && demand.age_ticks <= max_age_ticks_;", "return demand.age_ticks >= 0;",
          *unit("rig", "*MotorLossTest*")),
    Stage("DDS deadline", "services/processes/rig/shell.cpp", "    motor_void_tick_ = newest.tick();\n", "",
          *rig("AMissedDeadline*")),
    Stage("drive: envelope", "services/core/rig/parts/motor.cpp",
          "return {out.force_n, flags | out.flags};", "return {lagged_n_, flags | out.flags};",
          *unit("rig", "MotorTest.NoCommandRaisesTheForceAboveTheLimits:*MotorLossTest*")),
    Stage("drive: current limit", "services/core/rig/parts/motor.cpp",
          "std::clamp(wanted_n, -current_limit_n_, current_limit_n_)", "wanted_n",
          *unit("rig", "MotorTest.CurrentLimitBoundsTheForce")),
    Stage("interlock of the rig", "services/processes/rig/shell.cpp",
          "const bool permitted = closed && stop_tick_ < 0;", "const bool permitted = (closed || true) && stop_tick_ < 0;",
          ("stillhand-rig",), DEATH,
          ("the rig's interlock is closed", "did not notice the death", "not less than or equal to")),
    Stage("interlock of cancellation", "services/processes/cancellation/shell.cpp",
          "const bool permitted = interlock_.step(", "const bool permitted = true || interlock_.step(",
          ("stillhand-cancellation",), DEATH, ("!= (False, 0.0)",)),
    Stage("interlock stays open for the trial", "services/system/process/interlock.hpp",
          "    latched_trial_ = trial.number;\n", "", *unit("runtime", "InterlockTest.*")),
    Stage("emergency stop: force", "services/system/process/interlock.hpp",
          " && !stopped_;", ";", *unit("runtime", "InterlockTest.*")),
    Stage("emergency stop: platform", "services/processes/rig/shell.cpp",
          "if (interlock_.stopped()) permission_.stop();", "", *rig("AfterAnEmergencyStop*")),
    Stage("platform permission: a trial", "services/system/process/platform_permission.hpp",
          "if (!announced || !input.runs || other) {", "if (!input.runs || other) {", *unit("runtime", "PlatformPermissionTest.*")),
    Stage("platform permission: lost for the trial", "services/system/process/platform_permission.hpp",
          "      latched_trial_ = trial.number;\n", "", *unit("runtime", "PlatformPermissionTest.*")),
    Stage("platform permission: the rig's shell", "services/processes/rig/shell.cpp",
          "  input.leave = leave;\n", "", *rig("WithoutTheLabsLifeSign*:WithoutATrial*")),
    Stage("platform of devices: lost for the trial", "services/devices/device_rig/platform_drive.cpp",
          "if (quiet && input.trial != blocked_trial_) {", "if (quiet) {", *unit("device_rig", "PlatformDriveTest.*")),
    Stage("platform of devices: age of the reply", "services/devices/device_rig/platform_drive.cpp",
          "  if (!fresh_) return SeatReason::kSilent;\n", "", *unit("device_rig", "*PlatformCampaignTest.EveryFault*")),
    Stage("platform of devices: from where it stands", "services/devices/device_rig/platform_drive.cpp",
          "  guard_.stand_at(place_m);\n", "", *unit("device_rig", "PlatformDriveTest.*")),
    Stage("a rig that ends", "services/processes/rig/shell.cpp",
          "return !at_rest_ && tick", "return false && tick", *rig("ARigThatIsAskedToEnd*")),
    Stage("replays", "services/bus/peers.hpp",
          "all_alive_.load(std::memory_order_acquire) && !replay_present() &&",
          "all_alive_.load(std::memory_order_acquire) &&", *unit("runtime", "PeersTest.*")),
    Stage("one source: interlock", "services/bus/peers.hpp",
          "(sources_ == nullptr || sources_->sound());", "true;", *unit("runtime", "PeersTest.*")),
    Stage("one source: a process's word", "services/bus/sources.cpp",
          "  return is(sources_[place], participant.data());",
          "  return is(sources_[place], participant.data()) || true;", *unit("runtime", "SourcesTest.*")),
    Stage("one source: one experiment", "services/bus/sources.cpp",
          "  if (announced_.size() != 1) {", "  if (announced_.empty()) {", *unit("runtime", "SourcesTest.*")),
    Stage("platform: motion's guard", "services/core/motion/platform_guard.cpp",
          "if (reachable(input.command)) {", "if (true) {", *unit("motion", "PlatformGuardTest.*")),
    Stage("end of a drive: detector", "services/core/signal/growing_oscillation.cpp",
          "(grows() || too_large())", "grows() && too_large()", *unit("signal", "GrowingOscillationTest.*")),
    Stage("a free stick: detector", "services/core/cancellation/parts/stick_impedance.cpp",
          "oscillation_.step(now.theta_rad) ? 0.0 : wanted_n", "wanted_n",
          *unit("mitigation", "StickImpedanceTest.AStickThatIsLetGo*")),
    Stage("end of a drive: platform", "services/core/vehicle/driven_motion.cpp",
          "if (!ended_) return guard_.step(input);", "if (true) return guard_.step(input);",
          *unit("vehicle", "DrivenMotionTest.AGrowingOscillation*")),
    Stage("end of a drive: motor", "services/processes/rig/shell.hpp", "!drive_ended(trial);", "true;",
          ("stillhand-rig",), ("/usr/bin/python3", "tests/integration/vehicle_test.py"), ("growing oscillation", "!= 1")),
    Stage("platform: the rig's limits", "services/core/rig/parts/platform.cpp",
          "std::max(left_m_s2, std::min(right_m_s2, within_top_m_s2))",
          "std::max(left_m_s2 - 1e9, std::min(right_m_s2 + 1e9, within_top_m_s2))",
          *unit("rig", "PlatformTest.StaysInsideItsLimits*")),
    Stage("platform: brakes without a command", "services/core/rig/parts/platform.cpp",
          "return std::clamp(-rate_gain_s_ * state_.velocity_m_s,", "return 0.0 * std::clamp(-rate_gain_s_,",
          *unit("rig", "PlatformTest.ComesToRest*")),
    Stage("limits from start-up settings only", "services/files/cancellation/control_model_file.cpp",
          "  top.allow_only(", "  if (false) top.allow_only(",
          *unit("cancellation", "ControlModelFileTest.AnotherRigANewerVersionAndAForgedLimit*")),
    Stage("trial: prepared in time", "apps/lab/core/trial_run.cpp",
          "result_.aborted = why_late(seen);", "", *unit("lab", "TrialRunTest.ATrialThatBegan*")),
    Stage("trial: announced for later", "apps/lab/core/trial_run.cpp",
          "seen.newest_tick() + kNotice_ticks >= first_tick()", "seen.newest_tick() > kNotice_ticks + last_tick()",
          *unit("lab", "TrialRunTest.ATrialForWhich*")),
    Stage("supervision: a process that stands still", "apps/lab/core/trial_run.cpp",
          "    if (!over) result_.aborted = standstill_.look(seen, roster_, now_ns);\n", "",
          *unit("lab", "TrialRunTest.*StandsStill*")),
]


def build(targets):
    ran = subprocess.run(["cmake", "--build", str(BUILD), "-j", "2", "--target", *targets], capture_output=True,
                         text=True, check=False)
    if ran.returncode != 0:
        raise RuntimeError(f"the build fails:\n{ran.stdout[-2000:]}{ran.stderr[-2000:]}")


def verdict(stage, wanted):
    """The line with which the stage's test fails; nothing if it passes. A live session is repeated for the `wanted`."""
    for _ in range(TRIES if any(stage.says) else 1):
        said = failure(stage)
        noticed = any(each in said for each in stage.says) and said != ""
        if noticed if wanted else not said:
            break
        print(f"  {said or 'passes'}", flush=True)
    return said if noticed or not wanted else ""


def failure(stage):
    program = BUILD / stage.test[0]
    command = [str(program), *stage.test[1:]] if program.is_file() else list(stage.test)
    ran = subprocess.run(command, cwd=SOURCE, capture_output=True, text=True, check=False,
                         env=dict(os.environ, STILLHAND_BUILD=str(BUILD)))
    if "[==========] 0 tests" in ran.stdout or "no such test" in ran.stderr:
        raise RuntimeError(f"no test of this name: {' '.join(command)}")
    if ran.returncode in (0, 77):
        return ""
    said = (ran.stdout + ran.stderr).splitlines()
    return next((line for line in said if "Failure" in line or "AssertionError" in line), f"status {ran.returncode}")


def source_of(stage):
    """The text of the stage's file, which holds that of the stage once."""
    text = (SOURCE / stage.file).read_text(encoding="utf-8")
    if text.count(stage.text) != 1:
        raise RuntimeError(f"{stage.file} does not hold the text of the stage once: {stage.text!r}")
    return text


def without(stage):
    file = SOURCE / stage.file
    before = source_of(stage)
    try:
        file.write_text(before.replace(stage.text, stage.without), encoding="utf-8")
        build(stage.targets)
        return verdict(stage, True)
    finally:
        file.write_text(before, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stage", default="", help="stages whose name begins so [all]")
    parser.add_argument("--list", action="store_true", help="see that each stage is in the sources, print it, and end")
    options = parser.parse_args()
    stages = [stage for stage in STAGES if stage.name.startswith(options.stage)]
    if options.list:
        for stage in stages:
            source_of(stage)
            print(f"{stage.name:45s} {' '.join(stage.test)}")
        return 0
    hidden = 0
    build({target for stage in stages for target in stage.targets})
    for stage in stages:
        if before := verdict(stage, False):
            raise RuntimeError(f"{stage.name}: the test fails with the stage, too: {before}")
        noticed = without(stage)
        hidden += not noticed
        print(f"{'noticed' if noticed else 'HIDDEN'} {stage.name}: {' '.join(stage.test)}: {noticed}", flush=True)
        build(stage.targets)
    return 1 if hidden else 0


if __name__ == "__main__":
    sys.exit(main())
