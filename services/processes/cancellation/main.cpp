// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <utility>

#include "services/core/admittance/session_excitation.hpp"
#include "services/processes/cancellation/shell.hpp"
#include "services/system/command_line/command_line.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  std::string canceller;
  admittance::SessionPerturbation perturbation;
  return runtime::run_service(
      "cancellation", argc, argv,
      [&](runtime::Service& service) {
        auto config = service.config<cancellation::Config>();
        if (!canceller.empty()) config.sampling = cancellation::sampling_named(canceller);
        std::optional<signal::Multisine> force;
        if (perturbation.period_s != 0.0) {
          force = admittance::design(admittance::session_excitation(perturbation)).force;
        }
        cancellation::Shell shell(service, config, std::move(force));
        shell.run();
      },
      [&](command_line::Command& cli, runtime::ServiceOptions& options) {
        cli.add_option("--canceller", canceller,
                       "now (1 kHz) or paper (the paper's low-pass, 50 Hz, one sample late), in "
                       "place of the settings' sampling")
            .one_of({"now", "paper"});
        cli.add_option("--perturb-period-s", perturbation.period_s,
                       "perturb the hand by a multisine of this period in place of cancelling");
        cli.add_option("--perturb-seed", perturbation.seed, "seed of its phases");
        cli.add_flag("--perturb-swapped", perturbation.swapped,
                     "platform and motor take each other's lines");
        cli.add_flag("--answer-replay", options.answers_replay,
                     "answer a replayed recording; no rig takes the answers");
      });
}
