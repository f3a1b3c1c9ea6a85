// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <string>

#include "services/cancellation/shell.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  std::string canceller;
  return runtime::run_service(
      "cancellation", argc, argv,
      [&canceller](runtime::Service& service) {
        auto config = service.config<cancellation::Config>();
        if (!canceller.empty()) config.sampling = cancellation::sampling_named(canceller);
        cancellation::Shell shell(service, config);
        shell.run();
      },
      [&canceller](CLI::App& cli, runtime::ServiceOptions& options) {
        cli.add_option("--canceller", canceller,
                       "now (1 kHz) or paper (the paper's low-pass, 50 Hz, one sample late), in "
                       "place of the settings' sampling")
            ->check(CLI::IsMember({"now", "paper"}));
        cli.add_flag("--answer-replay", options.answers_replay,
                     "answer a replayed recording; no rig takes the answers");
      });
}
