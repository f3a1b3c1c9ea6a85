// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/diagnose/page/lateness.hpp"
#include "apps/libraries/report/page.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/record/measurement.hpp"

namespace stillhand::diagnose {

struct Evidence;

/// The page: verdict in words, errors, figures, effects and their numbers, the candidates, the
/// questions, the residual.
/// @param recordings  files that were diagnosed together, at least one
/// @param drawings    of diagnosis_figures()
/// @param splits      of their trials with cancellation
report::Page diagnosis_page(const Evidence& evidence, const std::vector<std::string>& recordings,
                            const std::vector<report::Drawing>& drawings,
                            const std::vector<RecordedSplit>& splits = {});

/// Runs the models again on the samples that the engine used, draws, and publishes the folder:
/// report.html, and the figure_files() of every figure.
/// @param measurement  the measurement that was diagnosed, as read  @param recordings  its files
/// @throws ConfigError without gnuplot, std::runtime_error when a file cannot be written
void write_report(const diagnosis::Diagnosis& found, const diagnosis::Measurement& measurement,
                  const std::vector<std::string>& recordings, report::StagedFolder& folder,
                  const std::vector<RecordedSplit>& splits = {});

}  // namespace stillhand::diagnose
