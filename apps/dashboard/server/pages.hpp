// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace stillhand::dashboard {

struct Page {
  std::string type;  ///< MIME
  std::string content;
};

/// The page's own files, HTML, styles and scripts of one folder, read once at the start: a request
/// names one of these or nothing, so that no path of a request ever reaches the file system.
class Pages {
 public:
  /// @throws ConfigError when the folder is not the page's
  explicit Pages(const std::filesystem::path& folder);

  /// @param path  of the target, "/" for the page itself  @returns nullptr for any other
  [[nodiscard]] const Page* find(std::string_view path) const;

 private:
  std::map<std::string, Page, std::less<>> pages_;
};

}  // namespace stillhand::dashboard
