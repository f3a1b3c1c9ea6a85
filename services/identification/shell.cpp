// SPDX-License-Identifier: Apache-2.0
#include "services/identification/shell.hpp"

#include "services/contract/config_error.hpp"
#include "services/identification/codec.hpp"
#include "services/runtime/process/real_time.hpp"

namespace stillhand::identification {
namespace {

// More than this share of lost ticks and the interpolation begins to colour the fit.
constexpr double kMaxLostShare = 0.01;

}  // namespace

void PeggedRecord::begin(const Trial& trial) {
  trial_ = trial;
  active_ = true;
  lost_ = 0;
  record_.rate_hz = kControlRateHz;
  record_.acceleration_m_s2.clear();
  record_.force_n.clear();
  record_.acceleration_m_s2.reserve(static_cast<std::size_t>(trial.duration_ticks));
  record_.force_n.reserve(static_cast<std::size_t>(trial.duration_ticks));
}

bool PeggedRecord::take(Tick tick, double accel_m_s2, double force_n) {
  if (!active_ || tick < trial_.start_tick) return false;
  const Tick end = trial_.start_tick + trial_.duration_ticks;
  if (tick < end) {
    const Tick expected = trial_.start_tick + static_cast<Tick>(record_.size());
    const Tick missing = tick - expected;
    lost_ += missing;
    const double a0 = record_.size() > 0 ? record_.acceleration_m_s2.back() : accel_m_s2;
    const double f0 = record_.size() > 0 ? record_.force_n.back() : force_n;
    for (Tick i = 1; i <= missing + 1; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(missing + 1);
      record_.acceleration_m_s2.push_back(a0 + share * (accel_m_s2 - a0));
      record_.force_n.push_back(f0 + share * (force_n - f0));
    }
  }
  active_ = tick < end - 1;
  return !active_;
}

Record PeggedRecord::record() const { return record_; }

Shell::Shell(runtime::Service& service)
    : service_(service),
      config_(service.config<Config>()),
      model_(service.bus().publisher<stillhand_msgs::FeedthroughModel>(topics::kFeedthroughModel)) {
  service.on_trial([this](const Trial& trial, const auto&) {
    if (trial.phase == TrialPhase::kPegged) pegged_.begin(trial);
    service_.note_armed(trial.number);
  });
  service.bus().subscribe<stillhand_msgs::Sensed>(
      topics::kSensed, [this](const auto& message, const auto&) { on_sensed(message); });
}

void Shell::on_sensed(const stillhand_msgs::Sensed& sensed) {
  service_.note_tick(sensed.tick());
  newest_tick_.store(sensed.tick(), std::memory_order_relaxed);
  if (!pegged_.take(sensed.tick(), sensed.accel_y_m_s2(), sensed.force_n())) return;
  {
    const std::lock_guard lock(mutex_);
    job_ = Job{pegged_.record(), pegged_.lost(), pegged_.trial()};
  }
  wake_.notify_all();
}

void Shell::run() {
  std::jthread fitting([this](const std::stop_token& stop) { fit_jobs(stop); });
  service_.run();
}

void Shell::fit_jobs(const std::stop_token& stop) {
  runtime::become_background();
  for (;;) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [this] { return job_.has_value(); })) return;
      job = std::move(*job_);
      job_.reset();
    }
    auto message = fit(job);
    message.from_tick(newest_tick_.load(std::memory_order_relaxed) + kModelNotice_ticks);
    model_.write(message);
  }
}

stillhand_msgs::FeedthroughModel Shell::fit(const Job& job) {
  const runtime::OrdinaryWhile ordinary;
  const std::int32_t number = models_++;
  const auto trial = static_cast<std::int32_t>(job.trial);
  if (static_cast<double>(job.lost) > kMaxLostShare * static_cast<double>(job.record.size())) {
    return failure_to_idl(std::to_string(job.lost) + " ticks of the pegged trial were lost", number,
                          trial);
  }
  try {
    return to_idl(identify(job.record, config_), number, trial);
  } catch (const ConfigError& error) {
    return failure_to_idl(error.what(), number, trial);
  }
}

}  // namespace stillhand::identification
