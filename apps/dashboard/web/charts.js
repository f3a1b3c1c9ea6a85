// SPDX-License-Identifier: Apache-2.0
// The newest ten seconds of what moves.
import uPlot from "/uPlot.esm.js";

const KEPT_S = 10;
const HEIGHT = 150;
const FIGURES = [
  { title: "Acceleration [m/s²]", series: [{ name: "accel_y_m_s2", key: "platform, right" }], least: 1 },
  { title: "Force of the hand [N]", series: [{ name: "force_n", key: "measured" }, { name: "predicted_force_n", key: "predicted by the model" }], least: 1 },
  { title: "Motor force [N]", series: [{ name: "motor_force_n", key: "on the stick" }], limits: true, least: 1 },
  { title: "Screen [m]", series: [{ name: "target_m", key: "target" }, { name: "cursor_m", key: "cursor" }], least: 0.05 },
];

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function caption(figure, limit) {
  const node = document.createElement("figcaption");
  const title = document.createElement("b");
  title.textContent = figure.title;
  node.append(title);
  figure.series.forEach(({ key }, i) => {
    const part = document.createElement("span");
    part.className = i === 0 ? "key" : "key second";
    part.textContent = key;
    node.append(part);
  });
  if (figure.limits) {
    const part = document.createElement("span");
    part.className = "key limit";
    part.textContent = `limits ±${limit} N`;
    node.append(part);
  }
  const note = document.createElement("span");
  note.className = "note";
  node.append(note);
  return { node, note };
}

class Chart {
  constructor(parent, figure, limit) {
    this.figure = figure;
    this.limit = limit;
    this.box = document.createElement("figure");
    this.plot = null;
    const { node, note } = caption(figure, limit);
    this.note = note;
    this.place = document.createElement("div");
    this.place.setAttribute("role", "img");
    this.place.setAttribute("aria-label", `${figure.title}, newest ${KEPT_S} seconds`);
    this.box.append(node, this.place);
    parent.append(this.box);
    new ResizeObserver(() => this.plot?.setSize({ width: this.place.clientWidth, height: HEIGHT })).observe(this.place);
  }

  // Anew whenever the colours change.
  draw(data) {
    this.plot?.destroy();
    const axis = { stroke: colour("--faint"), grid: { stroke: colour("--rule"), width: 1 }, ticks: { stroke: colour("--rule") }, font: "12px sans-serif" };
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
      axes: [{ ...axis, size: 28, values: (_, ticks) => ticks.map((s) => `${s}`) }, { ...axis, size: 46 }],
      series: [{}, ...lines],
    }, data, this.place);
  }

  show(traces, hidden) {
    const columns = this.figure.series.map(({ name }) => traces[name]);
    if (this.figure.limits) columns.push(traces.tick.map(() => this.limit), traces.tick.map(() => -this.limit));
    const data = [traces.tick.map((tick) => tick / 1000), ...columns];
    const note = hidden && this.figure.limits ? "hidden while a person tracks (blinded)" : "";
    if (this.note.textContent !== note) this.note.textContent = note;
    if (this.plot) this.plot.setData(data); else this.draw(data);
  }
}

export class Charts {
  constructor(parent) {
    this.parent = parent;
    this.charts = [];
    this.traces = null;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      for (const chart of this.charts) { chart.plot?.destroy(); chart.plot = null; }
    });
  }

  add({ traces, limits, session }) {
    if (this.charts.length === 0) this.charts = FIGURES.map((figure) => new Chart(this.parent, figure, limits.motor_force_n));
    const newest = this.traces?.tick.at(-1) ?? -1;
    // Ticks that go back are another session.
    if (!this.traces || (traces.tick.length > 0 && traces.tick.at(-1) < newest)) {
      this.traces = traces;
    } else {
      const first = traces.tick.findIndex((tick) => tick > newest);
      if (first < 0) return;
      for (const name of Object.keys(this.traces)) this.traces[name].push(...traces[name].slice(first));
    }
    const oldest = (this.traces.tick.at(-1) ?? 0) - 1000 * KEPT_S;
    const gone = this.traces.tick.findIndex((tick) => tick >= oldest);
    if (gone > 0) for (const name of Object.keys(this.traces)) this.traces[name].splice(0, gone);
    const hidden = session.blinded && session.phase === "tracking";
    for (const chart of this.charts) chart.show(this.traces, hidden);
  }
}
