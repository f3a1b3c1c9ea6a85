// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/bus/tap.hpp"
#include "services/core/recording/messages/message_columns.hpp"

namespace stillhand::record {

/// A threshold on one field of a topic: "stillhand/sensed.accel_y_m_s2>5", or with the magnitude
/// "stillhand/sensed.|accel_y_m_s2|>5".  Fires at the sample that crosses it, and again only after
/// the field has been back.  NaN is beyond no threshold.  One thread.
class FieldTrigger {
 public:
  /// @throws ConfigError for a text of another form, or a field that a topic of the catalogue lacks
  explicit FieldTrigger(const std::string& text);

  /// @returns true when this sample crosses the threshold
  bool step(const runtime::FoundWriter& writer, const runtime::TappedSample& sample);
  /// The value, for the same; separate so that it can be tested without a bus.
  bool step(double value) noexcept;
  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  [[nodiscard]] const std::string& topic() const noexcept { return topic_; }

 private:
  struct Decoder;
  bool prepare(const std::string& type, std::string_view idl);

  std::string text_, topic_, field_;
  bool magnitude_ = false;
  bool above_ = true;
  double threshold_ = 0.0;
  bool beyond_ = false;
  bool prepared_ = false;
  std::shared_ptr<Decoder> decoder_;  // none: the type is not known; shared: triggers are copied
                                      // while they are being listed
};

}  // namespace stillhand::record
