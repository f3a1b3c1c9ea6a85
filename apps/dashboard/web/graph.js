// SPDX-License-Identifier: Apache-2.0
// The graph of processes and topics: which process is missing, which edge is late.
import { costInWords, costOf } from "/cost.js";
import { clock, create, draw, element, mark, short, write } from "/elements.js";
import { faultsOf, gone } from "/graph_faults.js";
import { layOut } from "/graph_layout.js";
import { alarmsOfNow, LEVELS } from "/status.js";

const PITCH_X = 134;
const PITCH_Y = 66;
const BOX = { service: { w: 116, h: 42 }, topic: { w: 88, h: 36 } };
const MARGIN = 14;
const RAIL_H = 58; // the first row of the rail
const RAIL_ROW_H = 50; // each further one
const MOST_IN_A_RAIL = 11;
const SIGNS = { healthy: "", warning: "!", critical: "✕" };
const railRows = (topics) => Math.ceil((topics.length + 2) / MOST_IN_A_RAIL);
const worse = (one, other) => (LEVELS.indexOf(one) > LEVELS.indexOf(other) ? one : other);

const worstOf = (faults) => faults.reduce((worst, { level }) => worse(worst, level), "healthy");

// A name of several words on two lines.
function lines(name) {
  const words = name.split("_");
  const half = Math.ceil(words.length / 2);
  return words.length === 1 ? [name] : [`${words.slice(0, half).join("_")}_`, words.slice(half).join("_")];
}

class Node {
  constructor({ kind, name, again }, x, y, { w, h } = BOX[kind]) {
    Object.assign(this, { kind, name, x, y, w, h });
    this.group = draw("g", { class: `node ${kind}`, transform: `translate(${x - w / 2} ${y - h / 2})` });
    this.group.append(draw("rect", { width: w, height: h, rx: kind === "service" ? 4 : h / 2 }));
    const label = kind === "service" ? [name] : lines(short(name));
    const top = kind === "service" ? 18 : h / 2 + (label.length === 1 ? 4 : -2);
    label.forEach((line, i) => this.group.append(draw("text", { x: w / 2, y: top + 12 * i, class: "name" }, line)));
    this.told = draw("text", { x: w / 2, y: 33, class: "told" });
    if (kind === "service") this.group.append(this.told);
    this.sign = draw("g", { class: "sign", transform: `translate(${w - 4} 3)` });
    this.glyph = draw("text", { y: 4.5 });
    this.sign.append(draw("circle", { r: 8.5 }), this.glyph);
    this.group.append(this.sign);
    if (again) mark(this.group, "data-again", "");
  }

  show(level, told = "") {
    mark(this.group, "data-level", level);
    write(this.glyph, SIGNS[level] ?? "");
    write(this.told, told);
  }
}

class Edge {
  constructor(from, to) {
    const [x1, x2] = [from.x + from.w / 2, to.x - to.w / 2 - 5];
    this.group = draw("g", { class: "edge" });
    const back = x2 < x1;
    const bend = Math.max(14, (x2 - x1) / 2);
    // Within a column backwards: out of the topic's upper side, into the process's right one.
    const path = back ? `M${from.x - from.w / 4} ${from.y - from.h / 2}C${from.x - from.w / 4} ${to.y + 14} ${to.x + to.w / 2 + 30} ${to.y + 12} ${to.x + to.w / 2 + 5} ${to.y + 12}`
      : `M${x1} ${from.y}C${x1 + bend} ${from.y} ${x2 - bend} ${to.y} ${x2} ${to.y}`;
    this.path = draw("path", { d: path, "marker-end": "url(#arrow)" });
    const middle = back ? { x: from.x - from.w / 4, y: (from.y + to.y) / 2 } : { x: (x1 + x2) / 2, y: (from.y + to.y) / 2 };
    this.label = draw("g", { class: "label", transform: `translate(${middle.x} ${middle.y})` });
    this.text = draw("text", { y: 3.5 });
    this.label.append(draw("rect", { x: -14, y: -8, width: 28, height: 16, rx: 3 }), this.text);
    this.group.append(this.path, this.label);
  }

