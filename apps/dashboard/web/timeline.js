// SPDX-License-Identifier: Apache-2.0
// The time line of a recording: marks of faults and events, and the instant that the page shows.
import { clock, create, draw, element, mark, write } from "/elements.js";
import { LEVELS, what } from "/status.js";

const LANES = [["late", "sent late"], ["lost", "lost"], ["alarm", "alarms"], ["event", "events"]];
const UNITS = { lost: "ticks" };
const STEP_S = 0.1;
const RECENT_S = 1;
const MOST_LISTED = 300;
const LEFT = 74; // [px] names of the lanes
const LANE_H = 20;
const plain = (event) => !event.ctrlKey && !event.metaKey && !event.altKey;

// A shape for each level: a stroke, a triangle, a square with a cross.
const SHAPES = { healthy: "M0-4V4", warning: "M0-6L6 5H-6z", critical: "M-6-6H6V6H-6zM-3-3L3 3M3-3L-3 3" };

export function spoken(kind, { subject, writer, what: word, amount, count }) {
  const times = count > 1 ? ` (${count} times)` : "";
  if (kind === "event") return `${subject}: ${word}${times}`;
  const watch = kind === "alarm" ? word : kind;
  return (kind === "alarm" ? "alarm: " : "") + what({ watch, subject, writer, worst: amount, unit: UNITS[watch] ?? "ms" }) + times;
}

export class Timeline {
  // at(seconds): the page shall show that instant
  constructor(at) {
    this.at = at;
    this.slider = element("instant");
    this.chosen_s = null;
    this.slider.addEventListener("input", () => this.choose(Number(this.slider.value)));
    this.slider.addEventListener("keydown", (event) => this.step(event));
    new ResizeObserver(() => this.lanes && this.drawn()).observe(element("timeline"));
    element("miss-before").addEventListener("click", () => this.jump(-1));
    element("miss-behind").addEventListener("click", () => this.jump(1));
    document.addEventListener("keydown", (event) => {
      if (!this.lanes || !plain(event) || event.target.tagName === "TEXTAREA") return;
      if (event.key.toLowerCase() === "n") this.jump(1);
      if (event.key.toLowerCase() === "p") this.jump(-1);
    });
  }

  // Also after the browser has connected again, since it may be another recording.
  async begin() {
    const answer = await fetch("/timeline");
    if (!answer.ok) return;
    this.lanes = await answer.json();
    this.slider.max = this.lanes.length_s;
    this.slider.step = STEP_S / 100;
    this.misses = [...this.lanes.marks.late, ...this.lanes.marks.lost].map(({ at_s }) => at_s).sort((one, other) => one - other);
    this.drawn();
    this.list();
    const [, wanted] = /^#at=([\d.]+)$/.exec(location.hash) ?? [];
    this.choose(this.chosen_s ?? (wanted === undefined ? this.lanes.length_s : Number(wanted)));
  }

  // An arrow moves by 0.1 s; with Shift, or with a page key, by 1 s.
  step(event) {
    const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (steps === undefined || !plain(event)) return;
    event.preventDefault();
    this.choose(this.chosen_s + STEP_S * steps * (event.shiftKey ? 10 : 1));
  }

  choose(wanted_s) {
    const seconds = Math.min(Math.max(wanted_s, 0), this.lanes.length_s);
    this.chosen_s = seconds;
    this.slider.value = seconds;
    const when = `${seconds.toFixed(3)} s of ${this.lanes.length_s.toFixed(1)} s, ${clock(this.lanes.begin_ms + 1000 * seconds)}`;
    mark(this.slider, "aria-valuetext", when);
    const here = this.nearest(seconds);
    write(element("when"), when);
    write(element("here"), here);
    history.replaceState(null, "", `#at=${seconds.toFixed(6)}`);
    this.place();
    this.at(seconds);
  }

  // The marks of exactly this instant.
  nearest(seconds) {
    const found = LANES.flatMap(([kind]) => this.lanes.marks[kind].filter(({ at_s }) => Math.abs(at_s - seconds) < 1e-5).map((each) => spoken(kind, each)));
    const trial = this.lanes.trials.find(({ from_s, to_s }) => from_s <= seconds && seconds <= to_s);
    return [trial ? `trial ${trial.trial} (${trial.phase})` : "between trials", ...found].join(" · ");
  }

  // Misses and losses of the last second up to the chosen instant, as alarms.
  recent() {
    return ["late", "lost"].flatMap((kind) => this.lanes.marks[kind]
      .filter(({ at_s, level }) => level !== "healthy" && at_s <= this.chosen_s + 1e-9 && at_s > this.chosen_s - RECENT_S)
      .map((each) => ({ ...each, watch: kind, worst: each.amount, unit: UNITS[kind] ?? "ms", active: this.chosen_s - each.at_s < 1e-5,
        acknowledged: false, since_ms: this.lanes.begin_ms + 1000 * each.at_s })));
  }

