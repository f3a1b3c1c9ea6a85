// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/body.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::rig {
namespace {

/// Below this distance and speed the peg counts as seated.  The step to exactly 0 changes the grip
/// force by less than 5 mN, a quarter of the load-cell noise.
constexpr double kSeated_m = 1e-6;
constexpr double kSeated_m_s = 1e-5;

const StickConfig& checked(const BodyConfig& body, const StickConfig& stick) {
  validate(body, "rig.body");
  validate(stick, "rig.stick");
  return stick;
}

void add_force(FreeChain::State& x, const FreeChain& chain, double force_n) noexcept {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += chain.from_force[i] * force_n;
}

/// Force of the grip on the hand and stick, + right.
double grip_force(const ChainParameters& p, double stretch_m, double stretch_m_s) noexcept {
  return p.grip_stiffness_n_m * stretch_m + p.grip_damping_n_s_m * stretch_m_s;
}

ChainPlace place(const HeldChain::State& x) noexcept {
  return {x[kTrunk], x[kTrunkRate], x[kArm], x[kArmRate], 0.0, 0.0};
}
ChainPlace place(const FreeChain::State& x) noexcept {
  return {x[kTrunk], x[kTrunkRate], x[kArm], x[kArmRate], x[kStick], x[kStickRate]};
}

/// Adds `share` of the forces; `on_stick` is G of the stick's mass, null with the stick held.
template <std::size_t N>
void add_forces(std::array<double, N>& x, const ForceColumns<N>& columns,
                const std::array<double, N>* on_stick, const ChainForces& f,
                double share) noexcept {
  for (std::size_t i = 0; i < N; ++i) {
    double sum = columns.trunk[i] * f.trunk_n + columns.arm[i] * f.arm_n;
    if (on_stick != nullptr) sum += (*on_stick)[i] * (f.hand_n + f.stick_n);
    x[i] += share * sum;
  }
}

/// Eq. RG-13: adds the effect's forces over the tick to `ahead`, as the mean of both ends.
template <std::size_t N>
void apply(EffectOnChain& effect, const std::array<double, N>& from, std::array<double, N>& ahead,
           const ForceColumns<N>& columns, const std::array<double, N>* on_stick,
           const ChainParameters& p, double mean_acceleration_m_s2) noexcept {
  if (!effect.acts()) return;
  const ChainForces first = effect.forces(place(from), p);
  effect.age();
  add_forces(ahead, columns, on_stick, first, 1.0);
  effect.move(place(from), place(ahead), mean_acceleration_m_s2);
  const ChainForces last = effect.forces(place(ahead), p);
  add_forces(ahead, columns, on_stick, first, -0.5);
  add_forces(ahead, columns, on_stick, last, 0.5);
}

/// Eq. RG-29: the reflex pulls the arm towards the trunk, and the trunk towards the arm.
template <std::size_t N>
void apply(Reflex& reflex, const std::array<double, N>& from, std::array<double, N>& ahead,
           const ForceColumns<N>& columns, bool idle) noexcept {
  if (!reflex.acts()) return;
  const double pull_n =
      reflex.step(from[kArm] - from[kTrunk], from[kArmRate] - from[kTrunkRate], idle);
  add_forces<N>(ahead, columns, nullptr, {.trunk_n = pull_n, .arm_n = -pull_n}, 1.0);
}

bool changes_stiffness(const NeuromuscularConfig& config) {
  return config.wander > 0.0 || config.stiffening_by_vibration_s2_m != 0.0 ||
         config.stiffening_by_motor_n > 0.0 || config.change != 0.0;
}

/// Shoulder and grip; their damping ratios stay.
ChainParameters stiffened(ChainParameters p, double factor) {
  p.shoulder_stiffness_n_m *= factor;
  p.grip_stiffness_n_m *= factor;
  p.shoulder_damping_n_s_m *= std::sqrt(factor);
  p.grip_damping_n_s_m *= std::sqrt(factor);
  return p;
}

}  // namespace

