// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/server/pages.hpp"

#include <array>

#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::dashboard {

namespace {

struct Kind {
  const char* suffix;
  const char* type;
};

constexpr std::array<Kind, 3> kContentTypes{{{".html", "text/html; charset=utf-8"},
                                             {".css", "text/css; charset=utf-8"},
                                             {".js", "text/javascript; charset=utf-8"}}};

}  // namespace

Pages::Pages(const std::filesystem::path& folder) {
  for (const char* needed : {"index.html", "main.js", "uPlot.esm.js"}) {
    const std::filesystem::path path = folder / needed;
    if (!std::filesystem::is_regular_file(path)) {
      throw ConfigError(path.string(), "no such file",
                        "the files of the page; a build with npm installed puts them there");
    }
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    for (const auto& [suffix, type] : kContentTypes) {
      if (entry.path().extension() != suffix || !entry.is_regular_file()) continue;
      pages_["/" + entry.path().filename().string()] = {
          type, recording::read_file(entry.path().string())};
    }
  }
  pages_["/"] = pages_["/index.html"];
}

const Page* Pages::find(std::string_view path) const {
  const auto found = pages_.find(path);
  return found == pages_.end() ? nullptr : &found->second;
}

}  // namespace stillhand::dashboard
