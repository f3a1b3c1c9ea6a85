// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/core/contract/config_field.hpp"
#include "services/core/identification/arx.hpp"
#include "services/core/identification/output_error.hpp"
#include "services/core/identification/pegged_record.hpp"
#include "services/core/identification/rate_conversion.hpp"
#include "services/core/identification/record.hpp"

namespace stillhand::identification {

/// Settings of an identification.
struct Config {
  std::int64_t order = 4;              ///< p of Eq. ID-1
  bool refine = false;                 ///< Eq. ID-6 after the paper's fit
  double max_conversion_error = 0.05;  ///< bound on Eq. ID-11
  std::int64_t expected_sign = -1;     ///< Eq. ID-21
  double false_alarms_h = 0.1;         ///< of the watch on the model, cancellation Eq. CC-22

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("order", self.order, Range{1.0, 12.0},
          "[-] order of the difference model; paper III-A uses 4");
    visit("refine", self.refine, Range{0.0, 1.0},
          "[-] refine the paper's least-squares fit on its free-run error");
    visit(
        "max_conversion_error", self.max_conversion_error, Range{0.001, 1.0},
        "[-] largest error of the 1 kHz filter over 0 to 10 Hz, over the excited band's peak gain");
    visit(
        "expected_sign", self.expected_sign, Range{-1.0, 1.0},
        "[-] sign of a live model's gain at 0.7 Hz; -1: an idle hand stays behind the seat (paper "
        "IV-A: phase 180 degrees); 0: any");
    visit(
        "false_alarms_h", self.false_alarms_h, Range{0.0, 10.0},
        "[1/h] false alarms of the watch on the model in use, an hour of cancelling; 0: no watch");
  }
};

/// An identified biodynamic feedthrough model, ready for file and bus.
struct FeedthroughModel {
  DifferenceModel fit;            ///< at 50 Hz, paper Eq. 3
  DifferenceModel control;        ///< the same at 1 kHz, for the canceller
  FitQuality heldout;             ///< on the record's last quarter, by a fit to the rest
  double condition_number = 0.0;  ///< [-] of the least squares
  double conversion_error = 0.0;  ///< [-] Eq. ID-11 over 0 to 10 Hz
  bool refined = false;           ///< Eq. ID-6 was applied

  bool operator==(const FeedthroughModel&) const = default;
};

/// What the steps of identify() found.
struct IdentificationSteps {
  Record record;                          ///< preprocessed(), 50 Hz
  ArxFit paper;                           ///< paper Eqs 3 to 5
  std::optional<OutputErrorFit> refined;  ///< Eq. ID-6, where it was wanted or needed
  RateConversion control;  ///< of the refined model if refined_used, else the paper's
  bool refined_used = false;
  std::string paper_unusable;  ///< why the paper's fit cannot cancel; empty: it can
};

/// @param refine_beside  refine also when the result isn't used
/// @throws as identify().
IdentificationSteps identify_stepwise(const Record& recorded, const Config& config,
                                      bool refine_beside);

/// The whole chain of paper III-A: preprocessed(), fit_arx(), refine_output_error() when asked or
/// when the paper's fit is unstable or does not convert, to_control_rate(); of lower order where
/// even the refined model does not convert.  Pure.
/// @param recorded  at 100 Hz or more
/// @throws stillhand::ConfigError with the reason when no usable model comes out.
FeedthroughModel identify(const Record& recorded, const Config& config = {});

/// What came of a pegged trial: a model, or why there is none.
struct Identification {
  std::optional<FeedthroughModel> model;
  std::string why_not;  ///< one line for a person where there is no model
};

/// identify() of a collected trial, or why_unusable(); a ConfigError becomes its text.  A model
/// with another sign than the expected one is refused, Eq. ID-21.
Identification identify(const PeggedTrial& trial, const Config& config);

/// Displacement of the hand by the stick's angle; paper III-C: 0.10 m from the pivot.
inline double displacement_m(double theta_rad) noexcept { return 0.10 * theta_rad; }

/// The same of a trial with the stick free, which the person holds still, METHOD Eq. ID-22: `trial`
/// has the stick's displacement [m] in the place of the force, and so has the model.  The hand's
/// own motion is noise on the output, which biases the equation error: the fit is refined.
Identification identify_position(const PeggedTrial& trial, const Config& config);

}  // namespace stillhand::identification
