// SPDX-License-Identifier: Apache-2.0
#include "apps/study/mitigations/campaign_output.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "apps/libraries/report/plot/figure_table.hpp"
#include "apps/study/report/csv_cells.hpp"

namespace stillhand::study {
namespace {

std::string name_of(const CellKey& key) { return mitigation_name(key.mitigation); }
const char* model_of(const CellKey& key) {
  return kModelOfNames[static_cast<std::size_t>(key.model)];
}
const char* task_of(const CellKey& key) {
  return kTrialTaskNames[static_cast<std::size_t>(key.task)];
}
const char* motion_of(const CellKey& key) {
  return kTrialMotionNames[static_cast<std::size_t>(key.motion)];
}

}  // namespace

std::string mitigations_csv(const Campaign& campaign) {
  using csv::text;
  std::string out =
      "mitigation,model,task,motion,people,error [mm],restored,restored low,restored high,"
      "median restored,median low,median high,worst restored,worst person,harmed,harm,harm low,"
      "harm high,motor [N],effort [N]\n";
  for (const CellFigures& cell : campaign.cells) {
    const auto& mean = cell.restored_mean;
    const auto& median = cell.restored_median;
    const auto& worst = cell.worst_person;
    out += csv::row({name_of(cell.key),
                     model_of(cell.key),
                     task_of(cell.key),
                     motion_of(cell.key),
                     std::to_string(cell.people.size()),
                     text(cell.error_mm),
                     text(mean ? mean->ratio : NAN),
                     text(mean ? mean->low : NAN),
                     text(mean ? mean->high : NAN),
                     text(median ? median->median : NAN),
                     text(median ? median->low : NAN),
                     text(median ? median->high : NAN),
                     text(worst ? cell.restored[*worst] : NAN),
                     worst ? std::to_string(*worst + 1) : "",
                     std::to_string(cell.harmed),
                     text(cell.harm.share),
                     text(cell.harm.low),
                     text(cell.harm.high),
                     text(cell.motor_n),
                     text(cell.effort_n)});
  }
  return out;
}

std::string mitigation_people_csv(const Campaign& campaign) {
  using csv::text;
  std::string out =
      "mitigation,model,task,motion,person,error [mm],still [mm],restored,motor [N],effort [N],"
      "schedule weight\n";
  for (const CellFigures& cell : campaign.cells) {
    std::size_t task = 0;
    while (campaign.options.tasks[task] != cell.key.task) ++task;
    for (std::size_t i = 0; i < cell.people.size(); ++i) {
      const TrialFigures& one = cell.people[i];
      out += csv::row({name_of(cell.key), model_of(cell.key), task_of(cell.key),
                       motion_of(cell.key), std::to_string(i + 1), text(one.error_mm),
                       text(campaign.still_mm[task][i]), text(cell.restored[i]), text(one.motor_n),
                       text(one.effort_n), text(one.weight)});
    }
  }
  return out;
}

void write_campaign(const Campaign& campaign, const std::string& command_line,
                    report::StagedFolder& folder) {
  folder.write("mitigations.csv", mitigations_csv(campaign));
  folder.write("mitigation_people.csv", mitigation_people_csv(campaign));
  const auto drawings = report::render(campaign_figures(campaign), folder.path());
  campaign_page(campaign, command_line, drawings).write(folder.path() / "report.html");
  std::vector<std::string> own{"report.html", "mitigations.csv", "mitigation_people.csv"};
  for (const char* task : kTrialTaskNames) {
    for (std::string& name : report::figure_files(fmt::format("mitigations_{}", task))) {
      own.push_back(std::move(name));
    }
  }
  folder.publish(own);
}

void print_campaign(const Campaign& campaign) {
  for (const TrialMotion motion : campaign.options.motions) {
    fmt::print("\n{}",
               report::in_plain_text(table_of(campaign, campaign.options.tasks.back(), motion)));
  }
  for (const std::string& line : campaign.chosen.log) fmt::print("{}\n", line);
  fmt::print("chosen on {} other people; {:.0f} s of processor time, {:.0f} s on the clock\n",
             campaign.chosen_on, campaign.processor_s, campaign.wall_s);
}

}  // namespace stillhand::study
