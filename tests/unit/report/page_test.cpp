// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <set>
#include <stdexcept>

#include "tests/support/refusal.hpp"
#include "tests/unit/report/sample_figures.hpp"

namespace stillhand::report::page_test {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kHostile = "</style><script>alert('x')</script> & \"q\" $(y)\n`z`";
constexpr const char* kEscaped =
    "&lt;/style&gt;&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; &amp; &quot;q&quot; $(y) `z`";

std::vector<Drawing> two_drawings() {
  std::vector<Figure> figures{test::every_kind(), test::every_kind()};
  figures[1].name = "another";
  figures[1].caption = kHostile;
  return draw(figures);
}

Page full_page() {
  Page page("Study", "Twelve subjects.");
  page.facts({{"seed", "1"}});
  page.section("Results");
  page.paragraph("Text.");
  page.table({.caption = "Means", .header = {"metric", "A"}, .rows = {{"RMS error", "4.04"}}});
  page.section("Details", 3);
  for (const Drawing& drawing : two_drawings()) page.figure(drawing);
  page.list({"one", "two"});
  page.warning("Mind this.");
  return page;
}

TEST(PageTest, TheWholePageIsReadByAStrictParser) {
  EXPECT_TRUE(test::well_formed(full_page().html()));
}

TEST(PageTest, ALinkLeadsToAFileOfTheFolderWhateverItsName) {
  Page page("Study");
  page.table({.header = {"who"}, .rows = {{linked(kHostile, "javascript:alert(1)")}}});
  page.link("back", "a b/\"<>.html");
  const auto references = test::attributes(page.html(), "href");
  EXPECT_THAT(references,
              testing::ElementsAre("./javascript%3Aalert%281%29", "./a%20b%2F%22%3C%3E.html"));
  EXPECT_TRUE(test::well_formed(page.html()));
  EXPECT_THAT(page.html(), HasSubstr(kEscaped));
}

TEST(PageTest, NoTwoElementsShareAnIdAndEveryReferenceLeadsSomewhere) {
  const std::string sut = full_page().html();
  const auto ids = test::attributes(sut, "id");
  const std::set<std::string> different(ids.begin(), ids.end());
  EXPECT_EQ(different.size(), ids.size());
  std::vector<std::string> references = test::attributes(sut, "href");
  const auto in_svg = test::attributes(sut, "xlink:href");
  EXPECT_FALSE(in_svg.empty());
  references.insert(references.end(), in_svg.begin(), in_svg.end());
  for (const std::string& reference : references) {
    ASSERT_EQ(reference.front(), '#');
    EXPECT_EQ(different.count(reference.substr(1)), 1U) << reference;
  }
}

TEST(PageTest, EveryTextIsEscapedWhereverItStands) {
  Page sut(kHostile, kHostile);
  sut.facts({{kHostile, kHostile}});
  sut.section(kHostile);
  sut.section(kHostile, 3);
  sut.paragraph(kHostile);
  sut.warning(kHostile);
  sut.list({kHostile});
  sut.table({.caption = kHostile, .header = {kHostile}, .rows = {{kHostile}}});
  sut.figure(two_drawings()[1]);
  const std::string html = sut.html();
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_TRUE(test::well_formed(html));
  std::size_t found = 0;
  for (std::size_t at = 0; (at = html.find(kEscaped, at)) != std::string::npos; ++at) ++found;
  // title twice, lead, a fact's two sides, two headings and their links, paragraph, warning, item,
  // table's three, figure's caption and description
  EXPECT_EQ(found, 17U);
}

TEST(PageTest, NothingIsLoadedFromElsewhere) {
  const std::string sut = full_page().html();
  for (const char* loading :
       {"<script", "<link", "<img", "<iframe", "src=", "@import", "url(http"}) {
    EXPECT_THAT(sut, Not(HasSubstr(loading)));
  }
}

TEST(PageTest, TablesAndFiguresAreNumberedInOrder) {
  const std::string sut = full_page().html();
  EXPECT_THAT(sut, HasSubstr("<b>Table 1.</b> Means"));
  EXPECT_THAT(sut, HasSubstr("<b>Figure 1.</b> Every kind."));
  EXPECT_THAT(sut, HasSubstr("<b>Figure 2.</b> &lt;/style&gt;"));
}

TEST(PageTest, ACellShowsItsEmphasisAndAShortRowIsFilledUp) {
  Page sut("t");
  sut.table({.caption = "",
             .header = {"a", "b", "c"},
             .rows = {{"x", {"1", Emphasis::kGood}}},
             .align = {Align::kRight, Align::kCentre}});
  EXPECT_THAT(sut.html(), HasSubstr("<tr><td class=\"r\">x</td><td class=\"c good\">1</td>"
                                    "<td class=\"r\"></td></tr>"));
}

TEST(PageTest, WriteLeavesThePageAndNothingElse) {
  const test::TemporaryFolder folder;
  const Page sut = full_page();
  sut.write(folder.path() / "report.html");
  EXPECT_EQ(folder.entries(), 1U);
  EXPECT_EQ(support::text_of(folder / "report.html"), sut.html());
}

TEST(PageTest, AMissingFolderIsNamedInTheError) {
  EXPECT_THAT(
      support::refusal<std::runtime_error>([&] { Page("t").write("/nonexistent/report.html"); }),
      HasSubstr("/nonexistent/report.html"));
}

// A limit on the size of files stands in for a full disk: write() fails half-way in the same way.
TEST(PageTest, AWriteThatFailsHalfWayLeavesTheOldPageAndNothingElse) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "report.html";
  std::ofstream(path) << "old";
  const Page sut("t", std::string(100'000, 'x'));
  const auto old_action = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const rlimit small{10'000, old.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(sut.write(path), std::runtime_error);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old), 0);
  std::signal(SIGXFSZ, old_action);
  EXPECT_EQ(folder.entries(), 1U);
  EXPECT_EQ(support::text_of(path), "old");
}

TEST(TableTest, InATerminalColumnsAreAsWideAsTheirLongestText) {
  const Table table{.caption = "Means",
                    .header = {"metric", "A", "B"},
                    .rows = {{"f₀ [Hz]", "−4.04", "1"}, {"error", "20"}}};
  EXPECT_EQ(in_plain_text(table),
            "Means\n"
            "metric        A   B\n"
            "f₀ [Hz]   −4.04   1\n"
            "error        20\n");
}

}  // namespace stillhand::report::page_test
