// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/lab/core/stage.hpp"
#include "apps/lab/core/trouble.hpp"

namespace stillhand::lab {

/// A prompt that waits for the participant's answer.  It ends with an answer that fits, with a
/// request for a start (the participant does not answer), after its time, or when there is trouble.
///
/// An answer beyond 1 to `steps` is refused with a note, the first one of each prompt.  Answers to
/// earlier prompts are repetitions: they count no more, without a note.
class Asking final : public Stage {
 public:
  /// @param what      for the person at the terminal
  /// @param number    of the prompt that is shown
  /// @param limit_s   [s] longest wait; none: until somebody acts
  Asking(std::string what, std::uint64_t number, std::int64_t steps, std::optional<double> limit_s,
         Trouble& trouble)
      : what_(std::move(what)),
        number_(number),
        steps_(steps),
        limit_s_(limit_s),
        trouble_(trouble) {}

  Actions step(Seen& seen, std::int64_t now_ns) override;
  /// Valid once over(); none: no answer.
  [[nodiscard]] const std::optional<std::int64_t>& answer() const noexcept { return answer_; }

 private:
  void take_answers(Seen& seen, Actions& actions);

  std::string what_;
  std::uint64_t number_;
  std::int64_t steps_;
  std::optional<double> limit_s_;
  Trouble& trouble_;
  std::optional<std::int64_t> answer_;
  std::int64_t begin_ns_ = -1;  // -1: before the first step
  std::int64_t starts_ = 0;     // requests for a start at the first step
  bool refused_ = false;
};

}  // namespace stillhand::lab
