// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// Blocks of equal length in time, and which fold of a cross-validation each is in: block b in fold
/// b mod folds, so that every fold is spread over the whole record, unless `fold` says otherwise.
struct Blocks {
  std::size_t length = 1;  ///< [samples]
  std::size_t count = 1;
  std::size_t folds = 2;
  std::vector<std::size_t> fold = {};  ///< [blocks], or empty

  [[nodiscard]] std::size_t fold_of(std::size_t block) const noexcept {
    return fold.empty() ? block % folds : fold[block];
  }
};

/// Rows of one block.
struct BlockRows {
  std::ptrdiff_t first;
  std::ptrdiff_t count;
};
/// @param samples  of the record: the last block may have fewer than the others
BlockRows rows_of(const Blocks& blocks, std::size_t block, std::ptrdiff_t samples) noexcept;

/// About 30 blocks of at least 2 s, 5 folds.  @throws stillhand::ConfigError for a record of fewer
/// than 10 blocks of 5 samples.
Blocks make_blocks(const Signals& signals);

/// The same blocks, a fold for each of the recordings that were joined; a block over a seam belongs
/// to the one that has more of it.
Blocks by_recording(const Blocks& blocks, const Signals& signals);

}  // namespace stillhand::diagnosis
