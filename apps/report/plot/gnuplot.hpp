// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

namespace stillhand::report {

/// What one gnuplot process has to do.
struct GnuplotJob {
  std::string script;  ///< writes to output_path(0), output_path(1), ...
  int outputs = 0;
};

/// The name under which a script opens its n-th output: memory of this process, so that no picture
/// half drawn is ever seen in a folder, and no path is ever written into a script.
std::string output_path(int n);

/// Runs the jobs at the same time, each in a gnuplot process of its own that reads the script from
/// its standard input, with locale C.UTF-8 (numbers as in "C") and without anybody's start-up
/// files, and waits for all.
///
/// @return  for each job the bytes of its outputs
/// @throws ConfigError         when there is no gnuplot on the PATH
/// @throws std::runtime_error  when gnuplot fails: one line with what it said
/// Not for a process that reaps all children.  Thread-safe.
std::vector<std::vector<std::string>> run_gnuplot(std::span<const GnuplotJob> jobs);

}  // namespace stillhand::report
