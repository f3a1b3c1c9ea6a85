// SPDX-License-Identifier: Apache-2.0
// Tables, which are read from close by.
import { costOfAlarm } from "/cost.js";
import { clock, create, element, short, write } from "/elements.js";
import { what } from "/status.js";

function us(value) {
  if (value >= 100000) return `${(value / 1000).toFixed(0)}k`;
  return value >= 100 || value === 0 ? value.toFixed(0) : value.toFixed(value < 10 ? 1 : 0);
}

function spread(times) {
  if (times.count === 0) return "–";
  return `${us(times.p50_us)} / ${us(times.p99_us)} / ${us(times.p999_us)} / ${us(times.max_us)}`;
}

function minutes(seconds) {
  const whole = Math.ceil(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

function late(lateness) {
  return lateness.count === 0 ? "0" : `${lateness.count} · ${(lateness.worst_us / 1000).toFixed(3)}`;
}

function share(part) {
  return part === undefined || part === null ? "–" : `${(100 * part).toFixed(part < 0.1 ? 1 : 0)} %`;
}

function memory({ resident_mb: mb, memory_locked: locked }) {
  return mb === undefined ? "–" : `${mb.toFixed(0)}${locked ? ", locked" : ""}`;
}

// Rows are kept: only cells whose text changes are written.
class Table {
  constructor(id, heads) {
    const table = element(id);
    const row = create("tr");
    for (const head of heads) {
      const cell = create("th", head.text ?? head, head.left ? "l" : "");
      cell.scope = "col";
      if (head.title) cell.title = head.title;
      row.append(cell);
    }
    const part = create("thead");
    part.append(row);
    this.body = create("tbody");
    table.append(part, this.body);
    this.rows = new Map();
  }

  // Removes all other rows.
  keep(names) {
    for (const [name, row] of this.rows) {
      if (names.includes(name)) continue;
      row.remove();
      this.rows.delete(name);
    }
  }

  show(name, cells) {
    if (!this.rows.has(name)) {
      const row = create("tr");
      const head = create("th", name);
      head.scope = "row";
      row.append(head, ...cells.map(() => create("td")));
      this.rows.set(name, row);
      this.body.append(row);
    }
    const row = this.rows.get(name);
    cells.forEach((cell, i) => {
      const node = row.children[i + 1];
      if (cell instanceof Node) {
        node.replaceChildren(cell);
      } else {
        const { text, look = "" } = typeof cell === "object" ? cell : { text: cell };
        write(node, String(text));
        if (node.className !== look) node.className = look;
      }
    });
  }
}

// Jitter since the start, three bars for each decade; the height is logarithmic.
function bars(topic, edges) {
  const upTo = topic.jitter_counts;
  const counts = upTo.map((count, i) => count - (i === 0 ? 0 : upTo[i - 1]));
  counts.push(topic.jitter.count - (upTo.at(-1) ?? 0));
  const most = Math.log10(1 + Math.max(...counts, 1));
  const node = create("span", undefined, "bars");
  node.setAttribute("role", "img");
  node.setAttribute("aria-label", counts.map((count, i) =>
    `${i < edges.length ? `up to ${edges[i]}` : `above ${edges.at(-1)}`} µs: ${count}`).join(", "));
  counts.forEach((count, i) => {
    const bar = create("i", undefined, i < edges.length && edges[i] <= 1000 ? "" : "late");
    bar.style.height = `${(100 * Math.log10(1 + count)) / most}%`;
    node.append(bar);
  });
  return node;
}

export class Tables {
  constructor() {
    this.topics = new Table("topics", ["topic", { text: "rate [Hz]" }, "jitter", { text: "histogram", title: "jitter since the start, from 10 µs to above 10 ms; heights are logarithmic" },
      "latency", "samples", { text: "lost", title: "missing samples, by sequence number and tick" },
      { text: "sent late [ms]", title: "intervals between the writer's stamps that exceed the deadline: their number and the largest excess" },
      { text: "arrived late [ms]", title: "the same, for the intervals between the arrivals here" }, "since"]);
    this.chain = new Table("chain", ["up to", "p50", "p99", "p99.9", "max", "samples"]);
    this.services = new Table("services", ["process", { text: "state", left: true }, "last seen",
      { text: "real time", title: "whether the process has a real-time scheduling policy, and its priority" },
      { text: "CPU", title: "share of one core that the process used in the last second" }, { text: "memory [MB]", title: "resident memory; locked: no page of it can be swapped out" }, "pid",
      { text: "DDS misses", title: "deadlines that DDS reported as missed to its readers, in whole milliseconds" },
      { text: "cycle misses", title: "late cycles by the process's own supervision, in microseconds" }, "lost ticks", { text: "waits for", left: true }]);
    this.rigs = new Table("rigs", ["rig", { text: "level", left: true }, { text: "session", left: true }, { text: "worst", left: true }, "samples", "lost"]);
    this.edges = new Table("edges", ["connection", "matched", "samples", "lost ticks", { text: "cycle misses", title: "late cycles by the reader's own supervision, in microseconds" },
      { text: "DDS misses", title: "deadlines that DDS reported as missed, in whole milliseconds" }, "longest interval [ms]", { text: "latency p99 [µs]", title: "from stamp to arrival, corrected for the offset of the clocks" }]);
    element("edges-part").addEventListener("toggle", () => this.graph && this.showEdges(this.graph));
    this.hosts = new Table("hosts", [{ text: "host" }, { text: "processes", left: true }, { text: "CPU", title: "of all its cores" }, "cores", "clock [µs]", "± [µs]"]);
    this.recorders = new Table("recorders", ["recorder", { text: "state", left: true }, { text: "file", left: true }, "received", "lost", "written", "dropped", "file [MB]", "free [GB]", { text: "its last answer", left: true }]);
    this.clocks = new Table("clocks", ["process", "offset [µs]", "± [µs]", "drift [ppm]", "steps"]);
  }

  show(snapshot) {
    this.showProtocol(snapshot.session);
    this.showSession(snapshot);
    this.showAlarms(snapshot);
    for (const topic of snapshot.topics) this.showTopic(topic, snapshot);
    const { sensed, command, motor } = snapshot.chain;
    for (const [name, times] of [["sensed", sensed], ["motor command", command], ["first use by the rig", motor]]) {
      this.chain.show(name, times.count === 0 ? ["–", "–", "–", "–", 0]
        : [us(times.p50_us), us(times.p99_us), us(times.p999_us), us(times.max_us), times.count]);
    }
    for (const service of snapshot.services) this.showService(service);
    this.showRigs(snapshot.rigs ?? [], snapshot.rig);
    if (snapshot.graph) this.graph = snapshot.graph;
    if (this.graph && element("edges-part").open) this.showEdges(this.graph);
    this.showHosts(snapshot.hosts ?? []);
    this.showRecorders(snapshot.recorders ?? []);
    for (const clockOf of snapshot.clocks) {
      this.clocks.show(clockOf.service, clockOf.same_clock ? [{ text: "same clock", look: "faint" }, "0", "0", clockOf.steps]
        : [clockOf.offset_us.toFixed(1), clockOf.uncertainty_us?.toFixed(1) ?? "–", clockOf.drift_ppm?.toFixed(2) ?? "–", clockOf.steps]);
    }
    this.showEvents(snapshot.events);
    const own = snapshot.dashboard;
    const trouble = own.trouble.length > 0 ? ` · ${own.trouble.join("; ")}` : "";
    write(element("own"), `This dashboard: ${(100 * own.cpu_share).toFixed(1)} % of one core, ${own.clients} client${own.clients === 1 ? "" : "s"}, ` +
      `${own.dropped} messages dropped, ${own.malformed} malformed${trouble}`);
  }

  // Participant, place in the protocol, and what the session waits for; read by the experimenter from the stick.
  showProtocol({ protocol, state }) {
    const node = element("protocol");
    const there = state !== "none" && protocol !== null && protocol !== undefined && (protocol.participant !== "" || protocol.trials > 0);
    node.hidden = !there;
    if (!there) return;
    const place = (name, at, all) => (at > 0 ? `${name} ${at}${all > 0 ? ` of ${all}` : ""}` : "");
    const left = protocol.left_s === null ? "" : ` ${minutes(protocol.left_s)}`;
    const asks = protocol.kind === "question" ? "waits for the participant's answer" : "waits for the participant to go on";
    const timed = (word, then) => (left === "" ? word : word + then);
    const waits = { start: "waits for Start", participant: asks, break: timed("break", ", next one in"), rest: timed("rest", ", begins in"), trial: timed("runs", ", left") }[protocol.waits_for] ?? "";
    const step = protocol.kind === "practice" ? place("practice", protocol.trial, protocol.trials)
      : protocol.kind === "identification" || protocol.kind === "instructions" || protocol.kind === "end" ? protocol.kind : place("trial", protocol.trial, protocol.trials);
    const parts = [protocol.participant, place("block", protocol.block, protocol.blocks), step, state === "ending" ? "over" : waits + left];
    const texts = parts.filter((part) => part !== "");
    while (node.children.length > texts.length) node.lastChild.remove();
    texts.forEach((text, i) => {
      if (!node.children[i]) node.append(create("span"));
      write(node.children[i], text);
    });
  }

  showSession({ session, mode, domain, rig, file, now_ms: now }) {
    const parts = [["state", session.state], [mode === "live" ? "domain" : "recording", mode === "live" ? domain : file], ["rig", rig]];
    if (session.trial !== undefined && session.trial >= 0) {
      const at = (session.tick - session.start_tick) / 1000;
      parts.push(["trial", session.trial], ["phase", session.phase],
        ["measured", `${Math.min(Math.max(at, 0), session.duration_ticks / 1000).toFixed(0)} of ${(session.duration_ticks / 1000).toFixed(0)} s`]);
    }
    if (session.engaging) parts.push(["platform", "engages: it moves slowly to its place"]);
    parts.push(["condition", session.condition ?? (session.blinded ? "hidden; --unblinded shows it" : "–")]);
    if (session.rig_parts) parts.push(["rig of devices", session.rig_parts]);
    if (session.replayed) parts.push(["replay", "a recording is played on this domain"]);
    parts.push([mode === "live" ? "now" : "instant", clock(now)]);
    const list = element("session");
    while (list.children.length > parts.length) list.lastChild.remove();
    parts.forEach(([name, value], i) => {
      if (!list.children[i]) {
        const part = create("div");
        part.append(create("dt"), create("dd"));
        list.append(part);
      }
      write(list.children[i].children[0], name);
      write(list.children[i].children[1], String(value));
    });
  }

  showAlarms({ alarms, cost }) {
    const items = alarms.map((alarm) => {
      const item = create("li");
      item.dataset.level = alarm.level;
      item.append(create("b", alarm.level), create("span", what(alarm)));
      if (alarm.count > 1) item.append(create("span", `${alarm.count} times`, "faint"));
      const paid = costOfAlarm(cost, alarm);
      if (paid !== "") item.append(create("b", paid, "cost"));
      if (!alarm.active) item.append(create("span", "ended", "faint"));
      if (alarm.acknowledged && alarm.watch !== "qos") item.append(create("span", "acknowledged", "faint"));
      item.append(create("time", clock(alarm.since_ms)));
      return item;
    });
    if (items.length === 0) items.push(create("li", "none"));
    element("alarms").replaceChildren(...items);
  }

  showTopic(topic, snapshot) {
    const firsts = [topic.lost_since_ms, topic.sent_late.first_ms, topic.arrived_late.first_ms].filter((ms) => ms !== null);
    const slow = snapshot.session.state === "running" && topic.expected_hz >= 1000 && topic.rate_hz < 0.99 * topic.expected_hz;
    const periodic = topic.expected_hz > 0;
    this.topics.show(short(topic.topic), [
      { text: periodic || topic.rate_hz > 0 ? topic.rate_hz.toFixed(0) : "–", look: slow ? "bad" : "" },
      periodic ? spread(topic.recent_jitter) : "–",
      periodic && topic.jitter.count > 0 ? bars(topic, snapshot.jitter_edges_us) : "–",
      spread(topic.recent_latency), topic.samples,
      { text: topic.lost, look: topic.lost > 0 ? "bad" : "" },
      topic.deadline_us === 0 ? "–" : { text: late(topic.sent_late), look: topic.sent_late.count > 0 ? "bad" : "" },
      topic.deadline_us === 0 ? "–" : late(topic.arrived_late),
      firsts.length === 0 ? "–" : clock(Math.min(...firsts))]);
  }

  showService(service) {
    if (service.state === undefined) {
      this.services.show(service.service, [{ text: "missing", look: "l faint" }, "–", "–", "–", "–", "–", "–", "–", "–", { text: "", look: "l" }]);
      return;
    }
    const gone = service.silent_ms > 300;
    this.services.show(service.service, [
      { text: gone ? "gone" : service.state, look: gone || service.state === "fault" ? "l bad" : "l" }, clock(service.last_ms),
      service.real_time ? (service.priority > 0 ? `yes, ${service.priority}` : "yes") : "no", share(service.cpu_share), memory(service), service.pid, service.deadline_misses, service.cycle_misses, service.lost_ticks,
      { text: service.waits_for, look: "l" }]);
  }

  showRigs(rigs, shown) {
    element("rigs-part").hidden = rigs.length < 2;
    this.rigs.keep(rigs.map(({ rig }) => String(rig)));
    for (const each of rigs) {
      this.rigs.show(String(each.rig), [{ text: each.level, look: each.level === "healthy" ? "l" : "l bad" },
        { text: (each.running ? "running" : "none") + (each.rig === shown ? ", shown" : ""), look: "l" },
        { text: each.worst === "" ? "–" : short(each.worst), look: "l" }, each.samples, { text: each.lost, look: each.lost > 0 ? "bad" : "" }]);
    }
  }

  showEdges({ topics }) {
    for (const { topic, writers, readers } of topics) {
      for (const reader of readers) {
        const name = `${writers.length === 1 ? writers[0] : "all"} → ${short(topic)} → ${reader.service}`;
        const bad = (count) => ({ text: count, look: count > 0 ? "bad" : "" });
        this.edges.show(name, reader.samples === undefined ? ["–", "–", "–", "–", "–", "–", "–"]
          : [reader.matched, reader.samples, bad(reader.lost_ticks), bad(reader.cycle_misses), bad(reader.deadline_misses),
            reader.worst_interval_us > 0 ? (reader.worst_interval_us / 1000).toFixed(3) : "–", reader.latency_p99_us > 0 ? us(reader.latency_p99_us) : "–"]);
      }
    }
  }

  showHosts(hosts) {
    element("hosts-part").hidden = hosts.length === 0;
    this.hosts.keep(hosts.map(({ host }) => host));
    for (const host of hosts) {
      this.hosts.show(host.host, [{ text: host.services.join(", "), look: "l wraps" }, { text: share(host.cpu_share), look: host.cpu_share > 0.9 ? "bad" : "" },
        host.cores ?? "–", host.clock_offset_us?.toFixed(1) ?? "–", host.clock_uncertainty_us?.toFixed(1) ?? "–"]);
    }
  }

  showRecorders(recorders) {
    element("recorders-part").hidden = recorders.length === 0;
    this.recorders.keep(recorders.map(({ name }) => name));
    for (const each of recorders) {
      const state = each.silent_ms > 2000 ? "silent" : each.trouble ? each.trouble : each.paused ? "paused" : "recording";
      this.recorders.show(each.name, [{ text: state, look: state === "recording" || state === "paused" ? "l" : "l bad" }, { text: each.file, look: "l" },
        each.received, { text: each.lost, look: each.lost > 0 ? "bad" : "" }, each.written, { text: each.dropped, look: each.dropped > 0 ? "bad" : "" },
        (each.file_bytes / 1e6).toFixed(1), (each.free_bytes / 1e9).toFixed(1), { text: each.answer ?? "", look: "l" }]);
    }
  }

  showEvents(events) {
    const items = events.slice(0, 12).map((event) => {
      const item = create("li");
      const by = event.by_us > 0 ? `, ${us(event.by_us)} µs` : "";
      item.append(create("time", clock(event.at_ms)), create("span", event.kind),
        create("span", [event.source, short(event.topic), event.peer, event.text].filter((part) => part !== "").join(" · ") + by));
      return item;
    });
    if (items.length === 0) items.push(create("li", "none"));
    element("events").replaceChildren(...items);
  }
}