std::vector<Body::Muscles> Body::muscles(const BodyConfig& body, const StickConfig& stick,
                                         bool relaxed, double period_s, bool pushed) {
  const ChainParameters at_rest = chain_parameters(body, stick, relaxed);
  const bool varies = changes_stiffness(body.neuromuscular);
  std::vector<Muscles> levels;
  for (int level = varies ? StiffnessLevels::kLowest : 0;
       level <= (varies ? StiffnessLevels::kHighest : 0); ++level) {
    const ChainParameters p = stiffened(at_rest, std::exp(StiffnessLevels::kStep * level));
    Muscles muscles{p, free_chain(p, period_s), held_chain(p, period_s), {}, {}};
    if (pushed) {
      muscles.free_forces = free_force_columns(p, period_s);
      muscles.held_forces = held_force_columns(p, period_s);
    }
    levels.push_back(muscles);
  }
  return levels;
}

Body::Body(const BodyConfig& body, const StickConfig& stick, double period_s,
           const ChainEffect& effect)
    : stick_(checked(body, stick)),
      period_s_(period_s),
      stop_m_(stick.stop_angle_rad * stick.lever_m),
      seating_keep_(std::exp(-period_s / stick.peg_seat_time_s)),
      friction_n_(stick.coulomb_friction_n + effect.friction_n),
      extra_{EffectOnChain(effect, period_s), Reflex(body.neuromuscular, period_s)},
      copy_extra_(extra_),
      relaxed_(muscles(body, stick, true, period_s, extra_.acts())),
      tense_(muscles(body, stick, false, period_s, extra_.acts())) {}

const Body::Muscles& Body::muscles_now() const noexcept {
  const auto& levels = pegged_ ? relaxed_ : tense_;
  if (levels.size() == 1) return levels.front();
  const int level = std::clamp(level_, StiffnessLevels::kLowest, StiffnessLevels::kHighest);
  return levels[static_cast<std::size_t>(level - StiffnessLevels::kLowest)];
}

double Body::seating_velocity() const noexcept {
  const double tau_s = stick_.peg_seat_time_s;
  const double sum_m_s = x_[kStickRate] + x_[kStick] / tau_s;
  return (x_[kStickRate] - sum_m_s * period_s_ / tau_s) * seating_keep_;
}

double Body::stop_force(const FreeChain::State& ahead, const FreeChain& chain) const noexcept {
  const double side = ahead[kStick] < 0.0 ? -1.0 : 1.0;
  const double depth_m = side * ahead[kStick] - stop_m_;
  if (depth_m <= 0.0) return 0.0;
  const double k = stick_.stop_stiffness_n_m;
  const double c = stick_.stop_damping_n_s_m;
  // Implicit: the force depends on depth and speed at the end of the tick.
  const double push_n = (k * depth_m + c * side * ahead[kStickRate]) /
                        (1.0 + k * chain.from_force[kStick] + c * chain.from_force[kStickRate]);
  return -side * std::max(0.0, push_n);
}

void Body::end_at_steel() noexcept {
  const double steel_m = stop_m_ + stick_.stop_travel_m;
  if (std::abs(x_[kStick]) <= steel_m) return;
  x_[kStick] = std::copysign(steel_m, x_[kStick]);
  if (x_[kStick] * x_[kStickRate] > 0.0) x_[kStickRate] = 0.0;
}

double Body::move(const Input& input, const Muscles& chain, Flags& flags) noexcept {
  const double applied_n = input.motor_force_n + input.volitional_force_n + input.shaken_n;
  auto ahead = chain.free.step(x_, last_acceleration_m_s2_, input.acceleration_m_s2, applied_n);
  apply(extra_.effect, x_, ahead, chain.free_forces, &chain.free.from_force, chain.parameters,
        0.5 * (last_acceleration_m_s2_ + input.acceleration_m_s2));
  apply(extra_.reflex, x_, ahead, chain.free_forces, input.pegged);

  const double stop_n = stop_force(ahead, chain.free);
  if (stop_n != 0.0) {
    flags |= kAtStop;
    add_force(ahead, chain.free, stop_n);
  }
  // The force that ends the tick at the wanted speed.  Friction aims at rest and is bounded by F_c;
  // the peg aims at the path to the centre and is not bounded.
  double brake_n = 0.0;
  if (input.pegged) {
    brake_n = (seating_velocity() - ahead[kStickRate]) / chain.free.from_force[kStickRate];
  } else {
    brake_n = std::clamp(-ahead[kStickRate] / chain.free.from_force[kStickRate], -friction_n_,
                         friction_n_);
  }
  add_force(ahead, chain.free, brake_n);
  x_ = ahead;
  end_at_steel();

  const auto& p = chain.parameters;
  const ChainForces effect = extra_.effect.forces(place(x_), p);
  const double below_n = input.motor_force_n + stop_n + brake_n -
                         p.viscous_damping_n_s_m * x_[kStickRate] -
                         p.centring_stiffness_n_m * x_[kStick] + effect.stick_n;
  const double above_n = grip_force(p, x_[kArm] - x_[kStick], x_[kArmRate] - x_[kStickRate]) +
                         input.volitional_force_n - p.cell_mass_kg * input.acceleration_m_s2 +
                         effect.hand_n + input.shaken_n;
  const double above_share = p.cell_mass_kg / p.stick_mass_kg;
  return (1.0 - above_share) * above_n - above_share * below_n;
}

