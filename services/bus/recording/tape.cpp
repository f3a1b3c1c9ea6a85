// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/tape.hpp"

#include <sys/statvfs.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>

#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/process/clock.hpp"
#include "services/system/process/real_time.hpp"

namespace stillhand::recording {
namespace {

constexpr std::chrono::milliseconds kWriteInterval{20};
constexpr std::size_t kWakeBytes = 1u << 20;
constexpr std::int64_t kGuardInterval_ns = 100'000'000;
constexpr std::size_t kMaxWindowBytes = std::size_t{1} << 30;

/// Free bytes on the disk of `path`; UINT64_MAX if the system does not report them.
std::uint64_t free_bytes_at(const std::string& path) {
  struct statvfs facts{};
  std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (folder.empty()) folder = ".";
  if (::statvfs(folder.c_str(), &facts) != 0) return UINT64_MAX;
  return static_cast<std::uint64_t>(facts.f_bavail) * facts.f_frsize;
}

std::string mib(std::uint64_t bytes) {
  constexpr std::uint64_t kMiB = 1u << 20;
  return std::to_string(bytes / kMiB) + "." + std::to_string(bytes % kMiB * 10 / kMiB) + " MiB";
}

}  // namespace

/// One file.
struct Tape::Part {
  Part(const std::string& path_, const TapeOptions& options)
      : path(path_),
        file(path_, Existing::kRefuse, options.durability),
        writer(file, options.writer) {}

  ChannelId define(std::uint32_t channel, const Definition& wanted) {
    // Two programs may define one name differently.
    const auto [schema, fresh] =
        schemas.try_emplace({wanted.schema_name, wanted.schema_text}, SchemaId{0});
    if (fresh) {
      schema->second =
          writer.add_schema(wanted.schema_name, wanted.schema_text.empty() ? "" : kSchemaEncoding,
                            wanted.schema_text);
    }
    const ChannelId id =
        writer.add_channel(wanted.channel.topic, schema->second, wanted.channel.message_encoding,
                           wanted.channel.metadata);
    ids.emplace(channel, id);
    return id;
  }

  std::string path;
  FileSink file;
  McapWriter writer;
  std::map<std::uint32_t, ChannelId> ids;
  std::map<std::pair<std::string, std::string_view>, SchemaId> schemas;  // by name and text
  std::optional<std::int64_t> first_ns;  // of the first message, as received
};

Tape::Tape(TapeOptions options)
    : options_(std::move(options)), window_(options_.window_ns, kMaxWindowBytes) {
  const std::uint64_t left = free_bytes_at(options_.path);
  if (left < options_.min_free_bytes) {
    throw ConfigError(options_.path, mib(left) + " left on the disk",
                      "at least " + mib(options_.min_free_bytes) + ", or a smaller --min-free-mb");
  }
  if (!open_part()) {
    part_.reset();
    std::error_code none;
    std::filesystem::remove(options_.path, none);  // this tape created the file, and it is empty
    throw std::runtime_error(status_.stopped);
  }
  writing_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

Tape::~Tape() { static_cast<void>(close()); }

std::uint32_t Tape::add_channel(Channel channel, std::string schema_name,
                                std::string_view schema_text) {
  const std::lock_guard lock(mutex_);
  const std::string_view kept = *schema_texts_.emplace(schema_text).first;
  definitions_.push_back({std::move(channel), std::move(schema_name), kept});
  written_.push_back(0);
  return static_cast<std::uint32_t>(definitions_.size() - 1);
}

void Tape::put(std::uint32_t channel, std::uint32_t sequence, std::int64_t log_time_ns,
               std::int64_t publish_time_ns, std::int64_t received_ns,
               std::span<const std::byte> bytes) {
  bool much = false;
  {
    const std::lock_guard lock(mutex_);
    if (stopped_.load(std::memory_order_relaxed) || bytes.size() > McapWriter::kMaxMessageBytes ||
        filling_.bytes.size() + bytes.size() > options_.max_queued_bytes) {
      ++status_.dropped;
      return;
    }
    if (paused_.load(std::memory_order_relaxed)) {
      ++status_.passed_over;
      return;
    }
    filling_.add({channel, sequence, static_cast<std::uint64_t>(log_time_ns),
                  static_cast<std::uint64_t>(publish_time_ns), received_ns, 0, 0},
                 bytes);
    much = filling_.bytes.size() > kWakeBytes;
  }
  if (much) wake_.notify_one();
}

bool Tape::sync() {
  std::unique_lock lock(mutex_);
  sync_wanted_ = true;
  wake_.notify_one();
  synced_.wait(lock, [this] { return !sync_wanted_; });
  return !stopped();
}

void Tape::trigger(const std::string& why) {
  const std::lock_guard lock(mutex_);
  triggers_.push_back(why);
}

TapeStatus Tape::status() const {
  const std::lock_guard lock(mutex_);
  TapeStatus status = status_;
  status.paused = paused_.load(std::memory_order_relaxed);
  return status;
}

std::vector<std::uint64_t> Tape::written_by_channel() const {
  const std::lock_guard lock(mutex_);
  return written_;
}

void Tape::work(const std::stop_token& stop) {
  runtime::become_background(runtime::Locks::kOwn);
  MessageBatch batch;
  for (bool last = false; !last;) {
    std::vector<std::string> triggers;
    bool sync = false;
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, stop, kWriteInterval,
                     [this] { return sync_wanted_ || filling_.bytes.size() > kWakeBytes; });
      sync = sync_wanted_;
      last = stop.stop_requested();
      batch.clear();
      std::swap(batch, filling_);
      std::swap(triggers, triggers_);
    }
    take_batch(batch);
    for (const std::string& why : triggers) write_window(why);
    guard_disk();
    const std::int64_t now_ns = runtime::monotonic_ns();
    if (part_ && now_ns - flushed_ns_ > options_.flush_interval_ns) {
      flushed_ns_ = now_ns;
      if (const Status status = part_->writer.flush_chunk(); !status.ok()) {
        stop_because(status.text);
      }
    }
    if (sync) put_on_disk();
  }
}

