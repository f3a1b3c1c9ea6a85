// SPDX-License-Identifier: Apache-2.0
// The watch on the model (services/core/cancellation/model_watch): false alarms an hour, and how
// long a change goes unnoticed.
//   build/tests/model_watch --subjects 24 --seed 1
// Each simulated subject is identified and cancels for --minutes.  Then the same again, with the
// same noise, but the stiffness of shoulder and grip changes once, after two minutes of cancelling.
// "size" is what the change does to the feedthrough force, by the rig's truth: RMS of the
// difference over RMS without it.
#include "services/core/cancellation/model_watch.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/in_process.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/population/population.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/system/command_line/command_line.hpp"
#include "tests/benchmark/on_all_cores.hpp"

namespace {

using namespace stillhand;

constexpr double kLearn_s = 120.0;  // of cancelling, before a change

struct Options {
  std::int64_t subjects = 24;
  std::uint64_t seed = 1;
  double minutes = 9.0;
  std::vector<double> rates_h{5.0, 1.0, 0.1};
  std::vector<double> changes{0.15, 0.3, 0.6, 1.2};
};

struct Alarm {
  double found_s;  ///< of cancelling
  double since_s;
  double share;
};

struct Run {
  std::vector<std::vector<Alarm>> alarms;  ///< of each rate
  std::vector<double> feedthrough_n;
  double change_s = 0.0;  ///< in the session
};

std::vector<Alarm> watched(const recording::Recording& rows, double rate_h) {
  const auto column = [&](const char* name) -> const std::vector<double>& {
    return std::ranges::find(rows.columns, name, &recording::Column::name)->values;
  };
  const std::vector<double>& motor_n = column("f_motor");
  const std::vector<double>& theta_rad = column("theta");
  cancellation::ModelWatch watch(rate_h);
  std::vector<Alarm> alarms;
  for (std::size_t n = 0; n < theta_rad.size(); ++n) {
    const auto tick = static_cast<Tick>(n);
    if (const auto change = watch.step({tick, 0, true, -motor_n[n], -motor_n[n], theta_rad[n]})) {
      alarms.push_back({static_cast<double>(n) * kControlPeriod_s,
                        static_cast<double>(change->since) * kControlPeriod_s, change->share});
    }
  }
  return alarms;
}

Run run(const Options& options, std::int64_t index, double change, double change_s) {
  const population::Subject subject =
      population::draw_subject(population::Population{}, options.seed, index);
  session::CoreConfigs configs;
  configs.rig.body = subject.body;
  configs.rig.body.neuromuscular.change = change;
  configs.rig.body.neuromuscular.change_at_s = change_s;
  configs.human_operator = subject.who;
  configs.human_operator.arm = population::learnt_feel(configs.rig.body, configs.rig.stick);
  session::ProtocolOptions protocol;
  protocol.conditions = {session::Condition::kC};
  protocol.trial_s = 60.0 * options.minutes;
  protocol.seed = options.seed * 1000 + static_cast<std::uint64_t>(index);
  const auto plan = session::plan(protocol);
  session::InProcessLoop loop(configs, protocol.seed);
  const auto identified = identification::identify(loop.run(plan.at(0)).pegged, {});
  if (loop.use_model(identified) != cancellation::Refusal::kNone) {
    throw ConfigError("model", "refused", "a sound one");
  }
  loop.keep_measured();
  const session::TrialSignals signals = loop.run(plan.at(1));
  Run out;
  for (const double rate_h : options.rates_h) {
    out.alarms.push_back(watched(signals.measured, rate_h));
  }
  out.feedthrough_n = signals.feedthrough_n;
  out.change_s = signals.measured.time_s.front() + kLearn_s;
  return out;
}

// 95 %, of a count of Poisson.
std::string interval(double count, double hours) {
  using boost::math::chi_squared;
  const double low = count == 0.0 ? 0.0 : quantile(chi_squared(2.0 * count), 0.025) / 2.0;
  const double high = quantile(chi_squared(2.0 * count + 2.0), 0.975) / 2.0;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.2f [%.2f, %.2f]", count / hours, low / hours,
                high / hours);
  return text.data();
}

void print_false_alarms(const Options& options, const std::vector<Run>& still) {
  const double hours = static_cast<double>(options.subjects) * options.minutes / 60.0;
  std::printf("%.1f h of cancelling without a change\nstated [1/h]  measured [1/h], 95 %%\n",
              hours);
  for (std::size_t i = 0; i < options.rates_h.size(); ++i) {
    double count = 0.0;
    for (const Run& each : still) count += static_cast<double>(each.alarms[i].size());
    std::printf("%12.2f  %s\n", options.rates_h[i], interval(count, hours).c_str());
  }
}

double size_of(const Run& still, const Run& changed) {
  double difference = 0.0;
  double all = 0.0;
  for (auto n = static_cast<std::size_t>(kLearn_s * kControlRateHz); n < still.feedthrough_n.size();
       ++n) {
    const double apart = changed.feedthrough_n[n] - still.feedthrough_n[n];
    difference += apart * apart;
    all += still.feedthrough_n[n] * still.feedthrough_n[n];
  }
  return std::sqrt(difference / all);
}

void print_change(const Options& options, double change, const std::vector<Run>& still,
                  const std::vector<Run>& changed) {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < still.size(); ++i) sizes.push_back(size_of(still[i], changed[i]));
  for (std::size_t rate = 0; rate < options.rates_h.size(); ++rate) {
    std::vector<double> delays_s, early_s;
    std::size_t found = 0;
    for (const Run& each : changed) {
      const auto alarm = std::ranges::find_if(
          each.alarms[rate], [](const Alarm& one) { return one.found_s >= kLearn_s; });
      if (alarm == each.alarms[rate].end()) continue;
      ++found;
      delays_s.push_back(alarm->found_s - kLearn_s);
      early_s.push_back(alarm->since_s - kLearn_s);
    }
    std::printf("%6.2f  %5.2f  %6.1f  %4zu of %zu", change, statistics::median(sizes),
                options.rates_h[rate], found, changed.size());
    if (found > 2) {
      std::printf("  %6.0f  %5.0f to %3.0f  %+6.0f", statistics::median(delays_s),
                  statistics::quantile(delays_s, 0.25), statistics::quantile(delays_s, 0.75),
                  statistics::median(early_s));
    }
    std::printf("\n");
  }
}

int measure(const Options& options) {
  const auto count = static_cast<std::size_t>(options.subjects);
  std::vector<Run> still(count), changed(count);
  benchmark::on_all_cores(count, [&](std::size_t i) {
    still[i] = run(options, static_cast<std::int64_t>(i), 0.0, 0.0);
  });
  print_false_alarms(options, still);
  std::printf("\nchange   size  [1/h]  found in %.0f s  median [s]  quartiles  onset [s]\n",
              60.0 * options.minutes - kLearn_s);
  for (const double change : options.changes) {
    benchmark::on_all_cores(count, [&](std::size_t i) {
      changed[i] = run(options, static_cast<std::int64_t>(i), change, still[i].change_s);
    });
    print_change(options, change, still, changed);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  command_line::Program app("false alarms and delays of the watch on the model");
  app.add_option("--subjects", options.subjects, "how many");
  app.add_option("--seed", options.seed, "of the subjects and their noise");
  app.add_option("--minutes", options.minutes, "of cancelling, of each subject");
  app.add_option("--rates", options.rates_h, "false alarms an hour that are stated");
  app.add_option("--changes", options.changes, "of the stiffness of shoulder and grip");
  if (const auto status = app.parse(argc, argv)) return *status;
  return measure(options);
}
