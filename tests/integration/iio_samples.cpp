// SPDX-License-Identifier: Apache-2.0
// iio_samples URI DEVICE CHANNEL COUNT: the converter's numbers that Stillhand's transport reads,
// one a line, for iio_test.py.
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "services/runtime/transport/iio_device.hpp"

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  std::signal(SIGPIPE, SIG_IGN);  // as each service does
  try {
    stillhand::runtime::IioDevice sut(argv[1], argv[2], argv[3]);
    std::cout << sut.format().scale << ' ' << sut.rate_hz() << std::endl;
    for (int left = std::atoi(argv[4]); left > 0;) {
      const auto raw = sut.read();
      if (!raw) continue;
      std::cout << *raw << std::endl;
      --left;
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
