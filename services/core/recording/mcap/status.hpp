// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

namespace stillhand::recording {

/// Reason why an input or output step failed.
enum class StatusKind {
  kOk,
  kIo,        ///< the operating system refused; text states the reason
  kNoSpace,   ///< the disk (or quota, or file size limit) is full
  kClosed,    ///< write after close()
  kTooLarge,  ///< larger than the format or the limit allows; nothing was written
  kDamaged,   ///< the bytes violate the format
};

/// Result of a step that can fail while a recording runs.  It is returned, never thrown.
struct [[nodiscard]] Status {
  StatusKind kind = StatusKind::kOk;
  std::string text;  ///< one line for a person, empty when ok

  [[nodiscard]] bool ok() const noexcept { return kind == StatusKind::kOk; }
  static Status failure(StatusKind kind, std::string text) { return {kind, std::move(text)}; }
};

}  // namespace stillhand::recording
