// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/human_operator/crossover_config.hpp"
#include "services/core/human_operator/pointer_operator.hpp"

namespace stillhand::human_operator {

/// Settings of both subjects: the simulated one and the arm that a person's pointer moves.
struct SubjectConfig {
  CrossoverConfig crossover;
  PointerOperator::Config pointer;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit.group("crossover", self.crossover);
    visit.group("pointer", self.pointer);
  }
};

}  // namespace stillhand::human_operator
