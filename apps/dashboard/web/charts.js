// SPDX-License-Identifier: Apache-2.0
// Traces of the newest ten seconds.
import uPlot from "/uPlot.esm.js";
import { create, mark, write } from "/elements.js";

const KEPT_S = 10;
const HEIGHT = 118;
const STEP_TICKS = 20; // between two rows of the dashboard
const DESCRIBED_MS = 2000;
const FIGURES = [
  { title: "Acceleration [m/s²]", series: [{ name: "accel_y_m_s2", key: "platform, positive to the right" }], least: 1 },
  { title: "Force of the hand [N]", series: [{ name: "force_n", key: "measured" }, { name: "predicted_force_n", key: "predicted by the model" }], least: 1, blinds: true },
  { title: "Residual [N]", series: [{ name: "residual_n", key: "measured − predicted" }], least: 1, blinds: true },
  { title: "Motor force [N]", series: [{ name: "motor_force_n", key: "on the stick" }], limits: true, least: 1, blinds: true },
  { title: "Screen [mm]", series: [{ name: "target_mm", key: "target" }, { name: "cursor_mm", key: "cursor" }], least: 50 },
];

export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// A figure: a caption with a key for each line, and a place for the plot with a description for screen readers.
export function figureOf(parent, title, keys, about) {
  const box = create("figure");
  const caption = create("figcaption");
  caption.append(create("b", title), ...keys.map(({ key, look }) => create("span", key, `key ${look}`)));
  const note = create("span", "", "note");
  caption.append(note);
  const place = create("div");
  place.setAttribute("role", "img");
  place.setAttribute("aria-label", about);
  box.append(caption, place);
  parent.append(box);
  return { place, note };
}

export function axisOf(more = {}) {
  return { stroke: colour("--faint"), grid: { stroke: colour("--rule"), width: 1 }, ticks: { stroke: colour("--rule") }, font: "12px sans-serif", ...more };
}

class Chart {
  constructor(parent, figure, limit) {
    this.figure = figure;
    this.limit = limit;
    this.plot = null;
    this.describedAt = -Infinity;
    const keys = figure.series.map(({ key }, i) => ({ key, look: i === 0 ? "" : "second" }));
    if (figure.limits) keys.push({ key: `limits ±${limit} N`, look: "limit" });
    Object.assign(this, figureOf(parent, figure.title, keys, `${figure.title}, newest ${KEPT_S} seconds`));
    new ResizeObserver(() => this.plot?.setSize({ width: this.place.clientWidth, height: HEIGHT })).observe(this.place);
  }

  // Called again whenever the colours change.
  draw(columns) {
    this.plot?.destroy();
    const lines = this.figure.series.map((_, i) => ({ stroke: colour(`--line-${i + 1}`), width: 1.75, dash: i === 0 ? undefined : [6, 4], points: { show: false } }));
    if (this.figure.limits) {
      for (let i = 0; i < 2; ++i) lines.push({ stroke: colour("--limit"), width: 1.5, dash: [2, 4], points: { show: false } });
    }
    const least = this.figure.limits ? 1.1 * this.limit : this.figure.least;
    this.plot = new uPlot({
      width: Math.max(this.place.clientWidth, 100), height: HEIGHT, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, range: (_, min, max) => [Math.min(min, max - KEPT_S), max] },
        y: { range: (_, min, max) => {
          const most = Math.max(least, Math.abs(min ?? 0), Math.abs(max ?? 0));
          return [-1.05 * most, 1.05 * most];
        } } },
      axes: [axisOf({ size: 28, values: (_, ticks) => ticks.map((s) => `${s}`) }), axisOf({ size: 46, space: 24 })],
      series: [{}, ...lines],
    }, columns, this.place);
  }

  show(rows, hidden) {
    const columns = [[], ...this.figure.series.map(() => []), ...(this.figure.limits ? [[], []] : [])];
    const add = (tick, values) => {
      columns[0].push(tick / 1000);
      values.forEach((value, i) => columns[i + 1].push(value));
      if (this.figure.limits) {
        columns.at(-2).push(this.limit);
        columns.at(-1).push(-this.limit);
      }
    };
    let last = null;
    for (const row of rows) {
      // A gap in the ticks is a gap in the line.
      if (last !== null && row.tick - last > 2 * STEP_TICKS) add(last + STEP_TICKS, this.figure.series.map(() => null));
      add(row.tick, this.figure.series.map(({ name }) => row[name]));
      last = row.tick;
    }
    write(this.note, hidden && this.figure.blinds ? "hidden while a person tracks; --unblinded shows it" : "");
    this.describe(columns);
    if (this.plot) this.plot.setData(columns); else this.draw(columns);
  }

  describe(columns) {
    if (performance.now() - this.describedAt < DESCRIBED_MS) return;
    this.describedAt = performance.now();
    const parts = this.figure.series.map(({ key }, i) => {
      const values = columns[i + 1].filter((value) => value !== null);
      if (values.length === 0) return `${key}: no samples`;
      return `${key}: now ${values.at(-1).toFixed(2)}, from ${Math.min(...values).toFixed(2)} to ${Math.max(...values).toFixed(2)}`;
    });
    mark(this.place, "aria-label", `${this.figure.title}, newest ${KEPT_S} seconds. ${parts.join("; ")}`);
  }
}

const mm = (value) => (value === null ? null : 1000 * value);

function rowsOf(traces) {
  const names = Object.keys(traces);
  return traces.tick.map((_, i) => {
    const row = Object.fromEntries(names.map((name) => [name, traces[name][i]]));
    row.residual_n = row.force_n === null || row.predicted_force_n === null ? null : row.force_n - row.predicted_force_n;
    row.target_mm = mm(row.target_m);
    row.cursor_mm = mm(row.cursor_m);
    return row;
  });
}

export class Charts {
  constructor(parent) {
    this.parent = parent;
    this.charts = [];
    this.rows = [];
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      for (const chart of this.charts) { chart.plot?.destroy(); chart.plot = null; }
      this.drawn();
    });
  }

  // Adds new rows; `whole`: the rows before belong to another instant and are dropped.
  add({ traces, limits, session }, whole) {
    if (this.charts.length === 0) this.charts = FIGURES.map((figure) => new Chart(this.parent, figure, limits.motor_force_n));
    this.hidden = session.blinded && (session.phase ?? "tracking") === "tracking";
    if (whole) this.rows = [];
    const arrived = rowsOf(traces);
    if (arrived.length > 0) this.join(arrived);
    if (arrived.length > 0 || whole) this.drawn();
  }

  join(arrived) {
    // Ticks that jump far back belong to another session.
    if (arrived.at(-1).tick < (this.rows.at(-1)?.tick ?? -1) - 1000 * KEPT_S) this.rows = [];
    if (arrived[0].tick > (this.rows.at(-1)?.tick ?? -1)) {
      this.rows.push(...arrived);
    } else {
      const byTick = new Map([...this.rows, ...arrived].map((row) => [row.tick, row]));
      this.rows = [...byTick.values()].sort((one, other) => one.tick - other.tick);
    }
    const oldest = this.rows.at(-1).tick - 1000 * KEPT_S;
    this.rows = this.rows.filter((row) => row.tick >= oldest);
  }

  drawn() {
    for (const chart of this.charts) chart.show(this.rows, this.hidden);
  }
}
