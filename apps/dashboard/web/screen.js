// SPDX-License-Identifier: Apache-2.0
// The tracking screen to scale, 0.2 s behind the screen of the subject.
import { draw, element, mark } from "/elements.js";

const BEHIND_TICKS = 200; // rows come ten times a second, five at once
const DESCRIBED_MS = 2000;

export class TrackingScreen {
  constructor() {
    this.rows = [];
    this.at = null; // [ticks] shown
    this.still = matchMedia("(prefers-reduced-motion: reduce)");
    this.describedAt = -Infinity;
  }

  make({ width_m: width, height_m: height, line_width_m: line, cross_width_m: cross, track_above_bottom_m: track, box_width_m: box }) {
    this.half_m = box / 2;
    const svg = draw("svg", { viewBox: `${-width / 2} ${-height / 2} ${width} ${height}`, role: "img", "aria-label": "Tracking screen" });
    const y = height / 2 - track;
    this.box = draw("rect", { x: -box / 2, y: y - box / 2, width: box, height: box });
    this.cross = draw("path", { d: `M${-cross / 2} ${y}h${cross}M0 ${y - cross / 2}v${cross}` });
    const lines = draw("g", { fill: "none", stroke: "#fff", "stroke-width": line });
    lines.append(this.box, this.cross);
    svg.append(draw("rect", { x: -width / 2, y: -height / 2, width, height, fill: "#000" }), lines);
    element("screen").replaceChildren(svg);
    this.svg = svg;
    const turn = (now) => { this.turn(now); requestAnimationFrame(turn); };
    requestAnimationFrame(turn);
  }

  // rows: of the traces, by tick
  show(snapshot, rows, past) {
    if (!snapshot.screen) return;
    if (!this.svg) this.make(snapshot.screen);
    this.rows = rows.filter((row) => row.target_m !== null && row.cursor_m !== null).slice(-50);
    if (past || this.still.matches) this.at = this.rows.at(-1)?.tick ?? null;
    this.past = past;
    if (this.rows.length === 0) this.place(0, 0);
  }

  turn(now) {
    const newest = this.rows.at(-1);
    if (newest === undefined) return;
    const passed = Math.min(now - (this.turnedAt ?? now), 100);
    this.turnedAt = now;
    if (!this.past && !this.still.matches) {
      const due = newest.tick - BEHIND_TICKS;
      // Advances with the clock while that stays close to the newest rows.
      this.at = this.at === null || Math.abs(this.at - due) > 1.5 * BEHIND_TICKS ? due : this.at + passed + 0.02 * (due - this.at);
    }
    const behind = this.rows.findIndex((row) => row.tick >= this.at);
    const next = this.rows[behind < 0 ? this.rows.length - 1 : behind];
    const before = this.rows[Math.max(0, (behind < 0 ? this.rows.length : behind) - 1)];
    const share = next.tick > before.tick ? Math.min(Math.max((this.at - before.tick) / (next.tick - before.tick), 0), 1) : 1;
    this.place(before.target_m + share * (next.target_m - before.target_m), before.cursor_m + share * (next.cursor_m - before.cursor_m));
  }

  place(target, cursor) {
    mark(this.box, "transform", `translate(${target.toFixed(5)} 0)`);
    mark(this.cross, "transform", `translate(${cursor.toFixed(5)} 0)`);
    if (performance.now() - this.describedAt < DESCRIBED_MS) return;
    this.describedAt = performance.now();
    const mm = (value) => `${(1000 * value).toFixed(0)} mm`;
    const inside = Math.abs(target - cursor) < this.half_m ? "inside" : "outside";
    mark(this.svg, "aria-label", `Tracking screen: target at ${mm(target)}, cursor at ${mm(cursor)}, ${inside} the box`);
  }
}
