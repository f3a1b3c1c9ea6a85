// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/export.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "apps/libraries/report/result_files.hpp"
#include "apps/recordings/column_names.hpp"
#include "apps/recordings/csv_tables.hpp"
#include "apps/recordings/hdf5_tables.hpp"
#include "apps/recordings/mat_tables.hpp"
#include "idl/idl_text.hpp"
#include "idl/topics.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/messages/schema_types.hpp"
#include "services/core/recording/topic_filter.hpp"

namespace stillhand::recordings {
namespace {

constexpr std::size_t kLongestTable = 60;  // room below MATLAB's 63, for a number behind it

// One topic on its way out: all its channels of one type, since a recorder gives each writer its
// own. Messages of a replay are kept apart from live ones.
struct Outlet {
  std::string topic;
  bool replayed = false;
  const recording::IdlStruct* type = nullptr;
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
    return type_of(found->second,
                   recording_.path + ", schema " + std::to_string(channel.schema_id));
  }

 private:
  // A crash can lose the schema; of its own topics this program knows it.
  std::pair<const recording::IdlSchema*, const recording::IdlStruct*> of_catalogue(
      const recording::Channel& channel) {
    const topics::Topic* topic = topics::find(channel.topic);
    if (topic == nullptr) {
      throw ConfigError(channel.topic, "no schema in the recording", "a schema in 'omgidl'");
    }
    const std::string_view text = topics::idl_of(topic->type);
    recording::Schema schema{0, std::string(topic->type), recording::kSchemaEncoding, {}};
    for (const char c : text) schema.bytes.push_back(static_cast<std::byte>(c));
    return type_of(schema, "the catalogue");
  }

  std::pair<const recording::IdlSchema*, const recording::IdlStruct*> type_of(
      const recording::Schema& schema, const std::string& source) {
    std::string key = schema.encoding + "\n" + schema.name + "\n";
    key.append(reinterpret_cast<const char*>(schema.bytes.data()), schema.bytes.size());
    auto& parsed = parsed_[key];
    if (!parsed) {
      parsed = std::make_unique<recording::IdlSchema>(recording::parse_schema(schema, source));
    }
    return {parsed.get(), parsed->find(schema.name)};
  }

  const OpenRecording& recording_;
  std::map<std::string, std::unique_ptr<recording::IdlSchema>> parsed_;
};

// Walks over a recording: once for the lengths of lists where there are any, once for the rows.
class Exporter {
 public:
  Exporter(const std::string& path, const ExportOptions& options)
      : options_(options), recording_(path, options.stopped), schemas_(recording_) {
    // A place that cannot be written, and two outputs of one name, are refused before the work.
    const report::ResultFiles checked(
        {{"--mat", options.mat}, {"--hdf5", options.hdf5}, {"--lateness", options.lateness}},
        {path});
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
    for (const auto& outlet : outlets_) {
      for (auto& sink : outlet->sinks) {
        go_on_unless(options_.stopped);  // a MATLAB file is packed here, a topic at a time
        sink->finish();
      }
      outlet->sinks.clear();
      exported.topics.push_back(outlet->result);
    }
    for (auto& file : files_) file->close();
    go_on_unless(options_.stopped);
    for (auto& file : files_) file->publish();
    exported.left_out = left_out_;
    recording_.report_loss(messages_);
    return exported;
  }

 private:
  void open_outlets() {
    if (recording_.reader.channels().empty()) {
      throw ConfigError(recording_.path, "a recording without a topic",
                        "a recording with messages");
    }
    recording::require_each_matches(options_.topics, "--topics", recording_.reader.channels());
    const recording::TopicFilter wanted{options_.topics, {}};
    for (const auto& [id, channel] : recording_.reader.channels()) {
      if (!wanted.wants(channel.topic)) continue;
      try {
        const auto [schema, type] = schemas_.of(channel);
        by_channel_[id] = outlet_of(channel, *schema, *type);
      } catch (const ConfigError& error) {
        left_out_.push_back(error.what());
      }
    }
    drop_troubled();
  }

