// SPDX-License-Identifier: Apache-2.0
// What sits in a spring of the body, or is a further mass on it.
#include <array>
#include <cmath>
#include <numbers>

#include "tests/planted/effect.hpp"

namespace stillhand::planted {
namespace {

struct Site {
  const char* name;
  Spring Body::* spring;
  double rms_m;  ///< of its deflection in the untouched recording
};

Site draw_site(const Reference& reference, Draw& draw) {
  // The grip is the stiff end of the chain and changes the force least: seat and shoulder are
  // likelier.
  const double pick = draw.unit();
  if (pick < 0.4) return {"seat", &Body::seat, reference.seat_rms_m};
  if (pick < 0.75) return {"shoulder", &Body::shoulder, reference.shoulder_rms_m};
  return {"grip", &Body::grip, reference.grip_rms_m};
}

double between(double size, double least, double most) {
  return least * std::pow(most / least, size);
}

Effect stiffness(const Reference& reference, Draw& draw) {
  Effect out;
  const Site site = draw_site(reference, draw);
  const bool hardening = draw.chance(0.5);
  out.variant = std::string(site.name) + (hardening ? " spring hardens" : " spring softens");
  const auto scale_m = [site](double size) { return site.rms_m * between(size, 30.0, 0.15); };
  out.plant = [site, hardening, scale_m](double size, Plant& plant) {
    plant.body_altered = true;
    SpringLaw& law = (plant.body.*site.spring).law;
    (hardening ? law.hardening_m : law.softening_m) = scale_m(size);
  };
  out.parameters = [scale_m, site](double size) -> std::vector<Parameter> {
    return {{"scale", scale_m(size), "m"}, {"deflection_rms", site.rms_m, "m"}};
  };
  return out;
}

Effect asymmetry(const Reference& reference, Draw& draw) {
  Effect out;
  const double sign = draw.sign();
  const auto skew = [sign](double size) { return sign * 0.9 * size; };
  out.parameters = [skew](double size) -> std::vector<Parameter> {
    return {{"skew", skew(size), "-"}};
  };
  if (draw.chance(0.3)) {
    out.variant = "load cell, other gain for push and pull";
    out.plant = [skew](double size, Plant& plant) {
      plant.sensitivity.push_back([by = skew(size)](const Scene&, Series& f) {
        for (double& value : f) value *= 1.0 + (value > 0.0 ? by : -by);
      });
    };
    return out;
  }
  const Site site = draw_site(reference, draw);
  const bool smooth = draw.chance(0.5);
  out.variant =
      std::string(site.name) + (smooth ? " spring, even term" : " spring, stiffer on one side");
  out.plant = [site, smooth, skew](double size, Plant& plant) {
    plant.body_altered = true;
    SpringLaw& law = (plant.body.*site.spring).law;
    (smooth ? law.smooth_skew : law.skew) = skew(size);
    law.skew_scale_m = site.rms_m;
  };
  return out;
}

Effect hysteresis(const Reference& reference, Draw& draw) {
  Effect out;
  const Site site = draw_site(reference, draw);
  const double yield_m = site.rms_m * draw.uniform(0.2, 0.7);
  const double sharpness = draw.chance(0.5) ? 1.0 : 2.0;
  out.variant = std::string(site.name) + " spring, Bouc-Wen";
  const auto share = [](double size) { return 0.98 * size; };
  out.plant = [=](double size, Plant& plant) {
    plant.body_altered = true;
    SpringLaw& law = (plant.body.*site.spring).law;
    law.hysteretic = share(size);
    law.yield_m = yield_m;
    law.sharpness = sharpness;
  };
  out.parameters = [=](double size) -> std::vector<Parameter> {
    return {{"share", share(size), "-"},
            {"yield", yield_m, "m"},
            {"deflection_rms", site.rms_m, "m"},
            {"exponent", sharpness, "-"}};
  };
  return out;
}

Effect cell_play(const Reference& reference, Draw& draw) {
  Effect out;
  const double half_n = reference.force_rms_n * draw.uniform(0.2, 0.8);
  out.variant = "load cell follows with play";
  out.plant = [=](double size, Plant& plant) {
    plant.reading.push_back([=](const Scene&, Series& f) {
      Series late = f;
      play(late, half_n);
      for (std::size_t i = 0; i < f.size(); ++i) f[i] += size * (late[i] - f[i]);
    });
  };
  out.parameters = [=](double size) -> std::vector<Parameter> {
    return {{"share", size, "-"}, {"half_width", half_n, "N"}};
  };
  return out;
}

Effect grip_gap(const Reference& reference) {
  Effect out;
  out.variant = "clearance in the grip";
  const auto gap_m = [rms_m = reference.grip_rms_m](double size) {
    return rms_m * between(size, 0.005, 5.0);
  };
  out.plant = [gap_m](double size, Plant& plant) {
    plant.body_altered = true;
    plant.body.grip.law.gap_m = gap_m(size);
  };
  out.parameters = [gap_m](double size) -> std::vector<Parameter> {
    return {{"half_width", gap_m(size), "m"}};
  };
  return out;
}

}  // namespace

Effect draw_spring_effect(Kind kind, const Reference& reference, Draw& draw) {
  Effect out = kind == Kind::kNonlinearStiffness ? stiffness(reference, draw)
               : kind == Kind::kAsymmetry        ? asymmetry(reference, draw)
               : kind == Kind::kHysteresis
                   ? (draw.chance(0.25) ? cell_play(reference, draw) : hysteresis(reference, draw))
                   : grip_gap(reference);
  out.kind = kind;
  return out;
}

Effect draw_resonance(const Scene& scene, const Body& body, Draw& draw) {
  Effect out;
  out.kind = Kind::kResonance;
  const std::size_t place = draw.index(3);
  const ModeSite site = std::array{ModeSite::kTorso, ModeSite::kArm, ModeSite::kStick}[place];
  const double largest_kg = std::array{0.5 * body.torso_kg, body.arm_kg, 3.0}[place];
  // Inside the excited band, where a recording can show it.
  const double mode_hz =
      draw.uniform(1.3 * scene.excitation.low_hz, 0.9 * scene.excitation.high_hz);
  const double damping = draw.uniform(0.02, 0.07);
  out.variant = std::string("further mass on the ") + std::array{"torso", "arm", "stick"}[place];
  const auto mass_kg = [largest_kg](double size) { return between(size, 0.001, 1.0) * largest_kg; };
  out.plant = [=](double size, Plant& plant) {
    plant.body_altered = true;
    plant.body.mode_site = site;
    plant.body.mode_kg = mass_kg(size);
    plant.body.mode_rad_s = 2.0 * std::numbers::pi * mode_hz;
    plant.body.mode_damping = damping;
  };
  out.parameters = [=](double size) -> std::vector<Parameter> {
    return {{"mass", mass_kg(size), "kg"}, {"frequency", mode_hz, "Hz"}, {"damping", damping, "-"}};
  };
  return out;
}

}  // namespace stillhand::planted
