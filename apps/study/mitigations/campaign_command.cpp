// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/campaign_command.hpp"

#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/study/mitigations/campaign_output.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::study {

int run_campaign_command(const StudyRecord& record, const CampaignArguments& words,
                         const std::filesystem::path& out) {
  CampaignOptions options;
  options.mitigations = mitigations_named(words.mitigations);
  if (words.subjects_given) options.subjects = record.options.subjects;
  if (words.trial_given) options.trial_s = record.options.protocol.trial_s;
  options.seed = record.options.seed;
  options.identify_s = record.options.protocol.identify_s;
  options.population = record.options.population;
  options.threads = record.options.threads;
  report::StagedFolder folder(out);
  report::require_gnuplot();
  runtime::Stop stop;
  report::ProgressLine progress;
  const Campaign campaign = run_campaign(options, [&](const std::string& stage, double share) {
    progress.show(stage, share);
    return !stop.requested();
  });
  progress.finish();
  write_campaign(campaign, record.command_line, folder);
  print_campaign(campaign);
  report::say_report(out);
  return 0;
}

}  // namespace stillhand::study