  show(faults) {
    const active = faults.filter(({ active }) => active);
    const kind = active.length > 0 ? active[0].kind : faults.length > 0 ? "was" : "well";
    mark(this.group, "data-kind", kind);
    write(this.text, { unmatched: "✕", qos: "QoS", late: "late", missed: "late", lost: "lost" }[kind] ?? "");
  }
}

export class Graph {
  constructor() {
    this.made = "";
    this.faults = [];
  }

  make(graph, services) {
    const layout = layOut(graph.topics, services.map(({ service }) => service));
    const width = (layout.columns - 1) * PITCH_X + BOX.service.w + 2 * MARGIN;
    const chain = layout.lastRow * PITCH_Y + BOX.service.h + 2 * MARGIN;
    const x = (column) => MARGIN + BOX.service.w / 2 + column * PITCH_X;
    const y = (row) => MARGIN + BOX.service.h / 2 + row * PITCH_Y;
    const svg = draw("svg", { viewBox: `0 0 ${width} ${chain + RAIL_H + RAIL_ROW_H * (railRows(layout.aside) - 1)}`, role: "img", "aria-label": "Graph" });
    const arrow = draw("marker", { id: "arrow", viewBox: "0 0 8 8", refX: 4, refY: 4, markerWidth: 7, markerHeight: 7, markerUnits: "userSpaceOnUse", orient: "auto" });
    arrow.append(draw("path", { d: "M0 0L8 4L0 8z", class: "head" }));
    const defs = draw("defs");
    defs.append(arrow);
    this.nodes = layout.nodes.map((node) => new Node(node, x(node.column), y(node.row)));
    const find = (name, again) => this.nodes[layout.nodes.findIndex((node) => node.name === name && Boolean(node.again) === Boolean(again))];
    this.edges = layout.edges.map((edge) => ({ ...edge, drawn: new Edge(find(edge.from), find(edge.to, edge.again)) }));
    const rail = this.rail(layout.aside, chain, width);
    svg.append(defs, rail, ...this.edges.map(({ drawn }) => drawn.group), ...this.nodes.map(({ group }) => group));
    element("graph").replaceChildren(svg);
    this.svg = svg;
  }

  // Topics that nearly every process writes or reads, and experiment and recorder: a line that connects all.
  rail(topics, top, width) {
    const group = draw("g", { class: "rail" });
    const rows = railRows(topics);
    const y = (row) => top + 26 + RAIL_ROW_H * row;
    for (let row = 0; row < rows; ++row) group.append(draw("path", { d: `M${MARGIN} ${y(row)}H${width - MARGIN}` }));
    group.append(draw("text", { x: MARGIN, y: top - 2, class: "told start" }, "to and from all processes"));
    const space = { w: 92, h: 36 };
    const names = ["experiment", ...topics, "recorder"];
    const first = MARGIN + space.w / 2;
    const inRow = Math.ceil(names.length / rows);
    const pitch = (width - 2 * first) / (inRow - 1);
    names.forEach((name, i) => {
      const kind = i === 0 || i === names.length - 1 ? "service" : "topic";
      const size = { w: Math.min(kind === "service" ? 96 : 90, pitch - 4), h: kind === "service" ? BOX.service.h : space.h };
      const node = new Node({ kind, name }, first + (i % inRow) * pitch, y(Math.floor(i / inRow)), size);
      this.nodes.push(node);
      group.append(node.group);
    });
    return group;
  }

