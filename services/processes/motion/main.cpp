// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/check_name.hpp"
#include "services/processes/motion/shell.hpp"
#include "services/system/command_line/command_line.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  motion::RideAndRoad way;
  return runtime::run_service(
      "motion", argc, argv,
      [&](runtime::Service& service) {
        motion::Shell shell(service, way);
        shell.run();
      },
      [&](command_line::Command& cli, runtime::ServiceOptions&) {
        cli.add_option("--ride", way.ride,
                       "recorded ride that the platform follows: CSV with a_y [m/s^2], or .mcap")
            .check(settings::check_name);
        cli.add_option("--road-class", way.road_class, "ISO 8608 road, A (very good) to H")
            .capture_default_str();
        cli.add_option("--speed-m-s", way.road_speed_m_s, "speed on the road [m/s]")
            .capture_default_str();
        cli.add_option("--perturb-period-s", way.perturbation.period_s,
                       "period of the platform's multisine while the motor perturbs the hand");
        cli.add_option("--perturb-seed", way.perturbation.seed, "seed of its phases");
        cli.add_flag("--perturb-swapped", way.perturbation.swapped,
                     "platform and motor take each other's lines");
      });
}
