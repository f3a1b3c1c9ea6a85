// SPDX-License-Identifier: Apache-2.0
// Reads one table as every verb does and prints its rows, for read_tables.py.
// Usage: read_tables FILE [--map 'TITLE=NAME [UNIT]'...]
#include <iostream>
#include <string>

#include "apps/libraries/measurement/read.hpp"
#include "apps/libraries/measurement/tables/mapping.hpp"

int main(int count, char** words) {
  using namespace stillhand::measurement;
  if (count < 2) return 2;
  ReadOptions options;
  for (int i = 3; i < count; ++i) options.mapping.columns.push_back(parse_wish(words[i]));
  const auto measurement = read_measurement(words[1], options);
  std::cout << "{\"rows\": " << measurement.size() << "}\n";
  return 0;
}
