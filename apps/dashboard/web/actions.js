// SPDX-License-Identifier: Apache-2.0
// Requests of the page. The emergency stop needs one key, wherever the focus is, and no confirmation.
import { SIGN_IN, clock, element, write } from "/elements.js";

const TRIES = 40; // of an emergency stop without an answer, four each second
const plain = (event) => !event.ctrlKey && !event.metaKey && !event.altKey;

function report(text, bad = false) {
  element("answer").classList.toggle("bad", bad);
  write(element("answer"), text);
}

// Returns why the request failed; "" when it was accepted.
async function ask(path, name) {
  try {
    const answer = await fetch(path, { method: "POST", signal: AbortSignal.timeout(2000) });
    if (answer.ok) {
      report(`${name}: asked at ${clock(Date.now())}`);
      return "";
    }
    const why = answer.status === 403 ? `signed out: ${SIGN_IN}` : (await answer.text()).trim();
    report(`${name}: refused: ${why}`, true);
    return why;
  } catch {
    report(`${name}: not delivered: the dashboard's process does not answer`, true);
    return "the dashboard's process does not answer";
  }
}

async function emergencyStop(button) {
  button.dataset.state = "asking";
  for (let i = 0; i < TRIES; ++i) {
    const why = await ask("/emergency-stop", "Emergency stop");
    if (why === "") {
      button.dataset.state = "asked";
      // From then on the session's own state is shown.
      setTimeout(() => { if (button.dataset.state === "asked") delete button.dataset.state; }, 5000);
      return;
    }
    button.dataset.state = "failed";
    report(`EMERGENCY STOP NOT DELIVERED (${why}): use the emergency stop at the rig. Trying again …`, true);
    await new Promise((then) => setTimeout(then, 250));
  }
  report("EMERGENCY STOP NOT DELIVERED: use the emergency stop at the rig.", true);
}

export class Actions {
  constructor() {
    this.acknowledge = element("acknowledge");
    this.emergency = element("emergency");
    this.acknowledge.addEventListener("click", () => ask("/acknowledge", "Acknowledge"));
    this.emergency.addEventListener("click", () => emergencyStop(this.emergency));
    for (const button of document.querySelectorAll("button[data-ask]")) {
      button.addEventListener("click", () => this.press(button));
    }
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && !event.repeat && !this.emergency.hidden) {
        event.preventDefault();
        emergencyStop(this.emergency);
      } else if (event.target !== element("reason") && plain(event) && event.key.toLowerCase() === "a" && !this.acknowledge.disabled) {
        ask("/acknowledge", "Acknowledge");
      }
    }, { capture: true });
  }

  // Repeat, note and abort carry what stands in the field; an accepted one empties it.
  async press(button) {
    const field = element("reason");
    if (button.dataset.text === undefined) return void ask(button.dataset.ask, button.dataset.name);
    const path = `${button.dataset.ask}?text=${encodeURIComponent(field.value.trim())}`;
    if ((await ask(path, button.dataset.name)) === "") field.value = "";
  }

  show({ actions, session, recorders = [] }) {
    const enabled = actions?.enabled === true && session.replayed !== true;
    this.emergency.hidden = !enabled;
    element("actions-part").hidden = !enabled;
    if (!enabled) return;
    if (session.emergency) this.emergency.dataset.state = "done";
    else if (this.emergency.dataset.state === "done") delete this.emergency.dataset.state;
    const going = session.state === "running" || session.state === "paused" || session.state === "waiting";
    for (const button of document.querySelectorAll("button[data-ask^='/session/']")) button.disabled = !going || session.emergency === true;
    for (const button of document.querySelectorAll("button[data-ask^='/recorder/']")) button.disabled = recorders.length === 0;
  }
}