// Of a part that is closed, close_part() has done it.
void Tape::put_on_disk() {
  Status status = part_ ? part_->writer.flush_chunk() : Status{};
  if (part_ && status.ok()) status = part_->file.flush();
  if (!status.ok()) stop_because(status.text);
  {
    const std::lock_guard lock(mutex_);
    sync_wanted_ = false;
  }
  synced_.notify_all();
}

void Tape::take_batch(MessageBatch& batch) {
  if (options_.window_ns == 0) return write_batch(batch);
  const std::uint64_t before = window_.held_messages() + batch.messages.size();
  window_.add(std::move(batch));
  batch = {};
  const std::lock_guard lock(mutex_);
  status_.passed_over += before - window_.held_messages();
  status_.held = window_.held_messages();
}

void Tape::write_window(const std::string& why) {
  if (part_) {
    static_cast<void>(part_->writer.add_metadata(
        "stillhand.trigger",
        {{"cause", why}, {"messages", std::to_string(window_.held_messages())}}));
  }
  for (const MessageBatch& batch : window_.take()) write_batch(batch);
  const std::lock_guard lock(mutex_);
  status_.held = 0;
}

void Tape::write_batch(const MessageBatch& batch) {
  std::uint64_t written = 0;
  std::vector<std::uint64_t> by_channel;
  for (const HeldMessage& held : batch.messages) {
    if (part_ && part_->first_ns &&
        is_full(options_.rotation, part_->file.size(), held.received_ns - *part_->first_ns)) {
      close_part();
      if (!stopped()) open_part();
    }
    if (!part_) break;
    const std::optional<ChannelId> id = id_of(held.channel);
    if (!id) continue;  // dropped, and counted
    if (!part_->first_ns) part_->first_ns = held.received_ns;
    const Status status = part_->writer.write(*id, held.sequence, held.log_time_ns,
                                              held.publish_time_ns, batch.content(held));
    if (status.ok()) {
      ++written;
      if (held.channel >= by_channel.size()) by_channel.resize(held.channel + 1);
      ++by_channel[held.channel];
    } else {
      stop_because(status.text);
    }
  }
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < by_channel.size(); ++i) written_[i] += by_channel[i];
  status_.written += written;
  status_.dropped += batch.messages.size() - written;
  if (part_) status_.bytes = part_->file.size();
}

std::optional<ChannelId> Tape::id_of(std::uint32_t channel) {
  const auto known = part_->ids.find(channel);
  if (known != part_->ids.end()) return known->second;
  if (part_->ids.size() >= McapWriter::kMaxIds) return std::nullopt;
  const std::lock_guard lock(mutex_);
  return part_->define(channel, definitions_[channel]);
}

bool Tape::open_part() {
  const std::uint32_t number = status_.parts + 1;
  const std::string path = part_name(options_.path, number);
  try {
    part_ = std::make_unique<Part>(path, options_);
  } catch (const ConfigError& error) {
    if (number == 1) throw;
    stop_because(error.what());
    return false;
  }
  TextMap session = options_.session;
  session["part"] = std::to_string(number);
  std::vector<Metadata> words{{"stillhand.session", session}};
  words.insert(words.end(), options_.first_words.begin(), options_.first_words.end());
  for (const Metadata& record : words) {
    const Status status = part_->writer.add_metadata(record.name, record.texts);
    if (status.ok()) continue;
    stop_because(status.text);
    return false;
  }
  const std::lock_guard lock(mutex_);
  status_.parts = number;
  status_.file = path;
  status_.bytes = part_->file.size();
  return true;
}

void Tape::close_part() {
  if (!part_) return;
  if (options_.last_words) {
    for (const Metadata& words : options_.last_words()) {
      static_cast<void>(part_->writer.add_metadata(words.name, words.texts));
    }
  }
  Status status = part_->writer.close();
  if (status.ok()) status = part_->file.flush();
  part_.reset();
  if (!status.ok()) stop_because(status.text);
}

void Tape::guard_disk() {
  const std::int64_t now_ns = runtime::monotonic_ns();
  if (!part_ || now_ns - guarded_ns_ < kGuardInterval_ns) return;
  guarded_ns_ = now_ns;
  const std::uint64_t left = free_bytes_at(part_->path);
  {
    const std::lock_guard lock(mutex_);
    status_.free_bytes = left;
  }
  if (left >= options_.min_free_bytes) return;
  const std::string path = part_->path;
  stop_because(path + ": recording stopped, " + mib(left) + " left on the disk, want " +
               mib(options_.min_free_bytes));
  close_part();
}

void Tape::stop_because(std::string why) {
  const std::lock_guard lock(mutex_);
  if (status_.stopped.empty()) status_.stopped = std::move(why);
  stopped_.store(true, std::memory_order_relaxed);
}

Status Tape::close() {
  if (!closed_) {
    closed_ = true;
    writing_.request_stop();
    if (writing_.joinable()) writing_.join();
    {
      const std::lock_guard lock(mutex_);
      status_.passed_over += window_.held_messages();
      status_.held = 0;
    }
    close_part();
  }
  const std::lock_guard lock(mutex_);
  if (status_.stopped.empty()) return {};
  return Status::failure(StatusKind::kIo, status_.stopped);
}

}  // namespace stillhand::recording
