// SPDX-License-Identifier: Apache-2.0
#include "recorder/export.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "contract/config_error.hpp"
#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "recorder/column_names.hpp"
#include "recorder/csv_tables.hpp"
#include "recorder/hdf5_tables.hpp"
#include "recorder/mat_tables.hpp"
#include "recorder/open_recording.hpp"
#include "recording/core/topic_filter.hpp"
#include "report/result_files.hpp"

namespace stillhand::recorder {
namespace {

constexpr std::size_t kLongestTable = 60;  // room below MATLAB's 63, for a number behind it

// One channel on its way out.
struct Outlet {
  const recording::Channel* channel = nullptr;
  const recording::IdlSchema* schema = nullptr;
  std::unique_ptr<recording::MessageColumns> columns;
  std::vector<std::unique_ptr<TableSink>> sinks;
  ExportedTopic result;
};

// The schemas of a recording, each parsed once.
class Schemas {
 public:
  explicit Schemas(const OpenRecording& recording) : recording_(recording) {}

  /// Schema and type of a channel.  @throws ConfigError why it cannot be decoded.
  std::pair<const recording::IdlSchema*, const recording::IdlStruct*> of(
      const recording::Channel& channel) {
    if (channel.message_encoding != recording::kMessageEncoding) {
      throw ConfigError(channel.topic, "messages in '" + channel.message_encoding + "'",
                        "messages in 'cdr'");
    }
    const auto& known = recording_.reader.schemas();
    const auto found = known.find(channel.schema_id);
    if (found == known.end()) return of_catalogue(channel);
    const recording::Schema& schema = found->second;
    if (schema.encoding != recording::kSchemaEncoding) {
      throw ConfigError(channel.topic, "a schema in '" + schema.encoding + "'", "one in 'omgidl'");
    }
    const std::string_view text(reinterpret_cast<const char*>(schema.bytes.data()),
                                schema.bytes.size());
    return type_in(text, schema.name, recording_.path + ", schema " + std::to_string(schema.id));
  }

 private:
  // A crash can lose the schema; of its own topics this program knows it.
  std::pair<const recording::IdlSchema*, const recording::IdlStruct*> of_catalogue(
      const recording::Channel& channel) {
    const topics::Topic* topic = topics::find(channel.topic);
    if (topic == nullptr) {
      throw ConfigError(channel.topic, "no schema in the recording", "one in 'omgidl'");
    }
    return type_in(topics::idl_of(topic->type), std::string(topic->type), "the catalogue");
  }

  std::pair<const recording::IdlSchema*, const recording::IdlStruct*> type_in(
      std::string_view text, const std::string& name, const std::string& source) {
    const auto* schema = parse(text, source);
    const auto* type = schema->find(name);
    if (type == nullptr) {
      throw ConfigError(source, "no struct " + name + " in it", "the type of the messages");
    }
    return {schema, type};
  }

  const recording::IdlSchema* parse(std::string_view text, const std::string& source) {
    auto& parsed = parsed_[std::string(text)];
    if (!parsed) {
      parsed = std::make_unique<recording::IdlSchema>(recording::parse_idl(text, source));
    }
    return parsed.get();
  }

  const OpenRecording& recording_;
  std::map<std::string, std::unique_ptr<recording::IdlSchema>> parsed_;
};

std::string topics_in(const recording::McapReader& reader) {
  std::string names;
  for (const auto& [id, channel] : reader.channels()) {
    names += (names.empty() ? "" : ", ") + channel.topic;
  }
  return names.empty() ? "a recording with topics" : "one of " + names;
}

// Walks over a recording: once for the lengths of lists where there are any, once for the rows.
class Exporter {
 public:
  Exporter(const std::string& path, const ExportOptions& options)
      : options_(options), recording_(path), schemas_(recording_) {
    // Says what is wrong with a place before the work.
    const report::ResultFiles checked({{"--mat", options.mat}, {"--hdf5", options.hdf5}}, {path});
    (void)checked;
    open_outlets();
  }

