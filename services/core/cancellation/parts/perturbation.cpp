// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/perturbation.hpp"

#include <algorithm>

namespace stillhand::cancellation {

double Perturbation::force_n(Tick tick, const Trial& trial) const noexcept {
  if (!trial.covers(tick)) return 0.0;
  const Tick since = tick - trial.start_tick;
  const Tick period = force_.samples_per_period();
  const Tick phase = ((since % period) + period) % period;
  const Tick outside = since < 0 ? -since : std::max<Tick>(0, since - trial.duration_ticks + 1);
  const double share = trial.ramp_ticks > 0 ? 1.0 - static_cast<double>(outside) /
                                                        static_cast<double>(trial.ramp_ticks)
                                            : 1.0;
  return std::clamp(share, 0.0, 1.0) * force_.at(phase).accel_m_s2;
}

}  // namespace stillhand::cancellation
