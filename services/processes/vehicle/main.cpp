// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "services/core/motion/motion_generator.hpp"
#include "services/core/vehicle/vehicle_settings.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/load.hpp"
#include "services/processes/vehicle/shell.hpp"
#include "services/system/command_line/command_line.hpp"

// On the bus it is the session's motion.
int main(int argc, char** argv) {
  using namespace stillhand;
  std::string vehicle = vehicle::kOwnVehicle;
  return runtime::run_service(
      "motion", argc, argv,
      [&](runtime::Service& service) {
        const auto limits = service.config<motion::MotionGenerator::Config>().limits;
        const auto settings = settings::load<vehicle::VehicleSettings>(
            service.options().config / "vehicle.yaml", "vehicle");
        vehicle::Shell(service, vehicle::driven_config(limits, settings, vehicle)).run();
      },
      [&](command_line::Command& cli, runtime::ServiceOptions&) {
        cli.description(
            "stillhand-vehicle_motion: the motion of a session, by a vehicle under the stick; "
            "`stillhand lab --vehicle NAME` starts it");
        cli.add_option("--vehicle", vehicle,
                       "first_order, second_order, excavator, wheelchair, aircraft_roll, or "
                       "settings: dynamics and delay of vehicle.yaml")
            .check(settings::check_name)
            .capture_default_str();
      });
}
