// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/fitting/impulse_response.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/selection.hpp"

/// One round of the search: every form that is proposed, fitted and judged.
namespace stillhand::diagnosis {

/// Calls task(0) to task(count - 1), in any order or in parallel; returns when all are done.
using ForEach =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;
/// One after the other.
void in_order(std::size_t count, const std::function<void(std::size_t)>& task);

/// Which kinds a round tries: those with a law, or those that take any shape.
enum class Shapes { kNamed, kAny };

/// The model fitted in at most `iterations` steps, and its held-out error: by refitting, Eq. DG-12
/// by one linearisation otherwise.
Trial judged_trial(Model model, const Signals& signals, const Blocks& blocks, int iterations,
                   bool refitting);

/// The body that was fitted without the effects may be in a local minimum.  A body estimated again
/// from what the effects leave of the output replaces it where it is better.  The full order is
/// tried too: an effect may have hidden poles of a body whose order was reduced.
void start_afresh(Model& model, const Signals& signals, int order);

/// Of a record with more samples, every form is fitted to pieces first, kMostScreened samples in
/// all, and those that are near the best there to all samples.
inline constexpr std::size_t kMostScreened = 20'000;
/// The pieces; all samples of a record without more.
Signals screened_part(const Signals& signals);

/// What all rounds of a search have in common.
struct RoundSettings {
  const Blocks& blocks;
  const ImpulseResponse& impulse_response;  ///< of screened_part()
  int order;                                ///< of the body, before it was reduced
  const SearchOptions& options;
  const ForEach& for_each;
  bool rising_springs = false;  ///< true: a spring that turns round, Eq. DG-95, does not count
};

/// A round after the screening.
struct Screened {
  std::vector<Trial> trials;  ///< best first
  double current_rmse = 0.0;  ///< of screened_part(), held out, of the model without any of them
  std::size_t near = 0;       ///< so many are near enough to the best to be fitted to the end
  bool first_fitted = false;  ///< the first few are
};

/// Everything that is proposed, fitted jointly in a few steps; not fitted, with an infinite error,
/// where the screening shows that nothing is to be gained.
/// @param current_rmse  held out, of the model without any of them
/// @param known  by the same round without the noise model; see Screening
Screened screened_trials(const Model& current, double current_rmse, const Signals& signals,
                         const RoundSettings& settings, Shapes shapes,
                         std::vector<Proposal> known = {});
/// The first few fitted to the end on screened_part() and judged by the linearisation alone.
void fit_first(Screened& screened, const Signals& signals, const RoundSettings& settings);
/// Those near the best fitted to the end on all samples and judged by refitting.  Best first.
/// @param current_rmse  held out, of the model without any of them
std::vector<Trial> finished_trials(Screened screened, double current_rmse, const Signals& signals,
                                   const RoundSettings& settings);
/// A curve that the data draw in place of the law that acts inside the body, METHOD Eq. DG-90; or
/// the law of those that were tried that describes the curve, with the curve's linear parts.
/// @param law  the model's last effect
/// @param current_rmse  held out, of the model without any of them
/// @return nullopt where there is no law without memory inside the body, or the curve fails
std::optional<Trial> curve_in_place(const Trial& law, const std::vector<Trial>& tried,
                                    double current_rmse, const Signals& signals,
                                    const RoundSettings& settings);
/// The proposals that came with bodies of their own, as they were fitted.
std::vector<Proposal> with_own_bodies(const std::vector<Trial>& trials);

}  // namespace stillhand::diagnosis