  jump(way) {
    const behind = this.misses.filter((at_s) => (at_s - this.chosen_s) * way > 1e-6);
    if (behind.length > 0) this.choose(way > 0 ? behind[0] : behind.at(-1));
    else write(element("here"), way > 0 ? "no miss after this instant" : "no miss before this instant");
  }

  x(seconds) {
    return LEFT + (this.width - LEFT - 10) * (seconds / this.lanes.length_s);
  }

  drawn() {
    this.width = Math.max(element("timeline").clientWidth, 280);
    const height = LANE_H * (LANES.length + 1) + 18;
    const svg = draw("svg", { viewBox: `0 0 ${this.width} ${height}`, width: this.width, height, role: "img", "aria-label": this.summary() });
    svg.append(draw("text", { x: 0, y: 14 }, "trials"));
    for (const { trial, phase, from_s, to_s } of this.lanes.trials) {
      const width = Math.max(this.x(to_s) - this.x(from_s), 2);
      const group = draw("g", { class: `trial ${phase}` });
      group.append(draw("rect", { x: this.x(from_s), y: 2, width, height: LANE_H - 4, rx: 3 }), draw("title", {}, `trial ${trial}, ${phase}`));
      if (width > 60) group.append(draw("text", { x: this.x(from_s) + 6, y: 14 }, width > 110 ? `${trial}: ${phase}` : `${trial}`));
      svg.append(group);
    }
    LANES.forEach(([kind, name], i) => {
      const y = LANE_H * (i + 1.5);
      svg.append(draw("text", { x: 0, y: y + 4 }, name), draw("path", { d: `M${LEFT} ${y}H${this.width - 10}`, class: "lane" }));
      // More severe marks are drawn above the others.
      for (const each of [...this.lanes.marks[kind]].sort((one, other) => LEVELS.indexOf(one.level) - LEVELS.indexOf(other.level))) {
        const node = draw("path", { d: SHAPES[each.level], class: `mark ${each.level}`, transform: `translate(${this.x(each.at_s).toFixed(1)} ${y})` });
        node.append(draw("title", {}, spoken(kind, each)));
        node.addEventListener("click", (event) => { event.stopPropagation(); this.choose(each.at_s); });
        svg.append(node);
      }
    });
    this.scale(svg, height);
    this.cursor = draw("path", { class: "now" });
    svg.append(this.cursor);
    svg.addEventListener("click", (event) => {
      const share = (event.clientX - svg.getBoundingClientRect().left - LEFT) / (this.width - LEFT - 10);
      if (share >= 0) this.choose(share * this.lanes.length_s);
    });
    element("timeline").replaceChildren(svg);
    this.place();
  }

  scale(svg, height) {
    const wanted = this.lanes.length_s / Math.max(2, (this.width - LEFT) / 90);
    const step = [1, 2, 5, 10, 20, 60, 120, 300, 600, 1800, 3600].find((each) => each >= wanted) ?? 7200;
    for (let at_s = 0; at_s <= this.lanes.length_s; at_s += step) {
      svg.append(draw("path", { d: `M${this.x(at_s)} ${height - 18}v4`, class: "lane" }), draw("text", { x: this.x(at_s), y: height - 3, class: "tick" }, `${at_s} s`));
    }
  }

  place() {
    if (this.chosen_s === null || !this.cursor) return;
    mark(this.cursor, "d", `M${this.x(this.chosen_s).toFixed(1)} 0V${LANE_H * (LANES.length + 1)}`);
  }

  summary() {
    const counts = LANES.map(([kind, name]) => `${this.lanes.marks[kind].length} ${name}`).join(", ");
    return `Time line of ${this.lanes.length_s.toFixed(1)} s: ${this.lanes.trials.length} trials; marks: ${counts}. Listed below.`;
  }

  // The marks as a list: each has a button to its instant.
  list() {
    const all = LANES.flatMap(([kind]) => this.lanes.marks[kind].map((each) => ({ kind, ...each }))).sort((one, other) => one.at_s - other.at_s);
    element("marks").replaceChildren(...all.slice(0, MOST_LISTED).map((each) => {
      const item = create("li");
      const button = create("button", `${each.at_s.toFixed(3)} s`);
      button.type = "button";
      button.addEventListener("click", () => this.choose(each.at_s));
      item.append(button, create("span", ` ${each.level === "healthy" ? "" : `${each.level}: `}${spoken(each.kind, each)}`));
      return item;
    }));
    const more = all.length > MOST_LISTED ? `, of which it shows the first ${MOST_LISTED}` : "";
    write(element("marks-title"), `List of ${all.length} marks${more}`);
  }
}
