// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace stillhand::measurement {

/// A file that is refused.  Readers in a child throw it, and the parent makes a ConfigError of it.
struct Refused {
  std::string where;
  std::string got;
  std::string want;
};

/// One direction of a pipe between a child and its parent: numbers and texts of this machine.
/// get_...() throw std::runtime_error when the pipe ends, or a length is larger than allowed.
class Wire {
 public:
  /// @param mark  goes in front of the first thing that is put
  Wire(std::FILE* file, std::uint64_t mark) : file_(file), mark_(mark) {}
  [[nodiscard]] bool begun() const noexcept { return begun_; }

  void put(std::uint64_t number);
  void put(double number);
  void put(const std::string& text);
  void put(const std::vector<double>& numbers);

  std::uint64_t get_count(std::uint64_t most);
  double get_number();
  std::string get_text();
  std::vector<double> get_numbers(std::uint64_t most);

 private:
  void put_bytes(const void* bytes, std::size_t count);
  void get_bytes(void* bytes, std::size_t count);

  std::FILE* file_;
  std::uint64_t mark_;
  bool begun_ = false;
};

/// Runs `work` in a child process and `take` here, joined by a pipe.  The libraries that read
/// foreign binary files have crashed on damaged ones; in a child, a crash is a refusal.
/// @param path  the file, for messages
/// @param work  reads the file; throws Refused before it puts anything, or puts its result
/// @param take  gets the result in the same order
/// @throws stillhand::ConfigError as `work` refused, or if the child did not finish
void in_child(const std::string& path, const std::function<void(Wire&)>& work,
              const std::function<void(Wire&)>& take);

}  // namespace stillhand::measurement
