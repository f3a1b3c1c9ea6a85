// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/verdict_stability.hpp"

#include <algorithm>
#include <map>

#include "services/core/signal/random.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kBlocks = 30;  // of the record, as DG-11
constexpr std::size_t kLeftOut = kBlocks / 5;
constexpr double kLastBits = 1e-13;

// True for those that weigh nothing.
std::vector<bool> left_out(signal::Gaussian& random) {
  std::vector<double> draw(kBlocks);
  for (double& each : draw) each = random();
  std::vector<double> sorted = draw;
  std::ranges::nth_element(sorted, sorted.begin() + kLeftOut);
  std::vector<bool> out(kBlocks);
  for (std::size_t b = 0; b < kBlocks; ++b) out[b] = draw[b] < sorted[kLeftOut];
  return out;
}

}  // namespace

std::string in_one_word(const Diagnosis& diagnosis) {
  const auto counts = std::ranges::find_if(diagnosis.effects, &FoundEffect::counts);
  return diagnosis.no_model || counts == diagnosis.effects.end() ? diagnosis.verdict()
                                                                 : counts->effect.kind;
}

Measurement disturbed(const Measurement& measurement, const std::string& output, int repetition) {
  signal::Gaussian random(static_cast<std::uint64_t>(repetition), 0);
  const std::vector<bool> out = left_out(random);
  Measurement other = measurement;
  for (std::size_t n = 0; n < other.size(); ++n) {
    if (out[n * kBlocks / other.size()]) other.weight[n] = 0.0;
  }
  for (Channel& channel : other.channels) {
    if (channel.name != output) continue;
    for (double& value : channel.values) value *= 1.0 + kLastBits * random();
  }
  return other;
}

NameCounts verdict_stability(const Measurement& measurement, const DiagnoseOptions& options,
                             int repetitions) {
  std::map<std::string, int> counts;
  for (int i = 1; i <= repetitions; ++i) {
    DiagnoseOptions own = options;
    own.progress = [&](const std::string&) {
      return options.progress("repetition " + std::to_string(i) + " of " +
                              std::to_string(repetitions));
    };
    ++counts[in_one_word(diagnose(disturbed(measurement, options.output, i), own))];
  }
  NameCounts stability{repetitions, {counts.begin(), counts.end()}};
  std::ranges::stable_sort(stability.counts, std::ranges::greater(),
                           &std::pair<std::string, int>::second);
  return stability;
}

}  // namespace stillhand::diagnosis
