// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/device_plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/parts_note.hpp"
#include "services/devices/device_rig/plant_limits.hpp"
#include "services/files/settings/placed_error.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::device_rig {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
// No encoder counts so far: sensing takes it as a fault of the counter and holds the last angle.
constexpr std::int64_t kNoCounts = std::int64_t{1} << 40;
constexpr double kMostTurns = 1e6;
// No device gives these.
constexpr double kUntouched_v = -1e300;
constexpr std::int64_t kUntouched_counts = std::numeric_limits<std::int64_t>::min();

// An amplifier that is at its end, or a wire that is off.
bool ends(double share) noexcept { return !(share > 0.002 && share < 0.998); }

bool is_young(std::uint64_t count, std::int64_t at_ns, std::int64_t now_ns,
              std::int64_t most_ticks) noexcept {
  return count > 0 && now_ns - at_ns <= most_ticks * 1'000'000;
}

// A drive and a platform judge their own; every other part is unknown until something was taken.
bool missing(Parts::Source source, double value) noexcept {
  using Source = Parts::Source;
  const bool other =
      source == Source::kSimulated || source == Source::kDrive || source == Source::kPlatform;
  return !other && std::isnan(value);
}

// A platform that lags by more is no platform of a person's.
std::size_t lag_ticks(double lag_s) {
  constexpr double kMost_ticks = 500.0;
  return static_cast<std::size_t>(std::lround(std::clamp(1e3 * lag_s, 0.0, kMost_ticks)));
}

}  // namespace

DevicePlant::DevicePlant(const rig::RigConfig& rig, const DevicesConfig& devices,
                         double platform_lag_s)
    : rig_config_(rig),
      devices_(devices),
      parts_(parts_of(devices)),
      simulated_(rig),
      motor_(barrier(rig.motor), rig.stick.lever_m),
      seat_drive_(platform_limits(rig.platform, devices.platform, parts_.platform)),
      asked_(lag_ticks(platform_lag_s)),
      words_(std::string(kPartsNote) + in_words(devices.signals)) {
  if (parts_.needs_drive()) {
    drive_ = std::make_unique<DriveLink>(devices.drive, setting_limits(rig, devices));
  }
  if (parts_.needs_platform()) {
    platform_ = settings::placed("devices.platform", [&] {
      return std::make_unique<PlatformLink>(devices.platform, parts_.platform);
    });
  }
  if (parts_.acceleration == Parts::Source::kIio) {
    const AccelerometerConfig& config = devices.accelerometer;
    std::vector<std::string> channels{config.channel};
    if (!config.mount.empty()) {
      mount_.emplace("devices.accelerometer.mount", config.mount);
      channels = {"accel_x", "accel_y", "accel_z"};
    }
    accelerometer_ = settings::placed("devices.accelerometer", [&] {
      return std::make_unique<IioLink>(config, std::move(channels), 1.0);
    });
  }
  if (parts_.force == Parts::Source::kIio) {
    constexpr double kVoltPerMillivolt = 1e-3;
    load_cell_ = settings::placed("devices.load_cell", [&] {
      return std::make_unique<IioLink>(devices.load_cell, std::vector{devices.load_cell.channel},
                                       kVoltPerMillivolt);
    });
  }
  refuse_unserved();
}

rig::RawSample untouched() noexcept {
  return {kUntouched_v, kUntouched_v, kUntouched_v, kUntouched_v, kUntouched_counts, 0.0};
}

const char* unserved(const Parts& parts, const rig::RawSample& raw) noexcept {
  using Source = Parts::Source;
  const bool accelerated = raw.accel_x_v != kUntouched_v && raw.accel_y_v != kUntouched_v &&
                           raw.accel_z_v != kUntouched_v;
  if (parts.acceleration != Source::kSimulated && !accelerated) return "acceleration";
  if (parts.force != Source::kSimulated && raw.load_cell_v == kUntouched_v) return "force";
  if (parts.angle != Source::kSimulated && raw.encoder_counts == kUntouched_counts) return "angle";
  return nullptr;
}

void DevicePlant::refuse_unserved() const {
  rig::RigOutput probe{};
  probe.raw = untouched();
  put_devices(probe);
  const char* const signal = unserved(parts_, probe.raw);
  if (signal == nullptr) return;
  throw ConfigError("devices.signals." + std::string(signal), "a part that publishes nothing",
                    "another one: DevicePlant::put_devices() lacks this one");
}

