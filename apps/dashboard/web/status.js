// SPDX-License-Identifier: Apache-2.0
// The strip that is read from across the room.
const SIGNS = { healthy: "✓", warning: "!", critical: "✕", none: "–" };
const WORDS = { healthy: "Healthy", warning: "Warning", critical: "Critical" };
const SESSIONS = { none: "No session", waiting: "Session waits", ending: "Session over", unknown: "Session unknown" };

const element = (id) => document.getElementById(id);

// A screen reader speaks what changes: nothing is written that is there already.
export function write(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

export function clock(ms) {
  return ms === null || ms === undefined ? "–" : new Date(ms).toLocaleTimeString("en-GB");
}

export function short(topic) {
  return topic.replace(/^stillhand\//, "");
}

function span(ms) {
  const s = Math.max(0, Math.round(ms / 1000));
  if (s < 90) return `${s} s`;
  if (s < 5400) return `${Math.round(s / 60)} min`;
  return `${(s / 3600).toFixed(1)} h`;
}

function amount(alarm) {
  if (alarm.unit === "ticks") return `${alarm.worst} tick${alarm.worst === 1 ? "" : "s"}`;
  return alarm.worst >= 1000 ? `${(alarm.worst / 1000).toFixed(1)} s` : `${alarm.worst.toFixed(alarm.worst < 10 ? 3 : 1)} ms`;
}

export function what(alarm) {
  const topic = short(alarm.subject);
  const from = alarm.writer ? ` (${alarm.writer})` : "";
  switch (alarm.watch) {
    case "late": return `${topic}${from} sent late, by up to ${amount(alarm)}`;
    case "lost": return `${topic}${from} lost up to ${amount(alarm)} in a row`;
    case "silent": return `${topic}${from} silent for ${amount(alarm)}`;
    case "latency": return `${topic}${from} takes ${amount(alarm)} (p99)`;
    case "chain": return `sensor to motor takes ${amount(alarm)}`;
    case "missing": return `${alarm.subject} shows no life sign, for ${amount(alarm)}`;
    default: return `${alarm.watch} ${alarm.subject}`;
  }
}

function strip(level, word, text, since) {
  element("strip").dataset.level = level;
  write(element("sign"), SIGNS[level]);
  write(element("word"), word);
  write(element("what"), text);
  write(element("since"), since);
}

export function showStatus(snapshot) {
  const { alarms, session } = snapshot;
  const button = element("acknowledge");
  button.disabled = !alarms.some((alarm) => !alarm.acknowledged);
  const title = snapshot.mode === "recording" ? `recording ${snapshot.file}` : `domain ${snapshot.domain}, rig ${snapshot.rig}`;
  if (alarms.length > 0) {
    const first = alarms[0];
    const others = alarms.length > 1 ? `; ${alarms.length - 1} more` : "";
    const over = first.active ? "" : first.watch === "missing" || first.watch === "silent" ? "; back again" : "; not now";
    strip(snapshot.level, WORDS[snapshot.level], what(first) + over + others,
      `since ${clock(first.since_ms)}\n${span(snapshot.now_ms - first.since_ms)} ago`);
  } else if (session.state === "running") {
    strip("healthy", WORDS.healthy, title, `since ${clock(snapshot.level_since_ms)}\n${span(snapshot.now_ms - snapshot.level_since_ms)}`);
  } else {
    strip("none", SESSIONS[session.state] ?? session.state, title, "");
  }
  document.title = `${element("word").textContent} – Stillhand`;
}

export function showLost(why) {
  strip("none", "No connection", why, "");
  document.title = "No connection – Stillhand";
}
