// SPDX-License-Identifier: Apache-2.0
#include "dashboard/pages.hpp"

#include <array>

#include "contract/config_error.hpp"
#include "recording/file_io.hpp"

namespace stillhand::dashboard {

namespace {

struct Named {
  const char* file;
  const char* type;
};

constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr const char* kStyle = "text/css; charset=utf-8";
constexpr std::array<Named, 8> kFiles{{{"index.html", "text/html; charset=utf-8"},
                                       {"style.css", kStyle},
                                       {"main.js", kScript},
                                       {"status.js", kScript},
                                       {"tables.js", kScript},
                                       {"charts.js", kScript},
                                       {"uPlot.esm.js", kScript},
                                       {"uPlot.min.css", kStyle}}};

}  // namespace

Pages::Pages(const std::filesystem::path& folder) {
  for (const auto& [file, type] : kFiles) {
    const std::filesystem::path path = folder / file;
    if (!std::filesystem::is_regular_file(path)) {
      throw ConfigError(path.string(), "no such file",
                        "the page's files, which a build with npm puts there");
    }
    pages_[std::string("/") + file] = {type, recording::read_file(path.string())};
  }
  pages_["/"] = pages_["/index.html"];
}

const Page* Pages::find(std::string_view path) const {
  const auto found = pages_.find(path);
  return found == pages_.end() ? nullptr : &found->second;
}

}  // namespace stillhand::dashboard
