// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "apps/libraries/report/text/text.hpp"
#include "apps/study/report/csv_cells.hpp"
#include "apps/study/report/diagnoses_output.hpp"
#include "apps/study/report/output.hpp"

namespace stillhand::study {
namespace {

using csv::row;
using csv::text;
using report::csv_quoted;

// The participant's code, or the number of a simulated subject.
std::string subject_key(const StudyRecord& record, std::size_t index) {
  return record.recorded ? csv_quoted(record.recorded->participants[index])
                         : std::to_string(index + 1);
}

// Headers of numbers of the table, each after a comma, and their cells of a trial.
std::string headers(auto numbers) {
  std::string out;
  for (const session::Number& each : numbers) out += std::string(",") + each.header();
  return out;
}
std::string cells(auto numbers, const session::TrialNumbers& trial) {
  std::string out;
  for (const session::Number& each : numbers) out += "," + text(each.of(trial));
  return out;
}

CsvFile metrics_file(const StudyRecord& record) {
  std::string out = "subject,condition,place in order" + headers(session::numbers(session::kCsv)) +
                    ",feedthrough rms [N]\n";
  for (std::size_t i = 0; i < record.results.size(); ++i) {
    const std::vector<Condition>& order = record.results[i].order;
    for (const auto& [condition, trial] : record.results[i].trials) {
      const auto place = std::ranges::find(order, condition) - order.begin() + 1;
      out += row({subject_key(record, i), name_of(condition),
                  std::to_string(place) + cells(session::numbers(session::kCsv), trial),
                  text(trial.feedthrough_rms_n)});
    }
  }
  return {"metrics.csv", out};
}

CsvFile subjects_file(const StudyRecord& record) {
  std::string out =
      "subject,trunk mass [kg],seat stiffness [N/m],seat damping [N s/m],arm mass [kg],shoulder "
      "stiffness [N/m],shoulder damping [N s/m],grip stiffness [N/m],grip damping [N s/m],hand "
      "mass [kg],co-contraction [-],crossover [Hz],delay [s],muscle [rad/s],remnant ratio "
      "[-],regression error [m]\n";
  for (std::size_t i = 0; i < record.results.size(); ++i) {
    const rig::BodyConfig& body = record.results[i].subject.body;
    const human_operator::CrossoverConfig& who = record.results[i].subject.who;
    out +=
        row({std::to_string(i + 1), text(body.trunk_mass_kg), text(body.seat_stiffness_n_m),
             text(body.seat_damping_n_s_m), text(body.arm_mass_kg),
             text(body.shoulder_stiffness_n_m), text(body.shoulder_damping_n_s_m),
             text(body.grip_stiffness_n_m), text(body.grip_damping_n_s_m), text(body.hand_mass_kg),
             text(body.cocontraction_stiffness_factor), text(who.crossover_hz), text(who.delay_s),
             text(who.muscle_rad_s), text(who.remnant_ratio), text(who.regression_error_m)});
  }
  return {"subjects.csv", out};
}

CsvFile models_file(const StudyRecord& record) {
  std::string out = "subject,model,rate [Hz]";
  const std::size_t order = record.results.front().identification.paper.model.order();
  for (std::size_t i = 0; i <= order; ++i) out += ",c" + std::to_string(i) + " [N s^2/m]";
  for (std::size_t i = 1; i <= order; ++i) out += ",d" + std::to_string(i) + " [-]";
  out += '\n';
  const auto line = [&](std::size_t subject, const char* which,
                        const signal::DifferenceModel& model) {
    out += subject_key(record, subject) + "," + which + "," + text(model.rate_hz);
    for (const double c : model.numerator) out += "," + text(c);
    for (std::size_t i = 1; i < model.denominator.size(); ++i) {
      out += "," + text(model.denominator[i]);
    }
    out += '\n';
  };
  for (std::size_t i = 0; i < record.results.size(); ++i) {
    line(i, "paper", record.results[i].identification.paper.model);
    line(i, "refined", record.results[i].identification.refined.model);
    line(i, "1 kHz filter", record.results[i].identification.control.model);
  }
  return {"models.csv", out};
}

CsvFile moving_file(const StudyRecord& record) {
  std::string out = "subject,condition,window start [s],rms error [mm],dwell ratio [-]\n";
  for (std::size_t i = 0; i < record.results.size(); ++i) {
    for (const auto& [condition, trial] : record.results[i].trials) {
      for (std::size_t s = 0; s < trial.metrics.moving_rms_mm.size(); ++s) {
        out += row({subject_key(record, i), name_of(condition), std::to_string(s),
                    text(trial.metrics.moving_rms_mm[s]), text(trial.metrics.moving_dwell[s])});
      }
    }
  }
  return {"moving_averages.csv", out};
}

CsvFile open_loop_file(const StudyRecord& record) {
  std::string out =
      "subject,condition,frequency [Hz],gain [-],phase [rad],remnant share of error power [-]\n";
  for (std::size_t i = 0; i < record.results.size(); ++i) {
    for (const auto& [condition, trial] : record.results[i].trials) {
      for (const auto& line : trial.metrics.lines) {
        out += row({subject_key(record, i), name_of(condition), text(line.frequency_hz),
                    text(std::abs(line.gain)), text(std::arg(line.gain)),
                    text(std::min(1.0, 1.0 / line.error_snr))});
      }
    }
  }
  return {"open_loop.csv", out};
}

// Empty outside an experiment.
std::string planned_number(std::int64_t number) {
  return number > 0 ? std::to_string(number) : std::string();
}

CsvFile trials_file(const RecordedSource& source) {
  std::string out = "participant,session,trial,place,condition" +
                    headers(session::numbers(session::kCsv)) +
                    ",lost share [-],block,place in plan,in tables\n";
  for (const RecordedTrial& trial : source.trials) {
    out += row({csv_quoted(trial.participant), csv_quoted(trial.session),
                std::to_string(trial.number), std::to_string(trial.place),
                name_of(trial.condition) + cells(session::numbers(session::kCsv), trial.tracked),
                text(trial.lost_share), planned_number(trial.block), planned_number(trial.step),
                source.used.contains(id_of(trial)) ? "1" : "0"});
  }
  return {"trials.csv", out};
}

// The same metrics of the simulated subjects, in their order.
CsvFile simulated_file(const SimulatedSide& simulated) {
  std::string out = "subject,condition" + headers(session::samples()) + "\n";
  for (std::size_t i = 0; i < simulated.results.size(); ++i) {
    for (const auto& [condition, trial] : simulated.results[i].trials) {
      out += row(
          {simulated.same_people ? csv_quoted(simulated.participants[i]) : std::to_string(i + 1),
           name_of(condition) + cells(session::samples(), trial)});
    }
  }
  return {"simulated.csv", out};
}

}  // namespace

std::vector<CsvFile> csv_files(const StudyRecord& record) {
  std::vector<CsvFile> out{metrics_file(record), models_file(record), moving_file(record),
                           open_loop_file(record)};
  // Only a simulated subject's body is known.
  if (record.recorded) {
    out.push_back(trials_file(*record.recorded));
    if (record.simulated) out.push_back(simulated_file(*record.simulated));
    if (record.diagnoses) {
      for (CsvFile& file : diagnoses_csv(*record.diagnoses)) out.push_back(std::move(file));
    }
  } else {
    out.push_back(subjects_file(record));
  }
  return out;
}

}  // namespace stillhand::study
