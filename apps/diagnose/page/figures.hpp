// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/diagnose/page/evidence.hpp"
#include "apps/libraries/report/plot/figure.hpp"

namespace stillhand::diagnose {

/// Most effects that get a figure of their own.
inline constexpr std::size_t kMostEffectFigures = 3;

/// An excerpt (report::excerpt_length): measured, baseline, with the effects; below, what both
/// leave.  Where the effects take most away; without effects the middle of the record.
report::Figure figure_prediction(const Evidence& evidence);
/// Root mean square of what is left, block by block.
report::Figure figure_over_time(const Evidence& evidence);
/// Power spectral densities of the output and of what is left (Welch), and the noise floor.
report::Figure figure_spectra(const Evidence& evidence);
/// With the bounds of white noise.
report::Figure figure_autocorrelation(const Evidence& evidence);
/// Coherence of the residual with every channel; only where it was computed.
report::Figure figure_coherence(const Evidence& evidence);
/// Output, residual and noise at excited, odd and even lines; only where the excitation is
/// periodic.
report::Figure figure_lines(const Evidence& evidence);
/// The residual without one effect of the final model against what explains it, and against what
/// the effect predicts.  @param which  index in found.effects
report::Figure figure_effect(const Evidence& evidence, std::size_t which);

/// All of them.
std::vector<report::Figure> diagnosis_figures(const Evidence& evidence);

/// Names of all figures that there can be.
std::vector<std::string> figure_names();

/// Left panel of figure_effect(), and what it shows in words.
struct Explanation {
  report::Panel panel;
  std::string text;
};

/// The law itself, with bands of 95 %; none where the left panel shows it already.
struct Law {
  std::vector<report::Panel> panels;
  std::string text;         ///< a sentence; empty: no panel
  bool takes_left = false;  ///< it shows what the left panel would, and takes its place
};

/// By what the effect is: magnitude and phase of a path, the map, the force over a channel, or the
/// loop of an element with memory.
Law law_of(const Evidence& evidence, std::size_t which, const EffectTrace& trace);

/// By where the effect acts: lag over time, gain, a frequency response, or the residual against the
/// channel, product, phase or prediction of which the effect is most nearly a function.
Explanation explanation_of(const Evidence& evidence, std::size_t which, const EffectTrace& trace);

/// Colours of the page.
inline constexpr report::Colour kBefore = report::Colour::kWarning;
inline constexpr report::Colour kAfter = report::Colour::kAccent;

}  // namespace stillhand::diagnose
