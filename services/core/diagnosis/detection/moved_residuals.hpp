// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/fitting/grams.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// A model's residual moved in time against the inputs, in a circle, every second time backwards:
/// noise with the spectrum, the tails and the bursts of this record, which nothing in the inputs
/// explains.  A column is added to each, and asked of it next to the model, Eq. DG-14.  All
/// products are taken once, block by block; after that nothing is as long as the record.
class MovedResiduals {
 public:
  /// @param columns  next to the model, as they add to the prediction [samples x columns]
  /// @param count  of the residuals, moved by equal steps
  MovedResiduals(const Model& model, const Signals& signals, const Blocks& blocks,
                 const Eigen::MatrixXd& columns, std::size_t count);

  [[nodiscard]] std::size_t count() const noexcept { return static_cast<std::size_t>(residuals_); }
  /// What the model leaves of a residual with `factor` times column k in it.
  [[nodiscard]] HeldOut without(Eigen::Index k, double factor, std::size_t residual) const {
    return held_out_linearised(grams(k, factor, residual, false), blocks_);
  }
  /// The same with the column next to the model.
  [[nodiscard]] HeldOut with(Eigen::Index k, double factor, std::size_t residual) const {
    return held_out_linearised(grams(k, factor, residual, true), blocks_);
  }
  /// RMS of column k beyond the span of the model's columns, over its own.
  [[nodiscard]] double beyond(Eigen::Index k) const;

 private:
  [[nodiscard]] Grams grams(Eigen::Index k, double factor, std::size_t residual,
                            bool with_column) const;

  const Blocks& blocks_;
  Eigen::Index own_ = 0;  ///< columns of the model
  Eigen::Index columns_;
  Eigen::Index residuals_;
  Grams grams_;
};

}  // namespace stillhand::diagnosis