  Outlet* outlet_of(const recording::Channel& channel, const recording::IdlSchema& schema,
                    const recording::IdlStruct& type) {
    const bool replayed = channel.metadata.count("replayed") != 0;
    for (const auto& outlet : outlets_) {
      if (outlet->topic == channel.topic && outlet->type == &type && outlet->replayed == replayed) {
        return outlet.get();
      }
    }
    auto outlet = std::make_unique<Outlet>();
    outlet->topic = channel.topic;
    outlet->replayed = replayed;
    outlet->type = &type;
    outlet->columns = std::make_unique<recording::MessageColumns>(schema, type);
    outlet->result.topic = channel.topic + (replayed ? " (replayed)" : "");
    outlet->result.name = plain_name(channel.topic, kLongestTable, names_);
    outlets_.push_back(std::move(outlet));
    return outlets_.back().get();
  }

  void drop_troubled() {
    const auto troubled = [](const Outlet& outlet) { return !outlet.columns->trouble().empty(); };
    std::erase_if(by_channel_, [&](const auto& entry) { return troubled(*entry.second); });
    std::erase_if(outlets_, [&](const auto& outlet) {
      if (!troubled(*outlet)) return false;
      left_out_.push_back(outlet->topic + ": " + outlet->columns->trouble());
      return true;
    });
    if (outlets_.empty() && !left_out_.empty()) {
      throw ConfigError(recording_.path, "nothing that can be exported (" + left_out_.front() + ")",
                        "messages in CDR with their IDL as schema (omgidl)");
    }
  }

  void learn() {
    recording::MessageFilter filter;
    for (const auto& outlet : outlets_) {
      if (outlet->columns->has_lists()) filter.topics.push_back(outlet->topic);
    }
    if (!filter.topics.empty()) {
      check(recording_.reader.for_each_message(filter, [&](const recording::MessageView& message) {
        const auto found = by_channel_.find(message.channel.id);
        // A message that does not match its type is counted in write().
        if (found != by_channel_.end()) (void)found->second->columns->learn(message.bytes);
        return true;
      }));
    }
    drop_troubled();
    for (const auto& outlet : outlets_) outlet->columns->settle();
  }

  void make_tables() {
    for (const auto& outlet : outlets_) {
      const TopicTable table{outlet->result.name, outlet->topic, outlet->type->name,
                             outlet->columns->columns()};
      outlet->result.columns = table.columns.size() + 4;
      const std::uint64_t rows = messages_of(*outlet);
      for (auto& file : files_) outlet->sinks.push_back(file->add(table, rows));
    }
  }

  // By the file's statistics; a damaged file may hold fewer.
  [[nodiscard]] std::uint64_t messages_of(const Outlet& outlet) const {
    const auto& counts = recording_.reader.statistics().channel_message_counts;
    std::uint64_t messages = 0;
    for (const auto& [id, of] : by_channel_) {
      const auto count = counts.find(id);
      if (of == &outlet && count != counts.end()) messages += count->second;
    }
    return messages;
  }

  void write() {
    const std::uint64_t start_ns = recording_.reader.statistics().start_time_ns;
    std::vector<recording::Cell> cells;
    check(recording_.reader.for_each_message({}, [&](const recording::MessageView& message) {
      ++messages_;
      const auto found = by_channel_.find(message.channel.id);
      if (found == by_channel_.end()) return true;
      Outlet& outlet = *found->second;
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
  std::vector<std::string> left_out_;
  std::vector<std::unique_ptr<TableFile>> files_;  // outlive their sinks
  std::vector<std::unique_ptr<Outlet>> outlets_;
  std::map<recording::ChannelId, Outlet*> by_channel_;
  std::uint64_t messages_ = 0;
};

}  // namespace

Exported export_recording(const std::string& path, const ExportOptions& options) {
  return Exporter(path, options).run();
}

}  // namespace stillhand::recordings