std::string DevicePlant::device_of(CalibratedSignal signal) const {
  const bool angle = signal == CalibratedSignal::kAngle;
  const bool force = signal == CalibratedSignal::kForce;
  switch (angle ? parts_.angle : force ? parts_.force : parts_.acceleration) {
    case Parts::Source::kSimulated:
      return {};
    case Parts::Source::kDrive: {
      const std::string drive = "drive, serial " + drive_->serial();
      if (angle) return drive + ", encoder, sign " + std::to_string(devices_.drive.angle_sign);
      return drive + ", AUX" +
             std::to_string(force ? devices_.drive.force_input : devices_.drive.acceleration_input);
    }
    case Parts::Source::kPlatform:
      return "platform at " + devices_.platform.address;
    case Parts::Source::kIio: {
      const IioConfig& config = force ? devices_.load_cell : devices_.accelerometer;
      const IioLink& link = force ? *load_cell_ : *accelerometer_;
      // Another mount is another calibration.
      const std::string input =
          !force && mount_ ? "mount " + devices_.accelerometer.mount : config.channel;
      return "IIO " + config.device + ", serial " + link.serial() + ", " + input + ", sign " +
             std::to_string(config.sign);
    }
  }
  return {};
}

std::string platform_device(const DevicesConfig& devices) {
  if (parts_of(devices).platform == Parts::Platform::kSimulated) return {};
  return devices.signals.platform + " at " + devices.platform.address + ", port " +
         std::to_string(devices.platform.port);
}

std::string DevicePlant::pushing_devices() const {
  if (parts_.motor != Parts::Motor::kDrive) return {};
  std::array<char, 96> own{};
  std::snprintf(own.data(), own.size(), ", torque sign %d, lever %.9g m",
                static_cast<int>(devices_.drive.torque_sign), rig_config_.stick.lever_m);
  std::string all = "drive, serial " + drive_->serial() + own.data();
  for (const CalibratedSignal signal : kCalibratedSignals) {
    const std::string device = device_of(signal);
    all += "; " + (device.empty() ? std::string("simulated") : device);
  }
  return all + "; " + (platform_ ? platform_device() : "simulated");
}

std::vector<std::string> DevicePlant::counts() {
  std::vector<std::string> lines;
  const auto count = [&](const char* name, const std::unique_ptr<IioLink>& link) {
    if (link) lines.push_back(name + (": " + device_rig::in_words(link->newest())));
  };
  count("accelerometer", accelerometer_);
  count("load_cell", load_cell_);
  return lines;
}

double DevicePlant::measured_force_n() const noexcept {
  if (!drive_ || !drive_fresh()) return kUnknown;
  return static_cast<double>(devices_.drive.torque_sign) * stick_.reply.torque_n_m /
         rig_config_.stick.lever_m;
}

bool DevicePlant::drive_fresh() const noexcept {
  return is_young(stick_.sequence, stick_.at_ns, now_ns_, devices_.drive.max_age_ticks);
}

bool DevicePlant::platform_fresh() const noexcept {
  return is_young(seat_.count, seat_.at_ns, now_ns_, devices_.platform.max_age_ticks);
}

void DevicePlant::take_drive() noexcept {
  if (!drive_) return;
  const DriveSample& newest = drive_->newest();
  if (newest.sequence > stick_.sequence && stick_.sequence > 0) {
    // METHOD Eq. DR-11; 2 ms: two stamps of a busy host differ from the drive's times by as much.
    const double elapsed_s = 1e-9 * static_cast<double>(newest.at_ns - stick_.at_ns) + 0.002;
    const double moved_rad =
        kTurn_rad * std::abs(newest.reply.position_rev - stick_.reply.position_rev);
    jumped_ = jumped_ || moved_rad > devices_.drive.max_rate_rad_s * elapsed_s;
  }
  stick_ = newest;
}

bool DevicePlant::at_rail() const noexcept {
  const auto at_end = [&](Parts::Source source, std::int64_t input) {
    return source == Parts::Source::kDrive &&
           ends(input == 1 ? stick_.reply.analog1 : stick_.reply.analog2);
  };
  return stick_.sequence > 0 && (at_end(parts_.force, devices_.drive.force_input) ||
                                 at_end(parts_.acceleration, devices_.drive.acceleration_input));
}

void DevicePlant::take_platform() noexcept {
  if (platform_) seat_ = platform_->newest();
}

double DevicePlant::iio_value(IioLink& link, const IioConfig& config) noexcept {
  const IioSample& newest = link.newest();
  const bool young = is_young(newest.count, newest.at_ns, now_ns_, config.max_age_ticks);
  return young ? static_cast<double>(config.sign) * newest.values[0] : kUnknown;
}

