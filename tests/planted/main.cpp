// SPDX-License-Identifier: Apache-2.0
// planted_recordings: recordings with known effects, and their sealed labels.
#include <cstdio>
#include <exception>

#include "services/system/command_line/command_line.hpp"
#include "tests/planted/series.hpp"
#include "tests/planted/write.hpp"

namespace {

using namespace stillhand::planted;

void write_all(const std::string& folder, const SeriesPlan& plan, std::size_t count, bool list) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [seed, spec] = plan.at(i);
    const Draft draft = draw(seed, spec);
    char stem[32];
    std::snprintf(stem, sizeof stem, "rec_%04zu", i + 1);
    write_csv(std::filesystem::path(folder) / (std::string(stem) + ".csv"), draft.recording);
    if (draft.again) {
      write_csv(std::filesystem::path(folder) / (std::string(stem) + ".again.csv"), *draft.again);
    }
    write_truth(std::filesystem::path(folder) / (std::string(stem) + ".truth.json"), draft.truth);
    if (!list) continue;
    std::printf("%s  snr %2.0f dB  irreducible %.4f  order 4 leaves %.4f  evidence %8.1f  %s%s%s",
                stem, spec.snr_db, draft.truth.irreducible, draft.truth.left_by_order_4,
                draft.truth.evidence, draft.truth.noise.c_str(),
                draft.truth.losses.empty() ? "" : ", ", draft.truth.losses.c_str());
    for (const PlantedEffect& effect : draft.truth.effects) {
      std::printf(" | %s (%s) %.3f", std::string(name_of(effect.kind)).c_str(),
                  effect.variant.c_str(), effect.strength);
    }
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  stillhand::command_line::Program app{
      "Writes recordings with planted effects and their sealed labels"};
  std::string folder;
  std::size_t count = 1;
  SeriesPlan plan;
  bool list = false;
  app.add_option("--out", folder, "folder for rec_0001.csv, rec_0001.truth.json, ...").required();
  app.add_option("--count", count, "how many");
  app.add_option("--seed", plan.seed, "of the whole series");
  app.add_option("--kind", plan.kinds, "kinds to take in turn, or none; default: all and none")
      .delimiter(',');
  app.add_option("--strength", plan.strengths, "to take in turn").delimiter(',');
  app.add_option("--snr", plan.snrs_db, "to take in turn [dB]").delimiter(',');
  app.add_option("--noise", plan.noise,
                 "white, low_pass, pink, heavy_tailed, uneven; default: white, for none drawn");
  app.add_flag("--gaps", plan.gaps, "with gaps and single rows lost");
  app.add_option("--together", plan.together, "kinds planted at once");
  const auto pairs = [&] { plan.together = 2; };
  app.add_flag_callback("--pairs", pairs, "the same as --together 2");
  app.add_option("--least-evidence", plan.least_evidence,
                 "draw an effect again until it shows this clearly: samples (left / noise)^2");
  app.add_option("--length", plan.length_s, "of a recording [s]");
  app.add_option("--rate", plan.rate_hz, "of a recording [Hz]");
  app.add_flag("--twice", plan.twice,
               "also rec_0001.again.csv: the same body and effect on another ride, other noise");
  app.add_option("--again-length", plan.again_length_s, "of that [s]; default: as --length");
  app.add_option("--again-rate", plan.again_rate_hz, "of that [Hz]; default: as --rate");
  app.add_flag("--list", list, "say what was planted");
  if (const auto status = app.parse(argc, argv)) return *status;
  try {
    plan.check();
    write_all(folder, plan, count, list);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "planted_recordings: %s\n", error.what());
    return 2;
  }
  return 0;
}
