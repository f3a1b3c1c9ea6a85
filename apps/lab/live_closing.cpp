// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/live_closing.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "apps/lab/pause_diagnosis.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::lab {
namespace {

constexpr double kBefore_s = 10.0;
constexpr double kOffer_s = 30.0;

bool lost_its_model(const session::TrialOutcome& outcome) {
  return outcome.planned.label == session::Condition::kC &&
         std::ranges::any_of(outcome.marks, [&](const session::Mark& mark) {
           return !session::model_change(mark, outcome.planned.trial).empty();
         });
}

// The next line that a person types at the terminal; nothing waits for it.
class TypedLine {
 public:
  // Standard input is a terminal.  It stops a program in its background that reads it, or takes
  // away what was typed.
  static bool possible() {
    const pid_t in_front = tcgetpgrp(STDIN_FILENO);  // -1: not the terminal of this session
    return isatty(STDIN_FILENO) != 0 && (in_front < 0 || in_front == getpgrp());
  }
  // What was typed before does not count.
  TypedLine() { tcflush(STDIN_FILENO, TCIFLUSH); }

  // A terminal hands over whole lines.  One that is gone has no more of them.
  bool is_there() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, 0) <= 0) return false;
    std::array<char, 256> typed{};
    const ssize_t size = read(STDIN_FILENO, typed.data(), typed.size());
    if (size > 0) text_.assign(typed.data(), static_cast<std::size_t>(size));
    if (text_.ends_with('\n')) text_.pop_back();
    return true;
  }
  // Without its end.
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  std::string text_;
};

}  // namespace

std::vector<session::PlannedTrial> closing_trials(const session::ProtocolOptions& protocol) {
  const auto number = static_cast<std::int64_t>(session::plan(protocol).size());
  return {session::identification_again(protocol, number),
          session::tracking_trial(protocol, session::Condition::kC, number + 1)};
}

bool LiveClosing::after(const session::TrialOutcome& outcome) {
  return !lost_its_model(outcome) || close();
}

bool LiveClosing::close() {
  const session::PlannedTrial pegged = closing_trials(options_.protocol).front();
  trials_.say(
      fmt::format("the arm is identified again in {:.0f} s: hold the stick as in the first "
                  "identification",
                  kBefore_s));
  trials_.show({.kind = PromptKind::kIdentification,
                .wait_s = kBefore_s + kTrialLead_s + options_.protocol.ramp_s});
  trials_.rest("before the identification", kBefore_s, {});
  if (trials_.interrupted()) return false;
  const session::TrialOutcome identified = trials_.run_between(pegged);
  if (!identified.completed) return false;
  if (!identified.no_model.empty()) {
    trials_.say("the session goes on with its model: " + identified.no_model);
    return true;
  }
  const std::int64_t next = identified.planned.trial.number + 1;
  const PauseVerdict verdict = diagnose_in_pause(options_, trials_);
  if (trials_.interrupted()) return false;
  if (!verdict.why_not.empty()) {
    trials_.say(
        fmt::format("trial {} runs C with the model identified again: {}", next, verdict.why_not));
    return run_again(false);
  }
  return run_again(takes(verdict, next) && give_plus(next));
}

bool LiveClosing::takes(const PauseVerdict& verdict, std::int64_t number) {
  if (options_.headless || !TypedLine::possible()) {
    trials_.say(fmt::format("C+ {} for trial {}, {}", verdict.certain ? "taken" : "not taken",
                            number, verdict.found));
    return verdict.certain;
  }
  trials_.say(
      fmt::format("C+ offered for trial {}, {}; enter y within {:.0f} s to run it, else C "
                  "goes on",
                  number, verdict.found, kOffer_s));
  TypedLine line;
  trials_.rest("C+ is offered", kOffer_s, [&] { return line.is_there(); });
  const bool taken = line.text() == "y";
  trials_.say(fmt::format("C+ {} for trial {}", taken ? "taken" : "not taken", number));
  return taken;
}

bool LiveClosing::give_plus(std::int64_t number) {
  std::string refused;
  try {
    refused = trials_.use(diagnosed_model(options_));
  } catch (const ConfigError& error) {
    refused = error.what();
  }
  if (refused.empty()) return true;
  trials_.say(fmt::format("C+ does not run in trial {}: {}", number, refused));
  return false;
}

bool LiveClosing::run_again(bool plus) {
  if (trials_.interrupted()) return false;
  session::PlannedTrial again = closing_trials(options_.protocol).back();
  if (plus) again.label = session::Condition::kCPlus;
  trials_.show({.kind = PromptKind::kTrial, .wait_s = kTrialLead_s + options_.protocol.ramp_s});
  if (!trials_.run_between(again).completed) return false;
  if (!plus || trials_.interrupted()) return !trials_.interrupted();
  // What the plan still has begins with the session's own model, as it would have.
  const cancellation::ControlModel own = cancellation::control_model(trials_.model().control);
  if (const std::string refused = trials_.use(own); !refused.empty()) {
    throw std::runtime_error("the session's own model behind C+: " + refused);
  }
  return true;
}

}  // namespace stillhand::lab