HeldChain::State Body::held_ahead(const HeldChain::State& from, const Input& input,
                                  const Muscles& chain, Extra& extra) noexcept {
  auto ahead = chain.held.step(from, last_acceleration_m_s2_, input.acceleration_m_s2, 0.0);
  apply<4>(extra.effect, from, ahead, chain.held_forces, nullptr, chain.parameters,
           0.5 * (last_acceleration_m_s2_ + input.acceleration_m_s2));
  apply(extra.reflex, from, ahead, chain.held_forces, input.pegged);
  return ahead;
}

double Body::held_force(const HeldChain::State& x, const Input& input, const ChainParameters& p,
                        const EffectOnChain& effect) {
  return grip_force(p, x[kArm], x[kArmRate]) - p.cell_mass_kg * input.acceleration_m_s2 +
         effect.forces(place(x), p).hand_n + input.shaken_n;
}

void Body::stay(const Input& input, const Muscles& chain) noexcept {
  const HeldChain::State ahead =
      held_ahead({x_[kTrunk], x_[kTrunkRate], x_[kArm], x_[kArmRate]}, input, chain, extra_);
  x_ = {ahead[kTrunk], ahead[kTrunkRate], ahead[kArm], ahead[kArmRate], 0.0, 0.0};
}

Body::Output Body::step(const Input& input) noexcept {
  Flags flags = kGood;
  pegged_ = input.pegged;
  level_ = input.stiffness_level;
  const Muscles& chain = muscles_now();
  const auto& p = chain.parameters;
  seated_ =
      input.pegged &&
      (seated_ || (std::abs(x_[kStick]) < kSeated_m && std::abs(x_[kStickRate]) < kSeated_m_s));

  copy_ = held_ahead(copy_, input, chain, copy_extra_);
  const double held_n = held_force(copy_, input, p, copy_extra_.effect);
  double hand_n = 0.0;
  if (seated_) {
    stay(input, chain);
    hand_n =
        held_force({x_[kTrunk], x_[kTrunkRate], x_[kArm], x_[kArmRate]}, input, p, extra_.effect) +
        input.volitional_force_n;
  } else {
    hand_n = move(input, chain, flags);
  }
  last_acceleration_m_s2_ = input.acceleration_m_s2;
  return {.theta_rad = x_[kStick] / stick_.lever_m,
          .omega_rad_s = x_[kStickRate] / stick_.lever_m,
          .feedthrough_force_n = held_n,
          .hand_force_n = hand_n,
          .flags = flags};
}

double Body::energy_j() const noexcept {
  const auto& p = muscles_now().parameters;
  const auto half_square = [](double factor, double x) { return 0.5 * factor * x * x; };
  return half_square(p.trunk_mass_kg, x_[kTrunkRate]) + half_square(p.arm_mass_kg, x_[kArmRate]) +
         half_square(p.stick_mass_kg, x_[kStickRate]) +
         half_square(p.seat_stiffness_n_m, x_[kTrunk]) +
         half_square(p.shoulder_stiffness_n_m, x_[kArm] - x_[kTrunk]) +
         half_square(p.arm_rest_stiffness_n_m, x_[kArm]) +
         half_square(p.grip_stiffness_n_m, x_[kArm] - x_[kStick]) +
         half_square(p.centring_stiffness_n_m, x_[kStick]);
}

}  // namespace stillhand::rig
