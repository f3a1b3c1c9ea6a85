// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/diagnosis/model/control_role.hpp"
#include "services/core/diagnosis/model/effect.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"
#include "services/core/diagnosis/model/size.hpp"
#include "services/core/signal/hysteresis.hpp"

namespace stillhand::diagnosis {

class Screening;

/// What a nonlinearity with memory remembers from one sample to the next.
using LoopMemory = signal::HysteresisMemory;

/// phi of a signal in units of its threshold, as a function that the loop calls once a sample.
struct Nonlinearity {
  std::function<double(double z, LoopMemory& memory)> phi = {};
  double threshold = 1.0;
  /// [unit of the output] of a stop, Eq. DG-28: z, the output before it, counts from here, and phi
  /// is taken from the output of the same sample.
  std::optional<double> stop = {};
};

/// An effect with values to start its fit from.
struct Proposal {
  Effect effect;
  /// [-] of the squared error, as screened.  Its order counts, and where it is nearly exact, of
  /// terms and gains with the model's own body, whether there is any.
  double gain = 0.0;
  std::optional<Body> body;  ///< to start from instead of the model's own
};

/// A kind of effect and every fact about it: core and apps know no kind by its name.  Stateless;
/// one object a kind, in effect_kinds().  An effect acts at one stage(), and only that stage's
/// function is called.
class EffectKind {
 public:
  virtual ~EffectKind() = default;

  /// As in the verdict, for example "coulomb_friction".
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Ready to be fitted, from a residual; empty when nothing in it suggests the kind.
  [[nodiscard]] virtual std::vector<Proposal> proposed(const Screening& screening) const = 0;
  [[nodiscard]] virtual Stage stage(const Effect& effect) const = 0;
  /// One sentence on what the data said, with numbers and units.
  [[nodiscard]] virtual std::string evidence(const Effect& effect) const = 0;
  /// True when the inputs do not determine it: predict() leaves it out.
  [[nodiscard]] virtual bool time_only(const Effect& /*effect*/) const { return false; }
  /// True when it takes any shape and has no law: tried apart from the others, Eq. DG-64.
  [[nodiscard]] virtual bool any_shape() const { return false; }
  /// any_shape(): a curve in place of another kind's phi inside the body, as it is where it has its
  /// argument, with a weight for each sample.  Its coefficients are left to the caller.
  [[nodiscard]] virtual std::optional<Effect> drawn_after(
      const std::vector<double>& /*argument*/, const std::vector<double>& /*phi*/,
      const std::vector<double>& /*weight*/) const {
    return {};
  }
  /// Its curve, where it takes any shape.
  [[nodiscard]] virtual std::optional<Curve> curve(const Effect& /*effect*/,
                                                   const Signals& /*signals*/) const {
    return {};
  }
  /// Its physical numbers, METHOD "Sizes", without their standard errors: functions of the model's
  /// numbers alone.  By default none but those that are fitted.
  [[nodiscard]] virtual std::vector<Size> sizes(const SizeCase& at) const;
  /// kTerm, a linear path: its response from what drives it, [output unit per that unit].
  [[nodiscard]] virtual std::optional<std::complex<double>> path(const SizeCase& at,
                                                                 double frequency_hz) const;

  /// What a canceller does about it when it is found in the hand's response; by default what the
  /// stage allows.
  [[nodiscard]] virtual ControlRole body_role(const Effect& effect) const;
  /// The same when it is found in the stick's own equation; by default nothing.
  [[nodiscard]] virtual ControlRole drive_role(const Effect& effect) const;

  /// kInputTime: the body sees u(t - delay(t)) [s].
  [[nodiscard]] virtual double input_delay_s(const Effect& effect, double time_s) const;
  /// kInputValue, kOutputValue: the map and its slope.
  [[nodiscard]] virtual double mapped(const Effect& effect, double value) const;
  [[nodiscard]] virtual double slope(const Effect& effect, double value) const;
  /// kFeedback: phi.
  [[nodiscard]] virtual Nonlinearity feedback(const Effect& effect) const;
  /// kGain: multiplies `gain`, one a sample.
  virtual void gain(const Effect& effect, const Signals& signals, std::span<double> gain) const;
  /// kTerm: appends a column for every signal that is weighed; through_body() says how.
  virtual void terms(const Effect& effect, const Signals& signals,
                     const std::vector<double>& body_output, Columns& columns) const;
  /// kTerm: unit of column i as a recording's header has it, "-" for a pure number, as here; empty:
  /// none that can be named.
  [[nodiscard]] virtual std::string column_unit(const Effect& effect, const Signals& signals,
                                                std::size_t i) const;
  /// kTerm: each column passes the body's poles with order + 1 coefficients, instead of one factor.
  [[nodiscard]] virtual bool through_body(const Effect& effect) const;
  /// kTerm: poles that it filters its columns with, as a denominator 1, m_1, .. whose free response
  /// at a stretch's start is fitted as the body's is, Eq. DG-10 and DG-82; empty: none.
  [[nodiscard]] virtual std::vector<double> own_poles(const Effect& effect, double rate_hz) const;
  /// True where the output's rows themselves show that it acts, Eq. DG-89: whether the blocks are
  /// many enough to say so is not asked.
  [[nodiscard]] virtual bool shows_in_rows(const Effect& /*effect*/) const { return false; }
  /// kWeight: sets the weight of samples that the model does not claim to explain to 0.
  virtual void weigh(const Effect& effect, const Signals& signals, std::span<double> weight) const;
};

/// What an effect does when it acts with its share, Eq. DG-68: a delay and the factors of terms and
/// of a feedback times the share s, a map u + s (m(u) - u), a gain 1 + s (g - 1).
double delay_in_part(const Effect& effect, double time_s);
double mapped_in_part(const EffectKind& kind, const Effect& effect, double value);
double slope_in_part(const EffectKind& kind, const Effect& effect, double value);
/// Multiplies `gain`, one a sample.
void gain_in_part(const Effect& effect, const Signals& signals, std::span<double> gain);

bool acts_at(const Effect& effect, Stage stage);
/// The one that acts inside the body, nullptr for none.  A model has one at most.
const Effect* feedback_of(const Model& model);
/// True when an effect of the model passes the body's poles: the body keeps its order.
bool passes_through_body(const Model& model);

/// Every kind there is.
const std::vector<const EffectKind*>& effect_kinds();
/// @throws stillhand::ConfigError for a name that no kind has.
const EffectKind& effect_kind(std::string_view name);

}  // namespace stillhand::diagnosis
