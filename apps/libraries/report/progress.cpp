// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace stillhand::report {

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressLine::show(const std::string& step, double done) {
  constexpr int kWidth = 30;
  const int percent = static_cast<int>(done * 100.0);
  if (step != step_) {
    finish();
    step_ = step;
  }
  if (!terminal_ || percent == shown_percent_) return;
  shown_percent_ = percent;
  std::string bar(static_cast<std::size_t>(kWidth), ' ');
  for (int i = 0; i < percent * kWidth / 100; ++i) bar[static_cast<std::size_t>(i)] = '=';
  std::fprintf(stderr, "\r%-32s [%s] %3d %%", step.c_str(), bar.c_str(), percent);
}

void ProgressLine::finish() {
  if (terminal_ && shown_percent_ >= 0) std::fputc('\n', stderr);
  shown_percent_ = -1;
  step_.clear();
}

}  // namespace stillhand::report
