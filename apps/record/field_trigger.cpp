// SPDX-License-Identifier: Apache-2.0
#include "apps/record/field_trigger.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::record {

namespace {

double number_of(const recording::Cell& cell) {
  if (const auto* real = std::get_if<double>(&cell)) return *real;
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*integer);
  if (const auto* natural = std::get_if<std::uint64_t>(&cell)) {
    return static_cast<double>(*natural);
  }
  return std::nan("");
}

const recording::IdlStruct& defined(const recording::IdlSchema& schema, const std::string& type) {
  const recording::IdlStruct* found = schema.find(type);
  if (found == nullptr) throw ConfigError(type, "no definition", "IDL that defines it");
  return *found;
}

}  // namespace

struct FieldTrigger::Decoder {
  Decoder(const std::string& type, std::string_view idl)
      : schema(recording::parse_idl(idl, type)), columns(schema, defined(schema, type)) {
    columns.settle();
  }
  recording::IdlSchema schema;
  recording::MessageColumns columns;
  std::optional<std::size_t> column;  // none: the type has no such number
  std::vector<recording::Cell> row;
};

FieldTrigger::FieldTrigger(const std::string& text) : text_(text) {
  const char* want = "TOPIC.FIELD>VALUE or TOPIC.FIELD<VALUE";
  const std::size_t sign = text.find_first_of("<>");
  if (sign == std::string::npos) throw ConfigError("--trigger", text, want);
  const std::size_t slash = text.rfind('/', sign);
  const std::size_t point = text.find('.', slash == std::string::npos ? 0 : slash);
  if (point == std::string::npos || point == 0 || point + 1 >= sign) {
    throw ConfigError("--trigger", text, want);
  }
  topic_ = text.substr(0, point);
  field_ = text.substr(point + 1, sign - point - 1);
  above_ = text[sign] == '>';
  if (field_.size() > 2 && field_.front() == '|' && field_.back() == '|') {
    magnitude_ = true;
    field_ = field_.substr(1, field_.size() - 2);
  }
  const std::string value = text.substr(sign + 1);
  char* end = nullptr;
  threshold_ = std::strtod(value.c_str(), &end);
  if (value.empty() || end != value.c_str() + value.size() || !std::isfinite(threshold_)) {
    throw ConfigError("--trigger", text, want);
  }
  // A topic of the catalogue is checked now; another one at its first sample, which gives the type.
  const topics::Topic* row = topics::find(topic_);
  if (row != nullptr && !prepare(std::string(row->type), topics::idl_of(row->type))) {
    throw ConfigError("--trigger", text, "a number that " + std::string(row->type) + " has");
  }
}

bool FieldTrigger::prepare(const std::string& type, std::string_view idl) {
  decoder_ = std::make_shared<Decoder>(type, idl);
  const auto& columns = decoder_->columns.columns();
  prepared_ = true;
  const auto found = std::ranges::find(columns, field_, &recording::MessageColumn::name);
  if (found == columns.end() || found->kind == recording::CellKind::kText) return false;
  decoder_->column = static_cast<std::size_t>(found - columns.begin());
  return true;
}

bool FieldTrigger::step(const runtime::FoundWriter& writer, const runtime::TappedSample& sample) {
  if (writer.topic != topic_) return false;
  try {
    if (!prepared_) prepare(writer.type, writer.idl);
  } catch (const ConfigError&) {
    return false;  // a type that is not known has no such number either
  }
  if (!decoder_ || !decoder_->column || !decoder_->columns.read(sample.bytes, decoder_->row))
    return false;
  return step(number_of(decoder_->row[*decoder_->column]));
}

bool FieldTrigger::step(double value) noexcept {
  const double measure = magnitude_ ? std::abs(value) : value;
  const bool was = beyond_;
  beyond_ = above_ ? measure > threshold_ : measure < threshold_;
  return beyond_ && !was;
}

}  // namespace stillhand::record
