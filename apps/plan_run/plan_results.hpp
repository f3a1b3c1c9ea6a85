// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"
#include "services/core/next_run/design.hpp"

namespace stillhand::plan_run {

/// A plan and what it was made for.
struct Planned {
  const next_run::Contest& contest;
  const next_run::Plan& plan;
  const next_run::Bounds& bounds;
  double seconds;
  std::vector<std::string> advice;        ///< what else separates the candidates
  std::vector<next_run::Lasting> longer;  ///< runs
};

/// What each pair needs besides the motion: of those that the run settles in less than every second
/// case, a sentence each.
std::vector<std::string> advice_for(const next_run::Contest& contest, const next_run::Plan& plan,
                                    const diagnosis::Signals& signals);

/// plan.json without its provenance, README "plan.json".
std::string plan_json(const Planned& planned);
/// The same for people.
std::string plan_table(const Planned& planned);
/// ride.csv: `t [s],a_y [m/s^2]`, for the motion service.
std::string ride_csv(const next_run::Ride& ride);
/// The motion, and what each other candidate, fitted to it, leaves of the first one's prediction,
/// over time and frequency.
report::Figure plan_figure(const Planned& planned);

}  // namespace stillhand::plan_run
