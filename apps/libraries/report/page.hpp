// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/libraries/report/plot/draw.hpp"

namespace stillhand::report {

enum class Emphasis { kNone, kStrong, kGood, kBad, kFaint };

struct Cell {
  Cell(std::string words = {}, Emphasis weight = Emphasis::kNone)  // NOLINT: rows of plain strings
      : text(std::move(words)), emphasis(weight) {}
  Cell(const char* words) : text(words) {}  // NOLINT: as above

  std::string text;
  Emphasis emphasis = Emphasis::kNone;
  std::string href = {};  ///< a page next to this one, or empty
};

/// A cell that leads to another file of the same folder.
/// @param file  its name, not encoded
Cell linked(std::string text, std::string_view file);

/// Banner of every page whose subjects are simulated.
inline constexpr std::string_view kSimulatedBanner =
    "Simulated subjects: no person took part. These figures say nothing about people.";

enum class Align { kLeft, kRight, kCentre };

/// Rows may be shorter than the header, not longer; missing cells stay empty.
struct Table {
  std::string caption = {};
  std::vector<std::string> header = {};
  std::vector<std::vector<Cell>> rows = {};
  std::vector<Align> align = {};  ///< of the columns; default: the first left, the others right
};

/// A table for the terminal: the caption, then a line for the header and each row.
std::string in_plain_text(const Table& table);

/// One HTML page that needs no other file: it contains its style and figures, has no script and
/// loads nothing.  Its links lead to other pages of its folder.  It follows the reader's light or
/// dark scheme, and is readable on a phone and on paper.  Every text is plain text and escaped.
/// Tables and figures are numbered in order.
///
///   report::Page page("Study", "Twelve subjects ...");
///   page.facts({{"seed", "1"}});
///   page.section("Tracking error");
///   page.figure(drawings[0]);
///   page.write(folder / "report.html");
///
/// Thread-compatible.
class Page {
 public:
  explicit Page(std::string title, std::string lead = {});

  /// What has to be known before anything else is read.
  void banner(std::string_view text);
  /// Origin of the results: seed, versions, command line.
  void facts(const std::vector<std::pair<std::string, std::string>>& pairs);
  /// A heading, listed in the table of contents.  `level` is 2 or 3.
  void section(std::string_view heading, int level = 2);
  void paragraph(std::string_view text);
  /// A line that is a link.  @param file  as linked()
  void link(std::string_view text, std::string_view file);
  void list(const std::vector<std::string>& items);
  /// A highlighted box.
  void warning(std::string_view text);
  void table(const Table& table);
  void figure(const Drawing& drawing);

  /// The whole page.
  [[nodiscard]] std::string html() const;

  /// Writes html() to a file, which appears whole or not at all.
  /// @throws std::runtime_error with the file and the reason
  void write(const std::filesystem::path& path) const;

 private:
  struct Heading {
    std::string text;
    std::string id;
    int level;
  };

  [[nodiscard]] std::string contents() const;

  std::string title_;
  std::string lead_;
  std::string head_;  ///< banners and facts, in the order of the calls
  std::string body_;
  std::vector<Heading> headings_;
  int tables_ = 0;
  int figures_ = 0;
};

}  // namespace stillhand::report
