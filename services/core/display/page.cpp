// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace stillhand::display {
namespace {

double seconds(Tick ticks) {
  return static_cast<double>(std::max<Tick>(ticks, 0)) * kControlPeriod_s;
}

std::string of(std::int64_t place, std::int64_t all) {
  if (place <= 0) return "";
  return " " + std::to_string(place) + (all > 0 ? " of " + std::to_string(all) : "");
}

std::string name_of(const Prompt& prompt, const Trial& trial) {
  if (prompt.kind == PromptKind::kPractice) return "Practice" + of(prompt.trial, 0);
  if (prompt.kind == PromptKind::kTrial) return "Trial" + of(prompt.trial, prompt.trials);
  return trial.number >= 0 ? "Trial" + of(trial.number + 1, 0) : "";
}

// The last number of a countdown is 1: it stands for the second before the begin.
// @param left_ticks  1 or more
void count_down(Page& page, Tick left_ticks) {
  const double left_s = seconds(left_ticks);
  page.large =
      left_s > 10.0 ? clock_text(left_s) : std::to_string(static_cast<long>(std::ceil(left_s)));
}

Page link_lost(const Prompt& prompt, const Moment& moment) {
  Page page;
  page.corner_left = name_of(prompt, moment.trial);
  page.heading = "Link lost";
  page.lines = {"The picture is old. Please wait."};
  return page;
}

// From the announcement until the trial's motion begins.
std::string seat(const Moment& moment) {
  const bool comes = moment.tick < moment.trial.start_tick - moment.trial.ramp_ticks;
  return comes ? "The seat moves slowly to its place" : "";
}

// Before, during and after the measured part of a tracking trial.
Page tracking(const Prompt& prompt, const Moment& moment) {
  const Trial& trial = moment.trial;
  Page page;
  page.corner_left = name_of(prompt, trial);
  const Tick end_tick = trial.start_tick + trial.duration_ticks;
  page.corner_right = clock_text(seconds(end_tick - std::max(moment.tick, trial.start_tick)));
  if (moment.tick < trial.start_tick) {
    page.heading = page.corner_left;
    page.caption = "begins in";
    count_down(page, trial.start_tick - moment.tick);
    page.below = seat(moment);
  } else if (moment.tick >= end_tick) {
    page.heading = "Over";
  }
  return page;
}

// A free stick is held still where the target stands: in the centre.  It is no trial of the
// protocol, so it has no number; what to do stays on the screen, since nothing waits before it.
Page held(const Prompt& prompt, const Moment& moment) {
  const Trial& trial = moment.trial;
  Page page = tracking(prompt, moment);
  page.corner_left = "Measurement";
  if (moment.tick < trial.start_tick) page.heading = page.corner_left;
  if (moment.tick >= trial.start_tick + trial.duration_ticks) return page;
  if (prompt.kind == PromptKind::kInstructions) page.lines = prompt.lines;
  if (page.lines.empty()) {
    page.lines = {"Hold the stick still.", "Keep the cross in the box, which does not move."};
  }
  return page;
}

Page pegged(const Prompt& prompt, const Moment& moment) {
  const Trial& trial = moment.trial;
  Page page;
  page.task = false;
  page.heading = prompt.kind == PromptKind::kInstructions ? "What you will do" : "Measurement";
  page.lines = prompt.lines;
  if (page.lines.empty()) {
    page.lines = {"The stick is held in place.",
                  "Let your hand rest on it. There is nothing to do."};
  }
  const Tick end_tick = trial.start_tick + trial.duration_ticks;
  const Tick left_ticks = end_tick - std::max(moment.tick, trial.start_tick);
  page.caption = prompt.kind == PromptKind::kInstructions ? "The stick is held until then" : "";
  page.large = clock_text(seconds(left_ticks));
  page.below = seat(moment);
  return page;
}

// What the participant can do to a page.
std::string hint_of(const Page& page, bool one_step, bool gamepad) {
  if (one_step) {
    return gamepad ? "First button (A), Enter, or a click on the button"
                   : "Enter, Space, or a click on the button";
  }
  if (page.chosen == 0) {
    return gamepad ? "Press left or right, or a number" : "Press a number, or click on it";
  }
  return gamepad ? "First button (A) or Enter confirms; left and right change the answer"
                 : "Enter or OK confirms; another number changes the answer";
}

void add_scale(Page& page, const Prompt& prompt, const Answering& answering, bool gamepad) {
  const bool given = answering.answer().has_value();
  if (prompt.steps == 1) {
    page.button = given ? "" : prompt.kind == PromptKind::kEnd ? "Close" : "Continue";
    page.hint = given ? "Please wait" : hint_of(page, true, gamepad);
    return;
  }
  page.steps = std::min(prompt.steps, kMostSteps);
  page.lowest = prompt.lowest;
  page.highest = prompt.highest;
  page.chosen = answering.chosen();
  page.button = given ? "" : "OK";
  page.button_works = page.chosen > 0;
  page.hint = given ? "Thank you" : hint_of(page, false, gamepad);
}

Page asking(const Prompt& prompt, const Answering& answering, bool gamepad) {
  Page page;
  page.task = false;
  page.lines = prompt.lines;
  if (prompt.kind == PromptKind::kInstructions) page.heading = "What you will do";
  if (prompt.kind == PromptKind::kEnd) {
    page.heading = "Thank you";
    if (page.lines.empty()) page.lines = {"That was the last trial. You are done."};
  }
  if (prompt.steps > 0) add_scale(page, prompt, answering, gamepad);
  return page;
}

Page waiting(const Prompt& prompt, const Moment& moment) {
  Page page;
  page.heading = name_of(prompt, moment.trial);
  if (moment.paused) {
    page.lines = {"Please wait: the experimenter starts it."};
  } else if (prompt.end_tick > moment.tick) {
    page.caption = "begins in";
    count_down(page, prompt.end_tick - moment.tick);
  } else {
    page.lines = {"Please wait"};
  }
  return page;
}

Page on_break(const Prompt& prompt, const Moment& moment) {
  Page page;
  page.task = false;
  page.heading = "Break";
  page.lines = prompt.lines;
  if (page.lines.empty()) page.lines = {"Let go, and rest."};
  if (prompt.end_tick >= 0) page.large = clock_text(seconds(prompt.end_tick - moment.tick));
  if (prompt.trial > 0) page.below = "Next: trial" + of(prompt.trial, prompt.trials);
  return page;
}

}  // namespace

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(std::clamp(seconds, 0.0, 359999.0)));
  char text[32];
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  }
  return text;
}

