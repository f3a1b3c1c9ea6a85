// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/study/mitigations/campaign.hpp"

namespace stillhand::study {

/// A person on whom parameters are chosen.
struct Tutor {
  population::Subject subject;
  PersonModels models;
};

/// Seeds of one person of a seed: the same for every mitigation.
std::uint64_t person_seed(std::uint64_t seed, std::int64_t index);

/// The scene of a person in a cell; the motion is still missing.
TrialScene scene_of(const CampaignOptions& options, const population::Subject& subject,
                    std::uint64_t seed, TrialTask task, TrialMotion motion);

/// Chooses every parameter that the wanted mitigations need on these people, METHOD Eq. SU-18: by
/// trials for the filters, the damping and the steps of LMS (least mean over people and motions of
/// RMS error over that without a mitigation, while tracking), by Eqs. MI-7 and MI-8 for the rest.
Chosen choose(const CampaignOptions& options, const std::vector<Tutor>& tutors, std::uint64_t seed,
              unsigned threads, const OnCampaign& on_stage);

}  // namespace stillhand::study
