// SPDX-License-Identifier: Apache-2.0
// The strip, which is read from across the room.
import { costOfAlarm } from "/cost.js";
import { SIGN_IN, clock, element, short, span, write } from "/elements.js";

const SIGNS = { healthy: "✓", warning: "!", critical: "✕", none: "–", replay: "▶" };
const WORDS = { healthy: "Healthy", warning: "Warning", critical: "Critical" };
const SESSIONS = { none: "No session", waiting: "Session waiting", ending: "Session over", unknown: "Session unknown" };
const SECOND_WRITER_SHOWN_MS = 60000; // it also stays in the list of events
export const LEVELS = ["healthy", "warning", "critical"];

function amount(alarm) {
  if (alarm.unit === "ticks") return `${alarm.worst} tick${alarm.worst === 1 ? "" : "s"}`;
  return alarm.worst >= 1000 ? `${(alarm.worst / 1000).toFixed(1)} s` : `${alarm.worst.toFixed(alarm.worst < 10 ? 3 : 1)} ms`;
}

export function what(alarm) {
  const topic = short(alarm.subject);
  const at = alarm.host ? ` on ${alarm.host}` : "";
  const from = alarm.writer ? ` (${alarm.writer}${at})` : "";
  switch (alarm.watch) {
    case "late": return `${topic}${from} sent late, by up to ${amount(alarm)}`;
    case "lost": return `${topic}${from} lost up to ${amount(alarm)} in a row`;
    case "silent": return `${topic}${from} silent for ${amount(alarm)}`;
    case "latency": return `${topic}${from} has a latency of ${amount(alarm)} (p99)`;
    case "qos": return `${topic} of ${alarm.writer} is not matched: QoS mismatch, ${alarm.policy}`;
    case "chain": return `sensor to motor takes ${amount(alarm)}`;
    case "missing": return `${alarm.subject}${at} has shown no life sign for ${amount(alarm)}`;
    default: return `${alarm.watch} ${alarm.subject}`;
  }
}

function strip(level, word, text, since) {
  element("strip").dataset.level = level;
  write(element("sign"), SIGNS[level]);
  write(element("word"), word);
  write(element("what"), text);
  write(element("since"), since);
  document.title = `${word} – Stillhand`;
}

// A silence ends because the writer sends again or because the session is over.
function ended({ active, watch }, state) {
  if (active) return "";
  if (watch !== "missing" && watch !== "silent") return "; ended";
  return state === "ending" ? "; the session is over" : "; back now";
}

// "; cost so far: 0.08 N"
function behind(text) {
  return text === "" ? "" : `; ${text}`;
}

function stripOfAlarms(alarms, { cost, session: { state }, now_ms: now }, where) {
  const first = alarms[0];
  const others = alarms.length > 1 ? `; ${alarms.length - 1} more` : "";
  strip(first.level, WORDS[first.level], what(first) + ended(first, state) + behind(costOfAlarm(cost, first)) + others + where, `since ${clock(first.since_ms)}\n${span(now - first.since_ms)} ago`);
}

// Adds the QoS mismatches, which have no threshold and cannot be acknowledged. Not every snapshot holds the graph.
let mismatches = [];
export function withMismatches({ alarms, graph }) {
  mismatches = graph?.qos_mismatches ?? mismatches;
  const standing = mismatches.map(({ topic, service, policy, since_ms }) => (
    { watch: "qos", subject: topic, writer: service, policy, level: "critical", active: true, acknowledged: true, count: 1, since_ms, last_ms: since_ms }));
  return [...standing, ...alarms];
}

// The alarms that strip and graph show. In a recording no alarm is acknowledged, so each stays at its worst to the end.
// There these are the marks of the second before the instant, and the alarms that still last.
export function alarmsOfNow({ mode, alarms, recent = [] }) {
  if (mode !== "recording") return alarms;
  const lasting = alarms.filter(({ active, watch }) => active && watch !== "late" && watch !== "lost");
  return [...recent, ...lasting].sort((one, other) => LEVELS.indexOf(other.level) - LEVELS.indexOf(one.level));
}

export function showStatus(snapshot) {
  const { alarms, session, now_ms: now } = snapshot;
  const recording = snapshot.mode === "recording";
  const past = recording || session.replayed === true;
  element("acknowledge").disabled = past || !alarms.some((alarm) => !alarm.acknowledged);
  element("acknowledge").hidden = past;
  element("strip").dataset.past = past;
  const title = recording ? `recording ${snapshot.file}` : `domain ${snapshot.domain}, rig ${snapshot.rig}`;
  const shown = alarmsOfNow(snapshot);
  const second = snapshot.events.find(({ kind, at_ms: at }) => kind === "second writer" && now - at < SECOND_WRITER_SHOWN_MS);
  if (session.replayed) {
    // What was an emergency then is none now.
    const then = session.emergency ? "; at that time: emergency stop" : shown.length > 0 ? `; at that time: ${what(shown[0])}` : "";
    strip("replay", "REPLAY", `a recording is played on ${title}: no rig runs, and no action reaches one${then}`, "");
  } else if (session.emergency) {
    const when = session.emergency_ms ? `requested ${clock(session.emergency_ms)}\n${span(now - session.emergency_ms)} ago` : "";
    const ends = session.state === "ending" ? "the session is over" : "the motor's force goes to zero, the platform brakes, the session ends";
    strip("critical", "Emergency stop", ends, when);
  } else if (second !== undefined) {
    strip("critical", "Second writer", `${second.peer} also writes ${short(second.topic)}: nobody listens to it, and the interlock opens`, `since ${clock(second.at_ms)}\n${span(now - second.at_ms)} ago`);
  } else if (shown.length > 0) {
    stripOfAlarms(shown, snapshot, recording ? `; ${title}` : "");
  } else if (session.state === "running" || session.state === "paused") {
    const paused = session.state === "paused" || session.paused ? "no trial begins until Start is pressed; " : "";
    const before = alarms.length > 0 ? `; ${alarms.length} earlier alarm${alarms.length === 1 ? "" : "s"}, ended` : "";
    strip("healthy", WORDS.healthy, paused + title + before, recording ? clock(now) : `since ${clock(snapshot.level_since_ms)}\n${span(now - snapshot.level_since_ms)}`);
  } else {
    const absent = snapshot.services.filter(({ state }) => state === undefined).map(({ service }) => service);
    const waits = session.state === "waiting" && absent.length > 0 ? `; missing: ${absent.join(", ")}` : "";
    strip("none", SESSIONS[session.state] ?? session.state, title + waits, recording ? clock(now) : "");
  }
  delete document.body.dataset.stale;
}

export function showLost(since, signedOut) {
  const silent = `no data from the dashboard's process since ${clock(since)}`;
  strip("none", signedOut ? "Signed out" : "No connection", signedOut ? SIGN_IN : silent, `${span(Date.now() - since)} ago`);
  document.body.dataset.stale = "";
}