  Exported run() {
    learn();
    if (!options_.csv.empty()) files_.push_back(csv_tables(options_.csv));
    if (!options_.mat.empty()) files_.push_back(mat_tables(options_.mat.string()));
    if (!options_.hdf5.empty()) files_.push_back(hdf5_tables(options_.hdf5.string()));
    make_tables();
    write();
    Exported exported;
    for (auto& [id, outlet] : outlets_) {
      for (auto& sink : outlet.sinks) sink->finish();
      outlet.sinks.clear();
      exported.topics.push_back(outlet.result);
    }
    for (auto& file : files_) file->publish();
    exported.left_out = left_out_;
    recording_.tell_loss(messages_);
    return exported;
  }

 private:
  void open_outlets() {
    bool matched = false;
    const recording::TopicFilter wanted{options_.topics, {}};
    for (const auto& [id, channel] : recording_.reader.channels()) {
      if (!wanted.wants(channel.topic)) continue;
      matched = true;
      try {
        const auto [schema, type] = schemas_.of(channel);
        Outlet outlet;
        outlet.channel = &channel;
        outlet.columns = std::make_unique<recording::MessageColumns>(*schema, *type);
        outlet.result.topic = channel.topic;
        outlet.result.name = plain_name(channel.topic, kLongestTable, names_);
        types_[id] = type->name;
        outlets_[id] = std::move(outlet);
      } catch (const ConfigError& error) {
        left_out_.push_back(error.what());
      }
    }
    drop_troubled();
    if (!matched) {
      throw options_.topics.empty()
          ? ConfigError(recording_.path, "a recording without a topic", "one that holds messages")
          : ConfigError("--topics", "no topic of that name", topics_in(recording_.reader));
    }
  }

  void drop_troubled() {
    std::erase_if(outlets_, [&](const auto& entry) {
      const std::string& trouble = entry.second.columns->trouble();
      if (!trouble.empty()) left_out_.push_back(entry.second.channel->topic + ": " + trouble);
      return !trouble.empty();
    });
    if (outlets_.empty() && !left_out_.empty()) {
      throw ConfigError(recording_.path, "nothing that can be exported (" + left_out_.front() + ")",
                        "messages in CDR with their IDL as schema (omgidl)");
    }
  }

  void learn() {
    recording::MessageFilter filter;
    for (const auto& [id, outlet] : outlets_) {
      if (outlet.columns->has_lists()) filter.topics.push_back(outlet.channel->topic);
    }
    if (!filter.topics.empty()) {
      check(recording_.reader.for_each_message(filter, [&](const recording::MessageView& message) {
        const auto outlet = outlets_.find(message.channel.id);
        // What is no message of its type is counted when it is written.
        if (outlet != outlets_.end()) (void)outlet->second.columns->learn(message.bytes);
        return true;
      }));
    }
    drop_troubled();
    for (auto& [id, outlet] : outlets_) outlet.columns->settle();
  }

  void make_tables() {
    for (auto& [id, outlet] : outlets_) {
      const TopicTable table{outlet.result.name, outlet.result.topic, types_.at(id),
                             outlet.columns->columns()};
      outlet.result.columns = table.columns.size() + 4;
      for (auto& file : files_) outlet.sinks.push_back(file->add(table));
    }
  }

  void write() {
    const std::uint64_t start_ns = recording_.reader.statistics().start_time_ns;
    std::vector<recording::Cell> cells;
    check(recording_.reader.for_each_message({}, [&](const recording::MessageView& message) {
      ++messages_;
      const auto found = outlets_.find(message.channel.id);
      if (found == outlets_.end()) return true;
      Outlet& outlet = found->second;
      if (!outlet.columns->read(message.bytes, cells)) {
        ++outlet.result.unread;
        return true;
      }
      const TableRow row{static_cast<std::int64_t>(message.log_time_ns - start_ns),
                         message.log_time_ns, message.publish_time_ns, message.sequence, cells};
      for (auto& sink : outlet.sinks) sink->take(row);
      ++outlet.result.rows;
      return true;
    }));
  }

  const ExportOptions& options_;
  OpenRecording recording_;
  Schemas schemas_;
  std::set<std::string> names_;
  std::map<recording::ChannelId, std::string> types_;
  std::vector<std::string> left_out_;
  std::vector<std::unique_ptr<TableFile>> files_;  // outlive their sinks
  std::map<recording::ChannelId, Outlet> outlets_;
  std::uint64_t messages_ = 0;
};

}  // namespace

Exported export_recording(const std::string& path, const ExportOptions& options) {
  return Exporter(path, options).run();
}

}  // namespace stillhand::recorder
