// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/write.hpp"

#include <array>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace stillhand::planted {
namespace {

using Json = nlohmann::ordered_json;

void save(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error(file.string() + ": can't be written");
}

void append(std::string& text, double value) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value + 0.0,
                                 std::chars_format::general, 9);
  text.append(buffer.data(), end.ptr);
}

Json spring(const Spring& spring) {
  return {{"stiffness_n_m", spring.stiffness_n_m}, {"damping_n_s_m", spring.damping_n_s_m}};
}

Json body(const Truth& truth) {
  return {{"torso_kg", truth.body.torso_kg},    {"arm_kg", truth.body.arm_kg},
          {"seat", spring(truth.body.seat)},    {"shoulder", spring(truth.body.shoulder)},
          {"grip", spring(truth.body.grip)},    {"dc_n_per_m_s2", truth.figures.dc_n_per_m_s2},
          {"notch_hz", truth.figures.notch_hz}, {"peak_hz", truth.figures.peak_hz}};
}

Json excitation(const Excitation& ride) {
  Json out{{"type", ride.multisine ? "multisine" : "noise"},
           {"low_hz", ride.low_hz},
           {"high_hz", ride.high_hz},
           {"rms_m_s2", ride.rms_m_s2},
           {"starts_at_rest", ride.starts_at_rest}};
  if (ride.multisine) {
    out["period_s"] = ride.period_s;
    out["lines_hz"] = ride.lines_hz;
  }
  return out;
}

Json effect(const PlantedEffect& planted) {
  Json parameters = Json::object();
  for (const Parameter& parameter : planted.parameters) {
    parameters[parameter.name] = {{"value", parameter.value}, {"unit", parameter.unit}};
  }
  return {{"kind", name_of(planted.kind)},
          {"variant", planted.variant},
          {"channels", planted.channels},
          {"also_right", planted.also},
          {"strength", planted.strength},
          {"wanted_strength", planted.wanted_strength},
          {"marginal_strength", planted.marginal},
          {"left_by_order_4", planted.left_by_order_4},
          {"evidence", planted.evidence},
          {"overlap", planted.overlap},
          {"parameters", parameters}};
}

}  // namespace

void write_csv(const std::filesystem::path& file, const Recording& recording) {
  std::string text = "t [s]";
  for (std::size_t i = 0; i < recording.names.size(); ++i) {
    text += "," + recording.names[i] + " [" + recording.units[i] + "]";
  }
  text += '\n';
  for (std::size_t row = 0; row < recording.time_s.size(); ++row) {
    append(text, recording.time_s[row]);
    for (const Series& column : recording.columns) {
      text += ',';
      append(text, column[row]);
    }
    text += '\n';
  }
  save(file, text);
}

void write_truth(const std::filesystem::path& file, const Truth& truth) {
  Json out{{"seed", truth.seed}, {"kinds", Json::array()}, {"effects", Json::array()}};
  for (const PlantedEffect& planted : truth.effects) {
    out["kinds"].push_back(name_of(planted.kind));
    out["effects"].push_back(effect(planted));
  }
  out["strength"] = truth.strength;
  out["irreducible"] = truth.irreducible;
  out["left_by_order_4"] = truth.left_by_order_4;
  out["evidence"] = truth.evidence;
  out["force_rms_n"] = truth.force_rms_n;
  out["noise_rms_n"] = truth.noise_rms_n;
  out["snr_db"] = truth.snr_db;
  out["noise"] = truth.noise;
  out["losses"] = truth.losses;
  out["length_s"] = truth.length_s;
  out["rate_hz"] = truth.rate_hz;
  out["excitation"] = excitation(truth.excitation);
  out["body"] = body(truth);
  save(file, out.dump(2) + "\n");
}

}  // namespace stillhand::planted
