// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace stillhand::cancellation {

/// Parts of a mitigation.  A number is the same in core, message and recording for good; the first
/// ones have a name in idl/session.idl too.
enum class PartKind : std::uint8_t {
  kForce,
  kSchedule,
  kImpedance,
  kLmsForce,
  kSignal,
  kPredictedSignal,
  kLmsSignal,
  kLowPass,
  kNotch,
};

/// One part with its numbers, as a trial's assignment carries it.
struct Part {
  PartKind kind;
  std::vector<double> values = {};  ///< in the order and unit that the row of its kind states
  bool operator==(const Part&) const = default;
};

class PartStep;
// By the file of the part; they refuse values with a ConfigError.
std::unique_ptr<PartStep> make_impedance(const Part& part);
std::unique_ptr<PartStep> make_lms_force(const Part& part);
std::unique_ptr<PartStep> make_predicted_signal(const Part& part);
std::unique_ptr<PartStep> make_lms_signal(const Part& part);
std::unique_ptr<PartStep> make_shaping(const Part& part);

/// A kind of part, and what others than the part itself must know of it.
struct PartRow {
  PartKind kind;
  std::size_t values = 0;       ///< how many it has
  bool needs_force = false;     ///< the model of a force
  bool needs_position = false;  ///< that of a position
  bool drives_motor = false;
  bool answers_stick =
      false;  ///< with a force that follows the stick's motion, not the feedthrough
  bool filters_command = false;  ///< behind all that is taken off the command; a trial has one
  std::optional<PartKind> in_place_of = {};  ///< never stands next to this one
  /// None: recipe_of() reads it, because the recipe holds models for it.
  std::unique_ptr<PartStep> (*make)(const Part& part) = nullptr;
};

/// Every kind; parts of one trial act in this order.  The equations: METHOD.md.
inline constexpr std::array kPartRows{
    // Motor against the model in use, CC-1.  No values, or the hand M [kg], B [N s/m], K [N/m],
    // lever [m]: then gain and phase are followed, CC-10.
    PartRow{.kind = PartKind::kForce, .needs_force = true, .drives_motor = true},
    // Motor against a model between two arms, MI-5: the values of the relaxed, then of the holding
    // arm, admittance AD-10.
    PartRow{.kind = PartKind::kSchedule, .drives_motor = true},
    // Motor as spring, damper and mass, MI-2: K [N/m], B [N s/m], M [kg].
    PartRow{.kind = PartKind::kImpedance,
            .values = 3,
            .drives_motor = true,
            .answers_stick = true,
            .make = make_impedance},
    // MI-3, force form: step [-], hand M [kg], B [N s/m], K [N/m].
    PartRow{.kind = PartKind::kLmsForce, .values = 4, .drives_motor = true, .make = make_lms_force},
    // The identified feedthrough to position is taken off the command, MI-6.
    PartRow{.kind = PartKind::kSignal, .needs_position = true},
    // CC-5 is taken off the command: hand M [kg], B [N s/m], K [N/m], lever [m].  With the force
    // the motor would take it away already.
    PartRow{.kind = PartKind::kPredictedSignal,
            .values = 4,
            .needs_force = true,
            .in_place_of = PartKind::kForce,
            .make = make_predicted_signal},
    // MI-3, signal form: step [-].
    PartRow{.kind = PartKind::kLmsSignal, .values = 1, .make = make_lms_signal},
    // On the command, MI-1: frequency [Hz], damping ratio [-].
    PartRow{.kind = PartKind::kLowPass, .values = 2, .filters_command = true, .make = make_shaping},
    PartRow{.kind = PartKind::kNotch, .values = 2, .filters_command = true, .make = make_shaping},
};

/// None: a number that is no kind.
const PartRow* row_of(PartKind kind);

/// True where the parts need the model of a force, or that of a position.
bool needs_force(const std::vector<Part>& parts);
bool needs_position(const std::vector<Part>& parts);
/// True where a part drives the motor.
bool drives_motor(const std::vector<Part>& parts);
/// True where the motor's force follows a prediction of the feedthrough alone.
bool opposes_feedthrough(const std::vector<Part>& parts);

}  // namespace stillhand::cancellation
