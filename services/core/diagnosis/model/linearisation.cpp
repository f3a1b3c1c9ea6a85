// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/model_run.hpp"

namespace stillhand::diagnosis {
namespace {

// Where a model's nonlinearity is: inside the body, nothing that the numerators B and E of Eq. DG-4
// say comes back to its argument, and their columns are exact.
enum class Loop { kNone, kOfOutput, kInside };

Loop loop_of(const Model& model) {
  const Effect* feedback = feedback_of(model);
  if (feedback == nullptr) return Loop::kNone;
  return loop_path(*feedback, model.body.order()).of_output() ? Loop::kOfOutput : Loop::kInside;
}

// Which acts from a level of the output: the offset moves the body against it.
bool has_stop(const Model& model) {
  const Effect* feedback = feedback_of(model);
  return feedback != nullptr && effect_kind(feedback->kind).feedback(*feedback).stop.has_value();
}

// A number whose column comes from a forward difference.
struct ByDifference {
  Eigen::Index number = 0;
  std::optional<std::size_t> owner;  // an effect; none: the body
};

// Those of nonlinear parameters, and with feedback those that its argument depends on.
std::vector<ByDifference> by_differences(const Model& model, Loop loop) {
  std::vector<ByDifference> which;
  Eigen::Index next = 0;
  const auto append = [&](std::size_t count, bool needed, std::optional<std::size_t> owner) {
    for (std::size_t i = 0; i < count; ++i, ++next) {
      if (needed) which.push_back({next, owner});
    }
  };
  append(1, loop == Loop::kOfOutput && has_stop(model), {});
  for (const auto& numerator : model.body.numerators) {
    append(numerator.size(), loop == Loop::kOfOutput, {});
  }
  append(model.body.order(), loop != Loop::kNone, {});
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    const Effect& effect = model.effects[e];
    if (!effect.is_whole()) continue;
    const bool feedback = acts_at(effect, Stage::kFeedback);
    const std::size_t exact = feedback && loop == Loop::kInside ? model.body.order() + 1 : 0;
    append(exact, false, e);
    append(effect.coefficients.size() - exact, feedback, e);
    for (const Parameter& parameter : effect.parameters) {
      if (parameter.fitted) append(1, true, e);
    }
  }
  return which;
}

// Fills columns one after the other, multiplied by slope and weight.
class ColumnWriter {
 public:
  ColumnWriter(Eigen::MatrixXd& jacobian, const FreeRun& run) : jacobian_(jacobian), run_(run) {}
  void write(const std::vector<double>& x, double factor, const std::vector<double>* gain) {
    double* column = jacobian_.col(next_++).data();
    for (std::size_t n = 0; n < x.size(); ++n) {
      const double scale = factor * run_.output_slope[n] * run_.weight[n];
      column[n] = scale * x[n] * (gain == nullptr ? 1.0 : (*gain)[n]);
    }
  }
  void skip(std::size_t count) { next_ += static_cast<Eigen::Index>(count); }

 private:
  Eigen::MatrixXd& jacobian_;
  const FreeRun& run_;
  Eigen::Index next_ = 0;
};

// q^-1 x / A
Settled late_through_poles(const Settled& x, const Model& model,
                           const std::vector<Stretch>& stretches) {
  return late(through_poles(x, model.body.denominator, stretches), stretches);
}

// x, D x, .. D^p x behind the gain.
void write_differences(Settled x, const Model& model, const Signals& signals, const ModelRun& run,
                       ColumnWriter& writer) {
  for (std::size_t i = 0; i <= model.body.order(); ++i) {
    if (i > 0) x = differenced(x, signals.stretches());
    writer.write(x.values, 1.0, &run.gain);
  }
}

void write_body_columns(const Model& model, const Signals& signals, const ModelRun& run,
                        ColumnWriter& writer) {
  const auto& stretches = signals.stretches();
  for (const auto& filtered : run.filtered_inputs) {
    write_differences(filtered, model, signals, run, writer);
  }
  // d/dg_i of B u / A with A = 1 + q^-1 sum g_i D^i: -q^-1 D^i y / A, behind which comes the gain;
  // terms that pass the body do so without it.
  Settled late = late_through_poles({run.free.body, run.body_before}, model, stretches);
  Settled terms;
  if (run.passes_terms) terms = late_through_poles(run.through_body, model, stretches);
  for (std::size_t i = 0; i < model.body.order(); ++i) {
    if (i > 0) late = differenced(late, stretches);
    if (i > 0 && run.passes_terms) terms = differenced(terms, stretches);
    std::vector<double> both(signals.size());
    for (std::size_t n = 0; n < both.size(); ++n) {
      both[n] = run.gain[n] * late.values[n] + (run.passes_terms ? terms.values[n] : 0.0);
    }
    writer.write(both, -1.0, nullptr);
  }
}

void write_loop_columns(const Model& model, const Signals& signals, const ModelRun& run, Loop loop,
                        ColumnWriter& writer) {
  for (const Settled& input : run.inputs) {
    if (loop == Loop::kOfOutput) {
      writer.skip(model.body.order() + 1);
    } else {
      write_differences(through_poles(input, model.body.denominator, signals.stretches()), model,
                        signals, run, writer);
    }
  }
  writer.skip(model.body.order());
}

void write_exact_columns(const Model& model, const Signals& signals, const ModelRun& run, Loop loop,
                         Eigen::MatrixXd& jacobian) {
  ColumnWriter writer(jacobian, run.free);
  writer.write(std::vector<double>(signals.size(), 1.0), 1.0, nullptr);
  if (loop == Loop::kNone) {
    write_body_columns(model, signals, run, writer);
  } else {
    write_loop_columns(model, signals, run, loop, writer);
  }
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    const Effect& effect = model.effects[e];
    if (!effect.is_whole()) continue;
    if (loop == Loop::kInside && acts_at(effect, Stage::kFeedback)) {
      const Settled phi{run.free.phi, run.phi_before};
      write_differences(through_poles(phi, model.body.denominator, signals.stretches()), model,
                        signals, run, writer);
      writer.skip(effect.coefficients.size() - model.body.order() - 1);
    } else if (run.term_columns[e].empty()) {
      writer.skip(effect.coefficients.size());
    } else {
      for (const auto& column : run.term_columns[e]) writer.write(column, 1.0, nullptr);
    }
    for (const Parameter& parameter : effect.parameters) writer.skip(parameter.fitted ? 1 : 0);
  }
}