void DevicePlant::take_accelerometer() noexcept {
  accel_y_m_s2_ = iio_value(*accelerometer_, devices_.accelerometer);
  if (!mount_) return;
  const bool young = !std::isnan(accel_y_m_s2_);
  const auto turned = mount_->turned(accelerometer_->newest().values);
  accel_x_m_s2_ = young ? turned[0] : kUnknown;
  accel_y_m_s2_ = young ? turned[1] : kUnknown;
  accel_z_m_s2_ = young ? turned[2] : kUnknown;
}

void DevicePlant::take_iio() noexcept {
  if (accelerometer_) take_accelerometer();
  if (load_cell_) load_cell_v_ = iio_value(*load_cell_, devices_.load_cell);
  const bool unknown =
      missing(parts_.acceleration, accel_y_m_s2_) || missing(parts_.force, load_cell_v_);
  unknown_ticks_ = unknown ? unknown_ticks_ + 1 : 0;
}

void DevicePlant::wait() noexcept {
  constexpr std::int64_t kEach_ticks = 10;
  if (++tick_ % kEach_ticks != 0) return;
  now_ns_ = runtime::monotonic_ns();
  take_drive();
  take_platform();
  take_iio();
  if (drive_) drive_->demand(Order::kQuery, 0.0);
  if (!platform_) return;
  move_platform({.leave = MotionLeave::kHold}, true);
}

void DevicePlant::begin(const Trial& trial, Tick tick) noexcept {
  if (trial.number != trial_.number) side_.reset();
  trial_ = trial;
  tick_ = tick;
  now_ns_ = runtime::monotonic_ns();
  take_drive();
  take_platform();
  take_iio();
  rail_ticks_ = at_rail() ? rail_ticks_ + 1 : 0;
  judge();
}

rig::RigOutput DevicePlant::step(const rig::RigInput& input) noexcept {
  rig::RigOutput driven{};
  drive(input, driven);
  return sample(input);
}

rig::RigOutput DevicePlant::sample(const rig::RigInput& input) noexcept {
  rig::RigOutput output = simulated_.sample(input);
  if (!parts_.any_device()) return output;
  put_devices(output);
  // What only a simulation knows is unknown as soon as a part is real.
  output.truth.feedthrough_force_n = kUnknown;
  output.truth.volitional_force_n = kUnknown;
  output.truth.hand_force_n = kUnknown;
  if (parts_.motor != Parts::Motor::kSimulated) put_motor(output);
  watch_numbers(input, output);
  if (platform_) {
    const bool turn = tick_ % devices_.platform.period_ticks == 0;
    const auto asked = move_platform(input, turn);
    output.flags |= asked.flags;
    output.truth.platform_velocity_m_s = asked.set_point.velocity_m_s;
  }
  return output;
}

// Every signal of a device; the constructor looks at what this leaves untouched.
void DevicePlant::put_devices(rig::RigOutput& output) const noexcept {
  put_stick(output);
  put_platform(output);
  put_iio(output);
}

void DevicePlant::watch_numbers(const rig::RigInput& input, const rig::RigOutput& output) noexcept {
  // A platform that is simulated, or does not follow, moves no sensor.
  const bool follows = platform_ && seat_drive_.stage() == SeatStage::kFollowing;
  if (!follows || !input.command_valid) return;
  const double motion = input.command_acceleration_m_s2;
  if (parts_.acceleration != Parts::Source::kSimulated) {
    acceleration_.step(output.raw.accel_y_v, motion);
    side_.step(output.raw.accel_y_v, asked_.step(motion));
  }
  if (parts_.force != Parts::Source::kSimulated) force_.step(output.raw.load_cell_v, motion);
}

void DevicePlant::put_stick(rig::RigOutput& output) const noexcept {
  if (!drive_) return;
  const bool fresh = drive_fresh();
  const DriveReply& reply = stick_.reply;
  const auto volts = [&](std::int64_t input) {
    const double share = input == 1 ? reply.analog1 : reply.analog2;
    return fresh && !ends(share) ? devices_.drive.analogue_v * share : kUnknown;
  };
  if (!fresh) output.flags |= kInputStale;
  if (jumped_) output.flags |= kFault;
  if (parts_.force == Parts::Source::kDrive) {
    output.raw.load_cell_v = volts(devices_.drive.force_input);
  }
  if (parts_.acceleration == Parts::Source::kDrive) {
    output.raw.accel_x_v = output.raw.accel_z_v = 0.0;
    output.raw.accel_y_v = volts(devices_.drive.acceleration_input);
  }
  if (parts_.angle != Parts::Source::kDrive) return;
  const bool known = fresh && !jumped_ && std::abs(reply.position_rev) < kMostTurns;
  const auto sign = static_cast<double>(devices_.drive.angle_sign);
  output.raw.encoder_counts = known
                                  ? std::llround(sign * reply.position_rev *
                                                 static_cast<double>(devices_.drive.counts_per_rev))
                                  : kNoCounts;
  output.truth.theta_rad = known ? sign * kTurn_rad * reply.position_rev : kUnknown;
  output.truth.omega_rad_s = known ? sign * kTurn_rad * reply.velocity_rev_s : kUnknown;
}

