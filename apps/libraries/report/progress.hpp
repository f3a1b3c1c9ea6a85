// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::report {

/// Progress of long work: a bar on a terminal, nothing in a pipe.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine() { finish(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// @param done  share of the step in [0, 1]
  void show(const std::string& step, double done);
  /// Ends the bar's line, before other output.
  void finish();

 private:
  bool terminal_;
  std::string step_;
  int shown_percent_ = -1;
};

}  // namespace stillhand::report
