// SPDX-License-Identifier: Apache-2.0
// Positions of processes and topics: columns along the control chain, which begins and ends at the process with the
// sample clock. Pure.
const FIRST = "rig";
const ASIDE = ["experiment", "recorder", "dashboard"]; // they use nearly every topic, or may be absent

// A topic that goes to the experiment alone, as a participant's answers do, is no part of it. The recorder reads all.
const toAside = ({ readers }) => {
  const users = readers.filter(({ service }) => service !== "recorder");
  return users.length > 0 && users.every(({ service }) => ASIDE.includes(service));
};
const inChain = (topic) => topic.writers.length === 1 && !ASIDE.includes(topic.writers[0]) && !toAside(topic);

// Distance from the first process, counted in processes.
function layersOf(chain) {
  const layers = new Map([[FIRST, 0]]);
  for (let changed = true; changed;) {
    changed = false;
    for (const { writers: [writer], readers } of chain) {
      for (const { service } of readers) {
        if (!layers.has(writer) || layers.has(service) || ASIDE.includes(service)) continue;
        layers.set(service, layers.get(writer) + 1);
        changed = true;
      }
    }
  }
  return layers;
}

// A process that writes to another of its column follows directly after it.
function inOrder(services, chain) {
  const order = [...services];
  for (const { writers: [writer], readers } of chain) {
    const reader = readers.find(({ service }) => service !== writer && order.includes(service));
    if (!reader || !order.includes(writer)) continue;
    order.splice(order.indexOf(writer), 1);
    order.splice(order.indexOf(reader.service) + 1, 0, writer);
  }
  return order;
}

// Returns { columns, lastRow, nodes: [{ kind, name, column, row, again }], edges: [{ from, to, topic, writer, reader }],
// aside: [topic] } with column and row as numbers, the first row 0.
export function layOut(topics, services) {
  const chain = topics.filter(inChain);
  const layers = layersOf(chain);
  const members = (layer) => services.filter((name) => layers.get(name) === layer);
  const last = Math.max(...layers.values());
  const rows = Math.max(...Array.from({ length: last + 1 }, (_, layer) => members(layer).length));
  const rowOf = new Map();
  for (let layer = 0; layer <= last; ++layer) {
    const order = inOrder(members(layer), chain);
    const sources = chain.filter(({ readers }) => order.length === 1 && readers.some(({ service }) => service === order[0]))
      .map(({ writers: [writer] }) => writer).filter((writer) => rowOf.has(writer) && layers.get(writer) > 1);
    order.forEach((name, i) => rowOf.set(name, sources.length > 0 ? rowOf.get(sources[0]) : (rows - order.length) / 2 + i));
  }
  const nodes = [...layers.keys()].map((name) => ({ kind: "service", name, column: 2 * layers.get(name), row: rowOf.get(name) }));
  const columns = 2 * (last + 1) + 1;
  nodes.push({ kind: "service", name: FIRST, column: columns - 1, row: rowOf.get(FIRST), again: true });
  const edges = [];
  for (const [writer, layer] of layers) {
    const written = chain.filter(({ writers }) => writers[0] === writer);
    written.forEach(({ topic, readers }, i) => {
      const column = 2 * layer + 1;
      nodes.push({ kind: "topic", name: topic, column, row: rowOf.get(writer) + 0.75 * (i - (written.length - 1) / 2) });
      edges.push({ from: writer, to: topic, topic, writer });
      for (const { service } of readers) {
        if (layers.has(service)) edges.push({ from: topic, to: service, topic, reader: service, again: service === FIRST });
      }
    });
  }
  return { columns, lastRow: Math.max(...nodes.map(({ row }) => row)), nodes, edges, aside: topics.filter((topic) => !inChain(topic)).map(({ topic }) => topic) };
}
