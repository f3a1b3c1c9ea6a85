// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/core/contract/tick.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/display/answering.hpp"
#include "services/core/display/prompt.hpp"

namespace stillhand::display {

/// What a page depends on besides the prompt.
struct Moment {
  Tick tick = -1;        ///< newest; -1: none yet
  Trial trial = {};      ///< newest that was announced
  bool paused = false;   ///< no trial begins before the experimenter starts it
  bool fresh = true;     ///< a tick came within the last 0.1 s
  bool gamepad = false;  ///< its buttons answer, too
};

/// The words of one frame.  They depend on prompt, tick and trial alone, none of which holds the
/// condition: the participant is blinded.
struct Page {
  bool task = true;          ///< box and cross are drawn
  std::string corner_left;   ///< "Trial 4 of 12"
  std::string corner_right;  ///< time left of the measured part, "2:51"
  std::string heading;
  std::vector<std::string> lines;
  std::string caption;  ///< above the large text
  std::string large;    ///< the countdown
  std::string below;    ///< below the large text
  std::string lowest, highest;
  std::int64_t steps = 0;    ///< boxes of a scale; 0: none
  std::int64_t chosen = 0;   ///< box that is filled; 0: none
  std::string button;        ///< empty: none
  bool button_works = true;  ///< something is chosen
  std::string hint;          ///< at the foot
  std::string rig;           ///< below it: which parts of the rig are devices; empty: none

  bool operator==(const Page&) const = default;
};

/// Eq. DI-8: the page of prompt, moment and choice.  Pure.
Page page_of(const Prompt& prompt, const Moment& moment, const Answering& answering);

/// "2:51" of 170.2 s: whole seconds, rounded up, at most 99:59:59.
std::string clock_text(double seconds);

}  // namespace stillhand::display
