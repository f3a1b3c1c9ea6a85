// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/plot/svg.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stillhand::report::svg_test {

using testing::HasSubstr;
using testing::Not;

TEST(AdaptedSvgTest, IdsAndAllThreeKindsOfReferenceGetThePrefix) {
  const std::string sut = adapted_svg(
      "<svg><path id='gpPt0'/><g id=\"c\"><use xlink:href='#gpPt0' id='gpPt1'/>"
      "<text filter=\"url(#textbox)\">t</text></g></svg>",
      "bode");
  EXPECT_THAT(sut, HasSubstr("<path id='bode-gpPt0'/>"));
  EXPECT_THAT(sut, HasSubstr("<g id=\"bode-c\">"));
  EXPECT_THAT(sut, HasSubstr("xlink:href='#bode-gpPt0' id='bode-gpPt1'"));
  EXPECT_THAT(sut, HasSubstr("url(#bode-textbox)"));
}

TEST(AdaptedSvgTest, TextThatLooksLikeAnIdStays) {
  EXPECT_THAT(adapted_svg("<svg><text>x id='gpDot' url(#a) > b</text></svg>", "p"),
              HasSubstr("<text>x id='gpDot' url(#a) > b</text>"));
}

TEST(AdaptedSvgTest, ToolTipsAndEmptyGroupsGoAndFullGroupsStay) {
  const std::string sut = adapted_svg(
      "<svg><title>gnuplot_plot_1</title><g fill=\"none\">\n</g><g id=\"a\"><g x=\"1\">\n"
      "<g y=\"2\"></g></g><path d='M0,0'/></g><text>&lt;g x></text></svg>",
      "p");
  EXPECT_THAT(sut, Not(HasSubstr("gnuplot_plot_1")));
  EXPECT_THAT(sut, Not(HasSubstr("fill=\"none\"")));
  EXPECT_THAT(sut, Not(HasSubstr("y=\"2\"")));
  EXPECT_THAT(sut, HasSubstr("<g id=\"p-a\"><path d='M0,0'/></g><text>&lt;g x></text></svg>"));
}

TEST(AdaptedSvgTest, TheFontIsNamedOnceWithSubstitutes) {
  const std::string sut = adapted_svg(
      "<svg width=\"9\"><g font-family=\"DejaVu Sans\" x=\"1\">a</g>"
      "<g font-family=\"DejaVu Sans:Bold\">b</g></svg>",
      "p");
  EXPECT_THAT(sut, HasSubstr("<g x=\"1\">a</g><g font-weight=\"bold\">b</g>"));
  EXPECT_THAT(sut, HasSubstr("<svg width=\"9\" font-family=\"'DejaVu Sans',"));
}

// Of damaged input nothing is asked but an end: no loop, no read beyond it (sanitizers watch).
TEST(AdaptedSvgTest, DamagedInputGivesNoMoreThanItHeld) {
  for (const char* broken : {"", "<", "<svg", "no tags", "<svg><title>open", "<g ></g></g>"}) {
    EXPECT_LE(adapted_svg(broken, "p").size(), std::string_view(broken).size() + 100) << broken;
  }
}

TEST(InlineSvgTest, TheDeclarationGoesAndTheDescriptionIsEscaped) {
  const std::string sut =
      inline_svg("<?xml version=\"1.0\"?>\n<svg width=\"9\"></svg>", "a \"b\"", 9);
  EXPECT_EQ(sut.find("<svg role=\"img\" aria-label=\"a &quot;b&quot;\""), 0U);
  EXPECT_THAT(sut, HasSubstr("width=\"9\"></svg>"));
}

}  // namespace stillhand::report::svg_test
