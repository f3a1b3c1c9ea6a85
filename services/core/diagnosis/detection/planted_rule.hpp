// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>

#include "services/core/diagnosis/detection/moved_residuals.hpp"
#include "services/core/diagnosis/detection/planted_limits.hpp"
#include "services/core/diagnosis/selection.hpp"

namespace stillhand::diagnosis {

/// The rule of the search, Eq. DG-17, asked of a column that was planted in moved residuals.
class PlantedRule {
 public:
  /// @param plain, behind  without the noise model and with it; null: there is none
  PlantedRule(const MovedResiduals& plain, const MovedResiduals* behind, const LastRound& round,
              const SearchOptions& options)
      : plain_(plain), behind_(behind), round_(round), options_(options) {}

  /// [-] of the moved residuals, in which it is found.
  /// @param factor  of column k; the residual has the column with it
  /// @param left_out  the effect leaves samples out instead of explaining them
  [[nodiscard]] double share_found(Eigen::Index k, double factor, bool left_out) const;

 private:
  [[nodiscard]] bool is_found(Eigen::Index k, double factor, std::size_t i) const;
  [[nodiscard]] bool is_burst(Eigen::Index k, double factor, std::size_t i) const;

  const MovedResiduals& plain_;
  const MovedResiduals* behind_;
  const LastRound& round_;
  const SearchOptions& options_;
};

}  // namespace stillhand::diagnosis
