// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/message_feed.hpp"

#include <algorithm>
#include <utility>

#include "apps/dashboard/feed/topic_plans.hpp"
#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/session_state.hpp"
#include "services/core/contract/time_difference.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/device_rig/parts_note.hpp"
#include "services/core/recording/mcap/sample_clock.hpp"

namespace stillhand::dashboard {

namespace {

constexpr std::size_t kNone = SIZE_MAX;
constexpr std::size_t kMostEvents = 50;
constexpr Tick kLastTick = 1'000'000'000'000;  // 30 years: no session's

std::vector<std::string> service_names() {
  return {topics::kServices.begin(), topics::kServices.end()};
}

std::size_t service_number(const std::string& name) {
  const auto found = std::ranges::find(topics::kServices, name);
  return found == topics::kServices.end()
             ? kNone
             : static_cast<std::size_t>(found - topics::kServices.begin());
}

std::string text_of(const stillhand_msgs::TrialAssignment& assignment) {
  if (assignment.motion() == stillhand_msgs::MOTION_STILL) return "still";
  if (!assignment.parts().empty()) return std::string("motion, ") + assignment.mitigation().c_str();
  return assignment.cancellation() ? "motion, cancellation" : "motion, no cancellation";
}

}  // namespace

MessageFeed::MessageFeed(FeedOptions options)
    : options_(std::move(options)),
      health_(options_.config, topic_plans(options_.config), service_names()) {
  if (options_.answers && !options_.blinded) cost_.emplace(*options_.answers);
}

bool MessageFeed::wants(const std::string& topic) const {
  if (options_.blinded && topic == topics::kTrialAssignment.name) return false;
  return topics::find(topic) != nullptr;
}

std::uint32_t MessageFeed::add(const Source& source) {
  Known known{kNone, nullptr, "", source.replayed};
  for (std::size_t topic = 0; topic < kFeedTopics.size(); ++topic) {
    if (kFeedTopics[topic]->name != source.topic || kFeedTopics[topic]->type != source.type)
      continue;
    if (!wants(source.topic)) continue;
    known.topic = topic;
    known.row = kFeedTopics[topic];
  }
  if (source.topic == topics::kRecorderStatus.name && source.type == topics::kRecorderStatus.type) {
    known.row = &topics::kRecorderStatus;
  }
  const std::string prefix = "stillhand/" + std::to_string(options_.rig) + "/";
  if (source.participant.starts_with(prefix))
    known.service = source.participant.substr(prefix.size());
  replayed_ = replayed_ || source.replayed;
  sources_.push_back(std::move(known));
  return static_cast<std::uint32_t>(sources_.size() - 1);
}

bool MessageFeed::passed_over(const Known& known) {
  if (known.replayed) return session_heard_;
  if (session_heard_ || service_number(known.service) == kNone) return false;
  if (replayed_) {
    MessageFeed fresh(options_);
    fresh.sources_.swap(sources_);  // its elements stay where they are
    fresh.replayed_ = true;
    *this = std::move(fresh);
  }
  session_heard_ = true;
  return false;
}

Heard MessageFeed::take(const Message& message) {
  const Known& known = sources_.at(message.source);
  if (known.row == &topics::kRecorderStatus) take_recorder(message);
  if (known.topic == kNone) return {};
  const recording::SampleHead head = recording::sample_head(message.bytes);
  if (head.rig != options_.rig || passed_over(known)) return {};  // also malformed bytes
  Sample sample{message.source, message.sequence, -1, 0, message.source_ns, message.arrived_ns};
  if (known.row->pattern == topics::Pattern::kStream1khz) {
    if (head.tick < 0 || head.tick > kLastTick) {
      ++malformed_;
      return {};
    }
    sample.tick = head.tick;
    sample.stamp_ns = head.stamp_ns;
  }
  const Verdict verdict = health_.take(known.topic, sample, system_ahead_ns(known.service));
  if (!verdict.counted) return {};
  if (known.row->pattern == topics::Pattern::kStream1khz) {
    newest_tick_ = head.tick;
    take_stream(known, message);
  } else {
    look_into(known, message);
  }
  return {known.row, verdict};
}

template <typename Decoded, typename Use>
void MessageFeed::decode(const Message& message, Use use) {
  Decoded decoded;
  if (from_cdr(message.bytes, decoded)) {
    use(decoded);
  } else {
    ++malformed_;
  }
}

void MessageFeed::take_stream(const Known& known, const Message& message) {
  if (known.row == &topics::kSensed) {
    decode<stillhand_msgs::Sensed>(message, [this, at_ns = message.arrived_ns](const auto& sensed) {
      const std::int64_t stamp_ns = difference_ns(sensed.stamp_ns(), ahead_of_rig_ns("sensing"));
      health_.chain().sensed(sensed.acquired_ns(), stamp_ns);
      if (cost_) cost_->take(sensed, stamp_ns);
      traces_.put(sensed.tick(), Signal::kAcceleration, sensed.accel_y_m_s2());
      if (forces_hidden(at_ns)) return;
      traces_.put(sensed.tick(), Signal::kForce, sensed.force_n());
      forces_.measured(sensed.tick(), sensed.force_n());
    });
  } else if (known.row == &topics::kMotorCommand) {
    decode<stillhand_msgs::MotorCommand>(message, [this](const auto& command) {
      const std::int64_t stamp_ns =
          difference_ns(command.stamp_ns(), ahead_of_rig_ns("cancellation"));
      health_.chain().command(command.tick(), command.acquired_ns(), stamp_ns);
      if (cost_) cost_->take(command, stamp_ns);
      traces_.put(command.tick(), Signal::kPredictedForce, command.predicted_force_n());
      forces_.predicted(command.tick(), command.predicted_force_n());
    });
  } else if (known.row == &topics::kRigTruth) {
    if (rig_writer_ && *rig_writer_ != message.source) {
      health_.chain().clear();
      forces_ = {};
      // A process that starts now has not been stopped, and may be another rig.
      if (message.source > *rig_writer_) {
        emergency_ns_ = 0;
        rig_parts_.clear();
      }
    }
    rig_writer_ = message.source;
    decode<stillhand_msgs::RigTruth>(
        message, [this, at_ns = message.arrived_ns](const auto& truth) {
          health_.chain().used(truth.motor_tick(), truth.stamp_ns());
          if (cost_) cost_->take(truth);
          if (forces_hidden(at_ns)) return;
          traces_.put(truth.tick(), Signal::kMotorForce, truth.motor_force_n());
        });
  } else if (known.row == &topics::kRawSample && cost_) {
    decode<stillhand_msgs::RawSample>(message, [this](const auto& raw) { cost_->take(raw); });
  } else if (known.row == &topics::kTrackingSample) {
    decode<stillhand_msgs::TrackingSample>(message, [this](const auto& sample) {
      traces_.put(sample.tick(), Signal::kTarget, sample.target_m());
      traces_.put(sample.tick(), Signal::kCursor, sample.cursor_m());
    });
  }
}

void MessageFeed::look_into(const Known& known, const Message& message) {
  const std::int64_t at_ns = message.arrived_ns;
  if (known.row == &topics::kServiceStatus) {
    decode<stillhand_msgs::ServiceStatus>(message,
                                          [&](const auto& status) { take_status(status, at_ns); });
  } else if (known.row == &topics::kTrialControl) {
    decode<stillhand_msgs::TrialControl>(
        message, [&](const auto& control) { take_control(control, at_ns); });
  } else if (known.row == &topics::kPrompt) {
    decode<stillhand_msgs::Prompt>(message, [this](const auto& prompt) { prompt_ = prompt; });
  } else if (known.row == &topics::kTrialAssignment) {
    decode<stillhand_msgs::TrialAssignment>(message, [this](const auto& assignment) {
      condition_ = text_of(assignment);
      if (cost_) cost_->take(assignment);
    });
  } else if (known.row == &topics::kFeedthroughModel && cost_) {
    decode<stillhand_msgs::FeedthroughModel>(message,
                                             [this](const auto& model) { cost_->take(model); });
  } else if (known.row == &topics::kAugmentedModel && cost_) {
    decode<stillhand_msgs::AugmentedModel>(message,
                                           [this](const auto& model) { cost_->take(model); });
  } else if (known.row == &topics::kClockOffset) {
    decode<stillhand_msgs::ClockOffset>(message, [this](const auto& offset) {
      const std::string service = offset.service().to_string();
      if (service_number(service) != kNone) clocks_[service] = offset;
    });
  } else if (known.row == &topics::kEvent) {
    decode<stillhand_msgs::Event>(message, [&](const auto& event) { take_event(event, at_ns); });
  } else if (known.row == &topics::kHostStatus) {
    decode<stillhand_msgs::HostStatus>(message, [&](const auto& host) { take_host(host, at_ns); });
  }
}

void MessageFeed::take_event(const stillhand_msgs::Event& event, std::int64_t at_ns) {
  // Only a model that is used can fail: the motor acts.
  if (event.code() == stillhand_msgs::CODE_MODEL_CHANGED && forces_hidden(at_ns)) return;
  events_.push_front({at_ns, event});
  if (events_.size() > kMostEvents) events_.pop_back();
  if (event.kind() == stillhand_msgs::EVENT_FORCE_ZERO && options_.blinded) hide_delay();
  if (event.code() == stillhand_msgs::CODE_EMERGENCY_STOP) emergency_ns_ = at_ns;
  if (const std::string text = event.text().to_string();
      device_rig::is_parts_note(event.source().to_string(), text)) {
    rig_parts_ = text.substr(device_rig::kPartsNote.size());
  }
  if (event.kind() == stillhand_msgs::EVENT_INCOMPATIBLE_QOS) {
    qos_mismatches_.note(event.source().to_string(), event.topic().to_string(),
                         event.text().to_string(), at_ns);
  }
}

// How long a force takes to become zero shows whether there was one: the report appears as of the
// instant at which the interlock opened.
void MessageFeed::hide_delay() {
  stillhand_msgs::Event& zero = events_.front().event;
  zero.by_us(0.0);
  zero.tick(-1);
  const auto opened = std::ranges::find_if(events_, [&](const HeardEvent& heard) {
    return heard.event.kind() == stillhand_msgs::EVENT_INTERLOCK_OPENED &&
           heard.event.source() == zero.source();
  });
  if (opened != events_.end()) events_.front().at_ns = opened->at_ns;
}

void MessageFeed::take_host(const stillhand_msgs::HostStatus& host, std::int64_t at_ns) {
  const std::size_t number = service_number(host.service().to_string());
  if (number == kNone) return;
  services_[number].host = host;
  services_[number].host_at_ns = at_ns;
}

// A recorder stands outside of every session and rig.
void MessageFeed::take_recorder(const Message& message) {
  constexpr std::size_t kMostRecorders = 16;
  decode<stillhand_msgs::RecorderStatus>(message, [&](const auto& status) {
    const std::string name = status.recorder().to_string();
    if (recorders_.size() >= kMostRecorders && !recorders_.contains(name)) return;
    recorders_.insert_or_assign(name, RecorderView{message.arrived_ns, status});
  });
}

void MessageFeed::take_control(const stillhand_msgs::TrialControl& control, std::int64_t at_ns) {
  // What the last session's participant saw is not of the next one.
  const bool was_over = control_ && control_->session() == stillhand_msgs::SESSION_ENDING;
  if (was_over && control.session() != stillhand_msgs::SESSION_ENDING) prompt_.reset();
  if (tracks()) tracked_ns_ = at_ns;
  control_ = control;
  if (cost_) cost_->take(control);
  health_.set_running(is_running(control.session()), at_ns);
}

void MessageFeed::take_status(const stillhand_msgs::ServiceStatus& status, std::int64_t at_ns) {
  const std::size_t number = service_number(status.service().to_string());
  if (number == kNone) return;
  health_.alive(number, at_ns);
  const ServiceView& before = services_[number];
  ServiceView view;
  view.host = before.host;
  view.host_at_ns = before.host_at_ns;
  if (before.status && before.status->pid() == status.pid()) {
    view.reads = before.reads;
  } else {
    qos_mismatches_.begun(status.service().to_string(), at_ns);
  }
  for (const auto& topic : status.topics()) {
    if (topic.written()) continue;
    const topics::Topic* row = topics::find(topic.topic().to_string());
    if (row == nullptr) continue;
    view.reads[std::string(row->name)].step(
        {topic.matched(), topic.samples(), topic.lost_ticks(), topic.cycle_misses(),
         topic.deadline_misses(), topic.worst_interval_us(), topic.latency_p99_us()},
        at_ns);
    view.deadline_misses += topic.deadline_misses();
    view.cycle_misses += topic.cycle_misses();
    view.lost_ticks += topic.lost_ticks();
  }
  view.status = status;
  services_[number] = std::move(view);
}

// While a person tracks, a motor force reveals that this trial cancels; so does the hand's, which
// answers it and then follows the prediction.  A trial is announced
// before it begins.  Before the first announcement came, one may run, and one that is stopped
// leaves a force that goes to zero.
bool MessageFeed::forces_hidden(std::int64_t at_ns) const noexcept {
  constexpr std::int64_t kFades_ns = 1'000'000'000;
  const bool faded = tracked_ns_ == 0 || difference_ns(at_ns, tracked_ns_) > kFades_ns;
  return options_.blinded && (!control_ || !faded || tracks());
}

// Eq. DB-4: both relative to the experiment's clock.
std::int64_t MessageFeed::system_ahead_ns(const std::string& service) const {
  const auto ahead = [this](const std::string& name) -> std::int64_t {
    const auto found = clocks_.find(name);
    if (found == clocks_.end() || found->second.same_clock()) return 0;
    return found->second.system_offset_ns();
  };
  return clocks_.empty() ? 0 : difference_ns(ahead(service), ahead(options_.listener));
}

std::int64_t MessageFeed::ahead_of_rig_ns(const std::string& service) const {
  const auto ahead = [this](const std::string& name) -> std::int64_t {
    const auto found = clocks_.find(name);
    return found == clocks_.end() ? 0 : found->second.offset_ns();
  };
  return clocks_.empty() ? 0 : difference_ns(ahead(service), ahead("rig"));
}

void MessageFeed::step(std::int64_t now_ns) {
  constexpr std::int64_t kForgotten_ns = 60'000'000'000;
  std::erase_if(recorders_, [&](const auto& entry) {
    return difference_ns(now_ns, entry.second.at_ns) > kForgotten_ns;
  });
  health_.step(now_ns);
}

}  // namespace stillhand::dashboard
