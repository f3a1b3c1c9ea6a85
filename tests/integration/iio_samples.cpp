// SPDX-License-Identifier: Apache-2.0
// iio_samples URI DEVICE CHANNEL[,CHANNEL...] COUNT [SKIP_AFTER]: the converter's numbers that
// Stillhand's transport reads, a line for each block, for iio_test.py.  After SKIP_AFTER of them it
// throws away what waits, and says so.
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "services/system/transport/iio_device.hpp"

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) return 2;
  std::signal(SIGPIPE, SIG_IGN);  // as each service does
  try {
    std::vector<std::string> channels;
    std::istringstream list(argv[3]);
    for (std::string each; std::getline(list, each, ',');) channels.push_back(each);
    stillhand::runtime::IioDevice sut(argv[1], argv[2], channels, 1000.0);
    std::cout << sut.formats().front().scale << ' ' << sut.rate_hz() << std::endl;
    long until_skip = argc == 6 ? std::strtol(argv[5], nullptr, 10) : 0;
    std::vector<std::int64_t> raw(channels.size());
    for (long left = std::strtol(argv[4], nullptr, 10); left > 0;) {
      if (!sut.read(raw)) continue;
      for (std::size_t i = 0; i < raw.size(); ++i) std::cout << (i == 0 ? "" : " ") << raw[i];
      std::cout << std::endl;
      --left;
      if (until_skip == 0 || --until_skip > 0) continue;
      sut.skip();
      std::cout << "skipped" << std::endl;
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
