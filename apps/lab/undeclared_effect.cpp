// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/undeclared_effect.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <stdexcept>

#include "apps/lab/processes.hpp"
#include "services/files/rig/sealed_file.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::lab {

void open_undeclared_effect(const LabOptions& options, const LiveSession& session,
                            const std::string& verdict) {
  constexpr std::int64_t kLimit_ns = 60'000'000'000;
  constexpr std::int64_t kPoll_ns = 20'000'000;
  Launch launch;
  launch.name = "rig";
  launch.executable = options.programs / "stillhand-rig";
  launch.log = options.out / "logs" / "experiment.log";
  launch.standard_input = session.sealed;
  launch.arguments = {"--open-undeclared-effect",
                      "--config",
                      session.config.string(),
                      "--out",
                      options.out.string(),
                      "--verdict",
                      verdict};
  Processes processes;
  processes.start(launch);
  const std::int64_t limit_ns = runtime::monotonic_ns() + kLimit_ns;
  std::optional<Ended> ended;
  while (!(ended = processes.reap())) {
    if (runtime::monotonic_ns() > limit_ns) {
      throw std::runtime_error("the undeclared effect could not be opened within 60 s");
    }
    runtime::sleep_until_ns(runtime::monotonic_ns() + kPoll_ns);
  }
  if (ended->exit_status != 0) throw std::runtime_error(describe(*ended));
  fmt::print("undeclared effect opened: {}\n", (options.out / rig::kSealedFile).string());
}

}  // namespace stillhand::lab
