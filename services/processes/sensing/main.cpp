// SPDX-License-Identifier: Apache-2.0
#include "services/bus/service.hpp"
#include "services/messages/sensing/codec.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  return runtime::run_service("sensing", argc, argv, [](runtime::Service& service) {
    sensing::Conditioner core(service.config<sensing::Config>());
    auto sensed = service.bus().publisher<stillhand_msgs::Sensed>(topics::kSensed);
    service.on_trial([&](const Trial& trial, const auto&) { service.note_armed(trial.number); });
    service.bus().subscribe<stillhand_msgs::RawSample>(
        topics::kRawSample, [&](const stillhand_msgs::RawSample& raw, const runtime::Arrival&) {
          auto message = sensing::to_idl(core.step(sensing::from_idl(raw)), raw);
          sensed.write(message);
          service.note_tick(raw.tick());
        });
    service.run();
  });
}
