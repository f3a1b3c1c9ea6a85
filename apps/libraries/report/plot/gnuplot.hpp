// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

namespace stillhand::report {

/// Work of one gnuplot process.
struct GnuplotJob {
  std::string script;  ///< writes to output_path(0), output_path(1), ...
  int outputs = 0;
};

/// The name under which a script opens its n-th output.  The output is memory of this process, so
/// no folder shows a half-drawn picture and no script contains a path.
std::string output_path(int n);

/// Runs the jobs at the same time and waits for all.  Each job has its own gnuplot process, which
/// reads the script from standard input, with locale C.UTF-8 (numbers as in "C") and without
/// start-up files.
///
/// @return  for each job the bytes of its outputs
/// @throws ConfigError         when gnuplot is not on the PATH
/// @throws std::runtime_error  when gnuplot fails: one line with its message
/// Not for a process that reaps all children.  Thread-safe.
std::vector<std::vector<std::string>> run_gnuplot(std::span<const GnuplotJob> jobs);

}  // namespace stillhand::report
