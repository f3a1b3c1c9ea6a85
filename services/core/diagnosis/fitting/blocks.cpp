// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/blocks.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kBlocks = 30;
constexpr std::size_t kFolds = 5;
constexpr double kShortestBlock_s = 2.0;
constexpr std::size_t kFewestBlocks = 10;
constexpr std::size_t kFewestWeighing = 8;  // the first may lie in what isn't judged
constexpr std::size_t kFewestSamples = 5;

}  // namespace

BlockRows rows_of(const Blocks& blocks, std::size_t block, std::ptrdiff_t samples) noexcept {
  const auto first = static_cast<std::ptrdiff_t>(block * blocks.length);
  return {first, std::min(static_cast<std::ptrdiff_t>(blocks.length), samples - first)};
}

Blocks make_blocks(const Signals& signals) {
  const auto shortest =
      std::max(kFewestSamples, static_cast<std::size_t>(kShortestBlock_s * signals.rate_hz()));
  Blocks blocks;
  blocks.folds = kFolds;
  blocks.length = std::max(shortest, (signals.size() + kBlocks - 1) / kBlocks);
  if (signals.size() < kFewestBlocks * blocks.length) {
    blocks.length = std::max(kFewestSamples, signals.size() / kFewestBlocks);
  }
  blocks.count = (signals.size() + blocks.length - 1) / blocks.length;
  std::size_t weighing = 0;
  for (std::size_t b = 0; b < blocks.count; ++b) {
    const std::size_t end = std::min(signals.size(), (b + 1) * blocks.length);
    double weight = 0.0;
    for (std::size_t n = b * blocks.length; n < end; ++n) weight += signals.weight()[n];
    if (weight >= 1.0) ++weighing;
  }
  if (signals.size() < kFewestBlocks * kFewestSamples || weighing < kFewestWeighing) {
    throw ConfigError("recording", std::to_string(signals.size()) + " samples",
                      "at least " + std::to_string(kFewestBlocks * kFewestSamples) +
                          " to judge a model on samples it has not seen");
  }
  return blocks;
}

Blocks by_recording(const Blocks& blocks, const Signals& signals) {
  Blocks result = blocks;
  result.folds = signals.stretches().back().recording + 1;
  Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(result.folds),
                                                  static_cast<Eigen::Index>(blocks.count));
  for (const Stretch& stretch : signals.stretches()) {
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      samples(static_cast<Eigen::Index>(stretch.recording),
              static_cast<Eigen::Index>(n / blocks.length)) += 1.0;
    }
  }
  for (Eigen::Index b = 0; b < samples.cols(); ++b) {
    Eigen::Index most = 0;
    samples.col(b).maxCoeff(&most);
    result.fold.push_back(static_cast<std::size_t>(most));
  }
  return result;
}

}  // namespace stillhand::diagnosis
