// SPDX-License-Identifier: Apache-2.0
// How long the paper's fit takes, on the samples that identify_peers.py hands over: standard input
// holds the acceleration, then the force, doubles at 100 Hz.  Prints medians in ms as JSON.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "services/core/identification/arx.hpp"
#include "services/core/identification/paper_preprocessing.hpp"

namespace {

constexpr int kOrder = 4;

template <typename Work>
double median_ms(int repetitions, const Work& work) {
  std::vector<double> times_ms;
  for (int k = 0; k < repetitions; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> taken =
        std::chrono::steady_clock::now() - begin;
    times_ms.push_back(taken.count());
  }
  std::ranges::nth_element(times_ms, times_ms.begin() + repetitions / 2);
  return times_ms[static_cast<std::size_t>(repetitions / 2)];
}

// c_0 .. c_p, d_1 .. d_p
std::vector<double> parameters_of(const stillhand::signal::DifferenceModel& model) {
  std::vector<double> parameters = model.numerator;
  parameters.insert(parameters.end(), model.denominator.begin() + 1, model.denominator.end());
  return parameters;
}

}  // namespace

int main(int count, char** words) {
  using namespace stillhand::identification;
  const int repetitions = count > 1 ? std::atoi(words[1]) : 200;
  const std::string bytes{std::istreambuf_iterator<char>(std::cin), {}};
  const std::span all(reinterpret_cast<const double*>(bytes.data()), bytes.size() / sizeof(double));
  const auto half = static_cast<std::ptrdiff_t>(all.size() / 2);
  const Record recorded{100.0, {all.begin(), all.begin() + half}, {all.begin() + half, all.end()}};
  const Record at_fit_rate = preprocessed(recorded);

  double sum = 0.0;  // or nothing would have to be computed
  const auto fit = [&](const Record& record) {
    sum += least_squares(record, kOrder).numerator.front();
  };
  const auto whole = [&](const Record& record) {
    sum += fit_arx(record, kOrder).model.numerator.front();
  };
  nlohmann::json out;
  out["fit"] = median_ms(repetitions, [&] { fit(at_fit_rate); });
  out["fit_all_samples"] = median_ms(repetitions, [&] { fit(recorded); });
  out["checked"] = median_ms(repetitions, [&] { whole(at_fit_rate); });
  out["low_pass_and_fit"] = median_ms(repetitions, [&] { fit(preprocessed(recorded)); });
  out["low_pass_and_checked"] = median_ms(repetitions, [&] { whole(preprocessed(recorded)); });
  out["parameters"] = parameters_of(least_squares(at_fit_rate, kOrder));
  out["parameters_all_samples"] = parameters_of(least_squares(recorded, kOrder));
  out["finite"] = sum - sum == 0.0;
  std::cout << out.dump() << '\n';
}