// The step is a millionth of the number, or of its neighbours' size.  Returns the change; 0:
// pinned.
double move_one(const Eigen::VectorXd& numbers, const ByDifference& which, Model& model) {
  const Eigen::Index i = which.number;
  double size = std::abs(numbers[i]);
  for (Eigen::Index j = std::max<Eigen::Index>(i - 1, 0); j <= std::min(i + 1, numbers.size() - 1);
       ++j) {
    size = std::max(size, 1e-3 * std::abs(numbers[j]));
  }
  const double step = 1e-6 * (size > 0.0 ? size : 1.0);
  const Model start = model;
  double change = 0.0;
  // A parameter at its upper bound can only go down.
  for (const double direction : {step, -step}) {
    Eigen::VectorXd changed = numbers;
    changed[i] += direction;
    unpack(changed, model);
    change = packed(model)[i] - numbers[i];
    if (std::abs(change) > 0.5 * step) break;
  }
  if (which.owner) {
    // The others exactly as they were.
    Effect moved = std::move(model.effects[*which.owner]);
    model = start;
    model.effects[*which.owner] = std::move(moved);
  }
  return change;
}

// Forward differences, as many models at a time as run side by side.
void write_difference_columns(const Model& model, const Signals& signals, const ModelRun& run,
                              const std::vector<ByDifference>& which, Eigen::MatrixXd& jacobian) {
  const Eigen::VectorXd numbers = packed(model);
  std::vector<Model> models;
  std::vector<double> changes;
  std::vector<Eigen::Index> columns;
  KnownRun known{run, {}};
  const auto write = [&] {
    std::vector<ModelRun> others(models.size());
    run_all(models, signals, others, &known);
    for (std::size_t each = 0; each < models.size(); ++each) {
      const std::vector<double>& prediction = others[each].free.prediction;
      const double inverse = 1.0 / changes[each];
      double* column = jacobian.col(columns[each]).data();
      for (std::size_t n = 0; n < signals.size(); ++n) {
        column[n] = run.free.weight[n] * (prediction[n] - run.free.prediction[n]) * inverse;
      }
    }
    models.clear();
    changes.clear();
    columns.clear();
    known.owners.clear();
  };
  for (const ByDifference& each : which) {
    Model other = model;
    const double change = move_one(numbers, each, other);
    if (change == 0.0) continue;  // pinned: the column stays 0
    models.push_back(std::move(other));
    changes.push_back(change);
    columns.push_back(each.number);
    known.owners.push_back(each.owner);
    if (models.size() == kLoopLanes) write();
  }
  write();
}

}  // namespace

Eigen::MatrixXd jacobian_of(const Model& model, const Signals& signals, const Evaluation& at) {
  const Loop loop = loop_of(model);
  Eigen::MatrixXd jacobian =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(signals.size()), packed(model).size());
  write_exact_columns(model, signals, at.run, loop, jacobian);
  write_difference_columns(model, signals, at.run, by_differences(model, loop), jacobian);
  at.initial->remove_from(jacobian);
  signals.whiten(jacobian, at.run.free.weight);
  return jacobian;
}

Linearisation linearised(const Model& model, const Signals& signals) {
  Evaluation at = evaluated(model, signals);
  Linearisation result;
  result.finite = at.run.free.finite;
  if (result.finite) result.jacobian = jacobian_of(model, signals, at);
  result.residual = std::move(at.residual);
  result.run = std::move(at.run.free);
  return result;
}

}  // namespace stillhand::diagnosis
