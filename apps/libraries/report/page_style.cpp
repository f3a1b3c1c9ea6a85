// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/report/page_style.hpp"

#include <string_view>

namespace stillhand::report {
namespace {

// Colours of the light and the dark scheme.
constexpr std::string_view kColours = R"(
:root { --ground: #ffffff; --text: #1d2327; --faint: #5c6770; --rule: #d9dee3; --soft: #f5f7f9;
  --link: #005a8c; --good: #00694c; --bad: #b03a00; --warn-ground: #fff6e0; --warn-rule: #d98e00; }
@media (prefers-color-scheme: dark) { :root { --ground: #14181c; --text: #e4e8eb; --faint: #9aa6b0;
  --rule: #343c44; --soft: #1c2228; --link: #7cc4f4; --good: #5fd1a8; --bad: #ff9b63;
  --warn-ground: #332a12; --warn-rule: #d9a036; } })";

// Headings, paragraphs and links.
constexpr std::string_view kText = R"(
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; scroll-behavior: smooth; }
body { margin: 0; background: var(--ground); color: var(--text);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans",
  "DejaVu Sans", Arial, sans-serif; overflow-wrap: break-word; }
main { max-width: 940px; margin: 0 auto; padding: 28px 20px 64px; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .5rem; }
h2 { font-size: 1.35rem; line-height: 1.25; margin: 2.4rem 0 .6rem; padding-bottom: .25rem;
  border-bottom: 1px solid var(--rule); }
h3 { font-size: 1.08rem; margin: 1.8rem 0 .4rem; }
p, ul { margin: .6rem 0; max-width: 46rem; }
a { color: var(--link); }
.lead { font-size: 1.12rem; color: var(--faint); })";

// The facts of the header, and the table of contents.
constexpr std::string_view kFacts = R"(
dl { display: grid; grid-template-columns: repeat(auto-fill, minmax(250px, 1fr)); gap: 0 1.6rem;
  margin: 1.2rem 0; padding: .6rem 1rem; background: var(--soft); border-radius: 8px; }
dl div { display: flex; gap: .7rem; padding: .18rem 0; font-size: .9rem; min-width: 0; }
dl .wide { grid-column: 1 / -1; }
dt { color: var(--faint); flex: none; }
dd { margin: 0; min-width: 0; overflow-wrap: anywhere; font-variant-numeric: tabular-nums; }
nav { max-width: 940px; margin: 0 auto; padding: 20px 20px 0; font-size: .92rem; }
nav h2 { font-size: .8rem; text-transform: uppercase; letter-spacing: .06em; color: var(--faint);
  border: 0; margin: 0 0 .3rem; padding: 0; }
nav ul { list-style: none; margin: 0; padding: 0; columns: 2 240px; column-gap: 2rem; }
nav li { padding: .12rem 0; break-inside: avoid; }
nav .level3 { padding-left: 1rem; }
nav a { text-decoration: none; }
nav a:hover { text-decoration: underline; })";

// Figures, tables and warnings.
constexpr std::string_view kContent = R"(
figure { margin: 1.4rem 0; }
figcaption { font-size: .9rem; color: var(--faint); margin: .45rem 0; max-width: 52rem; }
figcaption b { color: var(--text); }
.scroll { overflow-x: auto; scrollbar-width: thin; background:
  linear-gradient(to right, var(--ground) 30px, transparent) left / 60px 100% no-repeat local,
  linear-gradient(to left, var(--ground) 30px, transparent) right / 60px 100% no-repeat local,
  linear-gradient(to right, #0003, transparent) left / 12px 100% no-repeat scroll,
  linear-gradient(to left, #0003, transparent) right / 12px 100% no-repeat scroll; }
.card { background: #ffffff; border: 1px solid var(--rule); border-radius: 8px; padding: 10px; }
.card svg { display: block; width: 100%; max-width: var(--width);
  min-width: min(600px, var(--width)); height: auto; margin: 0 auto; }
table { border-collapse: collapse; font-size: .88rem; font-variant-numeric: tabular-nums;
  border-top: 2px solid var(--text); border-bottom: 2px solid var(--text); }
th, td { padding: .32rem .62rem; white-space: nowrap; }
td.l { white-space: normal; min-width: 7.5rem; }
th { font-weight: 600; border-bottom: 1px solid var(--text); vertical-align: bottom; }
tbody tr + tr td { border-top: 1px solid var(--rule); }
.l { text-align: left; } .r { text-align: right; } .c { text-align: center; }
.strong { font-weight: 700; }
@media screen and (prefers-color-scheme: dark) { .card { background: #1a1a1a; }
  .card svg { filter: invert(.9) hue-rotate(180deg); } }
.good { color: var(--good); font-weight: 600; }
.bad { color: var(--bad); font-weight: 600; }
.faint { color: var(--faint); }
.warning { margin: 1rem 0; padding: .7rem 1rem; background: var(--warn-ground);
  border-left: 4px solid var(--warn-rule); border-radius: 4px; max-width: 52rem; })";

// Wide screens, with the contents at the left; and narrow ones.
constexpr std::string_view kScreens = R"(
@media (min-width: 1260px) {
  body { display: grid; grid-template-columns: 250px minmax(0, 940px); justify-content: center;
    gap: 24px; }
  main { grid-column: 2; margin: 0; }
  nav { position: sticky; top: 0; align-self: start; max-height: 100vh; overflow-y: auto;
    padding: 34px 0 20px 20px; margin: 0; }
  nav ul { columns: auto; }
}
@media (max-width: 600px) {
  main { padding: 16px 14px 40px; }
  nav { padding: 14px 14px 0; }
  h1 { font-size: 1.5rem; }
  h2 { font-size: 1.2rem; }
  .card { padding: 4px; }
  th, td { padding: .3rem .35rem; white-space: normal; }
  td.l { min-width: 5rem; }
})";

// Paper.
constexpr std::string_view kPaper = R"(
@media print {
  :root { --ground: #fff; --text: #000; --faint: #444; --rule: #bbb; --soft: #f4f4f4; --link: #000;
    --good: #00563e; --bad: #8f2f00; --warn-ground: #fff; --warn-rule: #777; }
  body { display: block; font-size: 10.5pt; }
  main { max-width: none; padding: 0; }
  nav { display: none; }
  h2, h3 { break-after: avoid; }
  figure, .warning, tr { break-inside: avoid; }
  .scroll { overflow: visible; }
  .card { border: 0; padding: 0; }
  .card svg { min-width: 0; }
}
)";

}  // namespace

std::string page_style() {
  std::string style;
  for (const std::string_view part : {kColours, kText, kFacts, kContent, kScreens, kPaper})
    style += part;
  return style;
}

}  // namespace stillhand::report
