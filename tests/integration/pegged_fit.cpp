// SPDX-License-Identifier: Apache-2.0
// Prints a pegged record of a drawn subject at 50 Hz, the paper's fit to it and its response as
// JSON, for least_squares_test.py to solve once more.
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/libraries/session/in_process.hpp"
#include "services/core/identification/arx.hpp"
#include "services/core/identification/paper_preprocessing.hpp"
#include "services/core/population/population.hpp"

namespace {

using namespace stillhand;

nlohmann::json fitted() {
  session::ProtocolOptions options;
  options.conditions = session::parse_conditions("A");
  options.identify_s = 120.0;
  session::CoreConfigs configs;
  configs.rig.body = population::draw_subject({}, 1, 0).body;
  session::InProcessLoop loop(configs, options.seed);
  const auto record = identification::preprocessed(loop.run(session::plan(options).front()).pegged);
  const auto fit = identification::fit_arx(record, 4);
  nlohmann::json response = nlohmann::json::array();
  for (int line = 0; line <= 100; ++line) {
    const double hz = 0.25 * line;
    const auto h = signal::response_at(fit.model, hz);
    response.push_back({hz, h.real(), h.imag()});
  }
  return {{"rate_hz", record.rate_hz},
          {"acceleration", record.acceleration_m_s2},
          {"force", record.force_n},
          {"numerator", fit.model.numerator},
          {"denominator", fit.model.denominator},
          {"response", response}};
}

}  // namespace

int main() {
  try {
    std::cout << fitted().dump();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "pegged_fit: " << error.what() << '\n';
    return 1;
  }
}