void DevicePlant::put_motor(rig::RigOutput& output) const noexcept {
  output.truth.motor_force_n = force_n_;
  output.motor_flags = motor_flags_;
}

void DevicePlant::put_iio(rig::RigOutput& output) const noexcept {
  if (accelerometer_) {
    output.raw.accel_x_v = accel_x_m_s2_;
    output.raw.accel_y_v = accel_y_m_s2_;
    output.raw.accel_z_v = accel_z_m_s2_;
  }
  if (load_cell_) output.raw.load_cell_v = load_cell_v_;
  if (unknown_ticks_ > 0) output.flags |= kInputStale;
}

void DevicePlant::drive(const rig::RigInput& input, rig::RigOutput& output) noexcept {
  if (parts_.motor == Parts::Motor::kSimulated) simulated_.drive(input, output);
  if (drive_) drive_motor(input, output);
}

void DevicePlant::drive_motor(const rig::RigInput& input, rig::RigOutput& output) noexcept {
  const bool free_trial = trial_.phase == TrialPhase::kTracking && trial_.covers(tick_);
  const auto armed = arming_.step(
      {.fresh = drive_fresh(),
       .checked = stick_.checked,
       .jumped = jumped_,
       .mode = stick_.reply.mode,
       .fault = stick_.reply.fault,
       .wanted = parts_.motor == Parts::Motor::kDrive && input.motor_permitted && free_trial,
       .force_zero = force_n_ == 0.0,
       .trial = trial_.number});
  if (parts_.motor != Parts::Motor::kSimulated) {
    const auto driven = motor_.step({input.motor_valid, input.motor_age_ticks, input.motor_force_n,
                                     input.motor_permitted && armed.follows});
    force_n_ = armed.follows ? driven.force_n : 0.0;
    motor_flags_ = driven.flags;
    put_motor(output);
  }
  // A stop does not wait for the turn of an exchange.
  const bool turn = tick_ % devices_.drive.period_ticks == 0;
  if (turn || (armed.order == Order::kStop && order_ != Order::kStop)) {
    const double torque_n_m =
        static_cast<double>(devices_.drive.torque_sign) * force_n_ * rig_config_.stick.lever_m;
    drive_->demand(armed.order, torque_n_m);
  }
  order_ = armed.order;
}

bool DevicePlant::prepared() const noexcept {
  const bool stick =
      !drive_ || arming_.stage() == Stage::kChecked || arming_.stage() == Stage::kArmed;
  const bool seat = !platform_ || seat_drive_.engaged();
  return stick && seat && unknown_ticks_ == 0;
}

const char* DevicePlant::unknown_iio() noexcept {
  const auto late = [&](auto& link, std::int64_t most_ticks) {
    if (!link) return false;
    const auto& newest = link->newest();
    return is_young(newest.old, newest.old_at_ns, now_ns_, most_ticks);
  };
  if (missing(parts_.force, load_cell_v_)) {
    return late(load_cell_, devices_.load_cell.max_age_ticks)
               ? "the samples of the load cell come too late"
               : "the load cell is silent, or at its end";
  }
  return late(accelerometer_, devices_.accelerometer.max_age_ticks)
             ? "the samples of the accelerometer come too late"
             : "the accelerometer is silent, or at its end";
}

void DevicePlant::judge() noexcept {
  why_ = nullptr;
  if (platform_) judge_platform();
  constexpr Tick kRail_ticks = 20;
  if (unknown_ticks_ >= kRail_ticks) why_ = unknown_iio();
  if (acceleration_.repeats()) why_ = "the accelerometer repeats one number while the seat moves";
  if (side_.opposed()) why_ = "the accelerometer moves against the platform: its sign is wrong";
  if (force_.repeats()) why_ = "the load cell repeats one number while the seat moves";
  if (!drive_) return;
  if (rail_ticks_ >= kRail_ticks) why_ = "an analogue input of the drive stands at its end";
  if (!drive_fresh()) why_ = text_of(Reason::kSilent);
  if (jumped_) why_ = text_of(Reason::kEncoder);
  if (arming_.stage() != Stage::kFaulted || trial_.number != arming_.trial()) return;
  if (arming_.fault() != 0) {
    std::snprintf(text_.data(), text_.size(), "the drive reports fault %d", arming_.fault());
    why_ = text_.data();
  } else {
    why_ = text_of(arming_.reason());
  }
}

}  // namespace stillhand::device_rig