  show(snapshot) {
    const { services, graph } = snapshot;
    this.cost = snapshot.cost;
    costInWords(this.cost).forEach((words, i) => write(element("cost").children[i], words));
    if (graph) {
      const made = JSON.stringify(graph.topics.map(({ topic }) => topic));
      this.graph = graph;
      if (made !== this.made) this.make(graph, services);
      this.made = made;
      this.faults = faultsOf(snapshot);
      this.list();
    }
    if (!this.graph) return;
    this.mark(snapshot);
  }

  mark(snapshot) {
    const { services, session } = snapshot;
    const going = session.state !== "none" && session.state !== "ending";
    const levels = new Map();
    for (const { subject, level, acknowledged } of alarmsOfNow(snapshot)) {
      if (!acknowledged) levels.set(subject, worse(level, levels.get(subject) ?? "healthy"));
    }
    const missing = [];
    for (const node of this.nodes) {
      if (node.kind === "service") {
        const service = services.find(({ service: name }) => name === node.name) ?? {};
        const away = gone(service);
        if (away && going) missing.push(node.name);
        const touched = this.faults.filter(({ reader, active }) => active && reader === node.name);
        const edges = new Set(touched.map(({ topic }) => topic)).size;
        const told = service.state === undefined ? "missing" : away ? `silent ${(service.silent_ms / 1000).toFixed(1)} s` : edges > 0 ? `${edges} connection${edges === 1 ? "" : "s"} at fault` : service.state;
        const level = (away && going) || service.state === "fault" ? "critical" : worstOf(touched);
        node.show(away && !going ? "none" : worse(level, levels.get(node.name) ?? "healthy"), told);
      } else {
        const touched = this.faults.filter(({ topic, active }) => active && topic === node.name);
        node.show(worse(worstOf(touched), levels.get(node.name) ?? "healthy"));
      }
    }
    for (const edge of this.edges) {
      edge.drawn.show(this.faults.filter((fault) => fault.topic === edge.topic && (edge.reader ? fault.reader === edge.reader : fault.reader === "")));
    }
    const active = this.faults.filter(({ active: now }) => now).length;
    const absent = missing.length > 0 ? `missing: ${missing.join(", ")}` : "no process is missing";
    mark(this.svg, "aria-label", `Processes and topics along the control chain. ${going ? absent : "no session runs"}; ${active === 0 ? "no connection is at fault now" : `${active} fault${active === 1 ? "" : "s"} of connections now, listed below`}`);
  }

  // On the way of the motor's force, at the process that keeps the next one waiting.
  costAt({ writer, reader }) {
    return { cancellation: "sensing", rig: "cancellation" }[reader] === writer ? costOf(this.cost, writer) : "";
  }

  // The same as a table; what costs force comes first behind what is critical, once for each connection.
  list() {
    const paid = new Set();
    const costs = new Map(this.faults.map((fault) => {
      const cost = paid.has(fault.topic) ? "" : this.costAt(fault);
      if (cost !== "") paid.add(fault.topic);
      return [fault, cost];
    }));
    const rank = (fault) => (fault.level === "critical" ? 0 : costs.get(fault) !== "" ? 1 : 2);
    const rows = [...this.faults].sort((one, other) => rank(one) - rank(other)).map((fault) => {
      const row = create("tr");
      if (!fault.active) row.className = "faint";
      const edge = [fault.writer, short(fault.topic), fault.reader].filter((part) => part !== "").join(" → ");
      const head = create("th", edge);
      head.scope = "row";
      const since = fault.since_ms ? clock(fault.since_ms) : fault.kind === "unmatched" ? "" : "before this page opened";
      row.append(head, create("td", fault.active ? "now" : "was", fault.active ? "l bad" : "l"), create("td", fault.text, "l"), create("td", costs.get(fault), "l"), create("td", since),
        create("td", fault.last_ms ? clock(fault.last_ms) : "–"));
      return row;
    });
    element("faults-none").hidden = rows.length > 0;
    element("faults-table").hidden = rows.length === 0;
    element("faults").replaceChildren(...rows);
  }
}
