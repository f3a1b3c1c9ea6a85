// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/written_trial.hpp"

#include <stdexcept>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::measurement {

SessionRows written_trial(const std::filesystem::path& file, const Trial& trial, bool tracking) {
  constexpr int kTries = 10;
  constexpr std::int64_t kPatience_ns = 700'000'000;
  constexpr double kMostMissing = 0.02;
  const auto least =
      static_cast<std::size_t>((1.0 - kMostMissing) * static_cast<double>(trial.duration_ticks));
  const double end_s =
      static_cast<double>(trial.start_tick + trial.duration_ticks - 1) / kControlRateHz;
  const runtime::OrdinaryWhile ordinary;
  std::string why = "the recorder has not written it";
  for (int i = 0; i < kTries; ++i) {
    runtime::sleep_until_ns(runtime::monotonic_ns() + kPatience_ns);
    try {
      SessionRows session = read_session_rows(file.string(), std::to_string(trial.number));
      const recording::Recording& rows = session.rows;
      const bool whole = rows.row_count() >= least && rows.time_s.back() >= end_s - 0.1 &&
                         rows.find("f_motor") != nullptr &&
                         (!tracking || rows.find("x_p") != nullptr);
      if (whole) return session;
      why = std::to_string(rows.row_count()) + " of " + std::to_string(trial.duration_ticks) +
            " ticks recorded";
    } catch (const ConfigError& error) {
      why = error.what();  // not there yet
    }
  }
  throw std::runtime_error("trial " + std::to_string(trial.number) + ": " + why);
}

}  // namespace stillhand::measurement
