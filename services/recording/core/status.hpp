// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

namespace stillhand::recording {

/// Why an input or output step did not succeed.
enum class StatusKind {
  kOk,
  kIo,        ///< the operating system refused; text holds its reason
  kNoSpace,   ///< the disk (or quota, or file size limit) is full
  kClosed,    ///< written after close()
  kTooLarge,  ///< larger than the format or the set limit allows; nothing was written
  kDamaged,   ///< the bytes read are not what the format promises
};

/// Outcome of a step that can fail while a recording runs; never thrown, never to be ignored.
struct [[nodiscard]] Status {
  StatusKind kind = StatusKind::kOk;
  std::string text;  ///< one line for a person, empty when ok

  [[nodiscard]] bool ok() const noexcept { return kind == StatusKind::kOk; }
  static Status failure(StatusKind kind, std::string text) { return {kind, std::move(text)}; }
};

}  // namespace stillhand::recording
