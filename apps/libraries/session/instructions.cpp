// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/instructions.hpp"

namespace stillhand::session {

std::vector<std::string> instructions(const std::string& who) {
  std::vector<std::string> lines{
      "A white box moves to the left and to the right.",
      "Keep the cross inside the box, as well as you can, until the time is over."};
  if (who == "mouse") {
    lines.emplace_back(
        "Point with the mouse to where the cross shall be: a simulated arm moves it there.");
  } else if (who == "gamepad") {
    lines.emplace_back(
        "Push the left stick to where the cross shall be: a simulated arm moves it there.");
  } else {
    lines.emplace_back("Move the cross with the stick. Hold the stick with your whole hand.");
  }
  lines.emplace_back(
      "In some trials the platform moves and shakes the arm. Track the box all the same.");
  lines.emplace_back(
      "You may stop at any time: say so, or press Escape. Then everything stops at once.");
  return lines;
}

std::string text_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace stillhand::session