Page page_of(const Prompt& prompt, const Moment& moment, const Answering& answering) {
  const Trial& trial = moment.trial;
  const Tick over_tick = trial.start_tick + trial.duration_ticks + trial.ramp_ticks;
  const bool runs = trial.phase != TrialPhase::kIdle && moment.tick < over_tick;
  if (!moment.fresh && moment.tick >= 0) return link_lost(prompt, moment);
  if (runs && trial.phase == TrialPhase::kTracking) return tracking(prompt, moment);
  if (runs && trial.phase == TrialPhase::kFree) return held(prompt, moment);
  if (runs && trial.phase == TrialPhase::kPegged) return pegged(prompt, moment);
  switch (prompt.kind) {
    case PromptKind::kInstructions:
    case PromptKind::kQuestion:
    case PromptKind::kEnd:
      return asking(prompt, answering, moment.gamepad);
    case PromptKind::kBreak:
      return on_break(prompt, moment);
    case PromptKind::kIdentification:
    case PromptKind::kPractice:
    case PromptKind::kTrial:
      return waiting(prompt, moment);
    case PromptKind::kNothing:
      break;
  }
  Page page;
  page.heading = moment.paused || moment.tick < 0 ? "Please wait" : "Hold";
  return page;
}

}  // namespace stillhand::display
