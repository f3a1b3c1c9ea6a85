// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/screening.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/core/diagnosis/model/steady_start.hpp"
#include "services/core/diagnosis/record/wide_sums.hpp"
#include "services/core/signal/decompositions.hpp"
#include "services/core/statistics/signed_rank.hpp"

namespace stillhand::diagnosis {
Screening::Screening(const Model& model, const Signals& signals, const Blocks& blocks,
                     const ImpulseResponse& impulse_response, std::vector<Proposal> known)
    : model_(model),
      signals_(signals),
      blocks_(blocks),
      impulse_response_(impulse_response),
      known_(std::move(known)),
      line_(linearised(model, signals)),
      grams_(grams_of(line_.jacobian, line_.residual, line_.run.weight, blocks)),
      initial_(model, signals, line_.run.weight) {
  held_out_ = held_out_linearised(grams_, blocks);
  rmse_ = std::sqrt(line_.residual.squaredNorm() / std::max(sum_of(line_.run.weight), 1.0));
}

std::vector<Proposal> Screening::known(std::string_view kind) const {
  std::vector<Proposal> of_kind;
  std::ranges::copy_if(known_, std::back_inserter(of_kind), [&](const Proposal& each) {
    return each.effect.kind == kind && each.body->order() == model_.body.order();
  });
  return of_kind;
}

Eigen::MatrixXd Screening::as_added(const Columns& columns) const {
  Eigen::MatrixXd more(line_.residual.size(), std::ssize(columns));
  for (Eigen::Index c = 0; c < more.cols(); ++c) {
    const std::vector<double>& column = columns[static_cast<std::size_t>(c)];
    for (std::size_t n = 0; n < column.size(); ++n) {
      more(static_cast<Eigen::Index>(n), c) =
          column[n] * line_.run.output_slope[n] * line_.run.weight[n];
    }
  }
  initial_.remove_from(more);
  signals_.whiten(more, line_.run.weight);
  return more;
}

ScreenedGain Screening::gain(const Columns& columns) const {
  const Eigen::Index own = line_.jacobian.cols();
  const Eigen::Index size = own + std::ssize(columns);
  const Eigen::MatrixXd more = as_added(columns);
  Grams grams;
  grams.weights = grams_.weights;
  for (std::size_t b = 0; b < blocks_.count; ++b) {
    const auto [first, rows] = rows_of(blocks_, b, more.rows());
    ColumnPointers pointers;
    append_columns(line_.jacobian, first, pointers);
    append_columns(more, first, pointers);
    pointers.push_back(line_.residual.data() + first);
    Eigen::MatrixXd gram(size + 1, size + 1);
    gram.topLeftCorner(own, own) = grams_.blocks[b].topLeftCorner(own, own);
    write_products(pointers, static_cast<std::size_t>(rows), own, gram);
    grams.blocks.push_back(std::move(gram));
  }
  ScreenedGain result;
  const HeldOut with = held_out_linearised(grams, blocks_);
  result.share = 1.0 - sum_of(with.squares) / std::max(sum_of(held_out_.squares), 1e-300);
  std::vector<double> differences;
  for (std::size_t b = 0; b < with.squares.size(); ++b) {
    differences.push_back(held_out_.squares[b] - with.squares[b]);
  }
  if (with.finite) result.p = statistics::signed_rank_p(differences);
  const Eigen::MatrixXd total = grams.total(blocks_);
  const Eigen::VectorXd scale =
      total.diagonal().head(size).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd normal =
      scale.asDiagonal() * total.topLeftCorner(size, size) * scale.asDiagonal();
  normal.diagonal().array() += 1e-9;
  const Eigen::VectorXd step =
      scale.asDiagonal() *
      signal::solve_symmetric(normal, scale.asDiagonal() * total.col(size).head(size));
  result.coefficients.assign(step.data() + own, step.data() + size);
  if (!std::isfinite(result.share)) result.share = -1.0;
  return result;
}

Columns Screening::through_body(const std::vector<double>& column) const {
  Settled passed =
      through_poles(settled(column, signals_), model_.body.denominator, signals_.stretches());
  Columns columns{passed.values};
  for (std::size_t i = 0; i < model_.body.order(); ++i) {
    passed = differenced(passed, signals_.stretches());
    columns.push_back(passed.values);
  }
  return columns;
}

Columns Screening::term_columns(const Effect& effect) const {
  const EffectKind& kind = effect_kind(effect.kind);
  Columns columns;
  kind.terms(effect, signals_, line_.run.body, columns);
  if (!kind.through_body(effect)) return columns;
  Columns passed;
  for (const auto& column : columns) {
    for (auto& each : through_body(column)) passed.push_back(std::move(each));
  }
  return passed;
}

Proposal Screening::with_coefficients(Effect effect) const {
  const ScreenedGain found = gain(term_columns(effect));
  effect.coefficients = found.coefficients;
  return {std::move(effect), found.share, {}};
}

}  // namespace stillhand::diagnosis
