// SPDX-License-Identifier: Apache-2.0
// Faults of the graph, from the counts that each process reports. Pure.
const RECENT_MS = 5000;
const GONE_MS = 300; // lease of a life sign
const GOING = ["waiting", "running", "paused"];

// "peer (topic), peer (topic)"; the last name may be cut off.
function missing(text) {
  return [...text.matchAll(/(\w+) \(([^),]+)\)/g)].map(([, peer, topic]) => ({ peer, topic }));
}

function unmatched({ services, graph }) {
  const rows = new Map(graph.topics.map((row) => [row.topic, row]));
  const found = new Map();
  for (const { service, waits_for: text = "" } of services) {
    for (const { peer, topic } of missing(text)) {
      const row = rows.get(topic);
      if (!row) continue;
      // Both ends may report it: it is one edge.
      const writes = row.writers.includes(service) && row.readers.some((reader) => reader.service === peer);
      const [writer, reader] = writes ? [service, peer] : [peer, service];
      found.set(`${writer}>${topic}>${reader}`, { kind: "unmatched", topic, writer, reader, level: "critical", active: true, text: "not matched" });
    }
  }
  return [...found.values()];
}

const times = (count, what) => `${count} ${what}${count === 1 ? "" : "s"}`;

function trouble({ topic, writers }, reader, now) {
  const found = [];
  const { service, late, missed, lost } = reader;
  const writer = writers.length === 1 ? writers[0] : "";
  const add = (kind, level, growth, text) => {
    const active = growth.last_ms !== null && now - growth.last_ms < RECENT_MS;
    found.push({ kind, topic, writer, reader: service, level, active, text, since_ms: growth.first_ms, last_ms: growth.last_ms });
  };
  const longest = `longest interval ${(reader.worst_interval_us / 1000).toFixed(1)} ms`;
  if (reader.lost_ticks > 0) add("lost", "warning", lost, `lost ${times(reader.lost_ticks, "tick")}`);
  if (reader.deadline_misses > 0) add("missed", "warning", missed, `${times(reader.deadline_misses, "deadline")} missed, ${longest}`);
  // The loop tolerates late cycles: they are listed without a warning.
  if (reader.cycle_misses > 0) add("late", "healthy", late, `${times(reader.cycle_misses, "cycle")} late, ${longest}`);
  return found;
}

// True without a life sign within the lease.
export function gone(service) {
  return service.state === undefined || service.silent_ms > GONE_MS;
}

// Faults of edges, the most severe first: { kind, topic, writer, reader, level, active, text, since_ms, last_ms }.
export function faultsOf(snapshot) {
  const { graph, session, services, now_ms: now } = snapshot;
  const found = [];
  for (const { service, topic, policy, since_ms } of graph.qos_mismatches) {
    const row = graph.topics.find((each) => each.topic === topic);
    const writes = row?.writers.includes(service) && !row.readers.some((reader) => reader.service === service);
    found.push({ kind: "qos", topic, writer: writes ? service : "", reader: writes ? "" : service, level: "critical", active: true, text: `QoS mismatch: ${policy}`, since_ms });
  }
  if (GOING.includes(session.state)) found.push(...unmatched({ services, graph }));
  for (const topic of graph.topics) {
    for (const reader of topic.readers) {
      if (reader.samples !== undefined) found.push(...trouble(topic, reader, now));
    }
  }
  const rank = (fault) => (fault.level === "critical" ? 0 : !fault.active ? 3 : fault.level === "warning" ? 1 : 2);
  return found.map((fault, i) => ({ fault, i })).sort((one, other) => rank(one.fault) - rank(other.fault) || one.i - other.i).map(({ fault }) => fault);
}
