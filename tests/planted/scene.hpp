// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tests/planted/draw.hpp"
#include "tests/planted/filters.hpp"

namespace stillhand::planted {

/// The simulator's own time grid: finer than the recording, from before its start to after its end.
struct Grid {
  std::size_t per_sample = 0;  ///< steps a sample of the recording
  std::size_t before = 0;    ///< steps before t = 0: the body has settled when the recording starts
  std::size_t recorded = 0;  ///< samples of the recording
  std::size_t size = 0;
  double rate_hz = 0.0;  ///< of the grid, 1 kHz or a little more

  /// @param length_s, rate_hz  of the recording; both positive
  Grid(double length_s, double rate_hz);
  [[nodiscard]] double time_s(std::size_t i) const {
    return (static_cast<double>(i) - static_cast<double>(before)) / rate_hz;
  }
  /// Index of recorded sample n.
  [[nodiscard]] std::size_t at(std::size_t n) const { return before + n * per_sample; }
};

/// Motion of the platform.
struct Excitation {
  bool multisine = false;
  double low_hz = 0.7;
  double high_hz = 4.0;
  double rms_m_s2 = 1.6;
  double period_s = 0.0;         ///< multisine only
  std::vector<double> lines_hz;  ///< multisine only: odd harmonics, some omitted deliberately
  bool starts_at_rest = false;
  /// A motion that is given, at 1 kHz from given_start_s on, at rest before and after it; the rest
  /// above then counts for nothing.
  std::vector<double> given_m_s2 = {};
  double given_start_s = 0.0;
};

/// One signal over the whole grid.
struct Signal {
  std::string name;
  std::string unit;
  Series values;
};

/// All signals around the body; none depends on the planted effect.
struct Scene {
  Grid grid;
  Excitation excitation;
  std::vector<Signal>
      signals;  ///< a_y first; a_y is the recorded signal, which can differ from the acting one
  std::vector<double> periodic_hz;  ///< lines of any signal: a planted tone stays away from them

  /// The same object in every copy of this scene, and in no other scene.
  std::shared_ptr<const int> identity;

  [[nodiscard]] const Series& of(std::string_view name) const;
};

Excitation draw_excitation(Draw& draw, double length_s, double rate_hz);
Series acceleration(const Excitation& excitation, const Grid& grid, Draw& draw);

/// Platform, roll, stick, tracking task, temperature and grip, partly correlated as in a vehicle.
Scene draw_scene(Draw& draw, double length_s, double rate_hz, const Excitation& excitation);

}  // namespace stillhand::planted
