// SPDX-License-Identifier: Apache-2.0
// Tones for alarms that are not acknowledged. Off until a person turns it on; the browser stores the choice.
import { element, write } from "/elements.js";

const KEY = "stillhand.sound";
const TONES = { warning: { hz: 620, beeps: 1, again_ms: 10000 }, critical: { hz: 880, beeps: 3, again_ms: 3000 } };

export class Sound {
  constructor() {
    this.button = element("sound");
    this.on = localStorage.getItem(KEY) === "on";
    this.playedAt = -Infinity;
    this.played = null;
    this.button.addEventListener("click", () => {
      this.on = !this.on;
      localStorage.setItem(KEY, this.on ? "on" : "off");
      if (this.on) this.allow().then(() => this.beep(TONES.warning));
      this.show();
    });
    for (const name of ["pointerdown", "keydown"]) document.addEventListener(name, () => this.on && this.allow());
    this.show();
  }

  // A browser allows sound only after a person has touched the page.
  async allow() {
    if (!navigator.userActivation.hasBeenActive) return;
    this.audio ??= new AudioContext();
    if (this.audio.state === "suspended") await this.audio.resume();
    this.show();
  }

  show() {
    this.button.setAttribute("aria-pressed", this.on);
    write(this.button, !this.on ? "Sound off" : this.audio?.state === "running" ? "Sound on" : "Sound on: touch the page to start it");
  }

  beep({ hz, beeps }) {
    const { audio } = this;
    if (audio?.state !== "running") return;
    for (let i = 0; i < beeps; ++i) {
      const from = audio.currentTime + 0.25 * i;
      const tone = new OscillatorNode(audio, { type: "triangle", frequency: hz });
      const volume = new GainNode(audio, { gain: 0 });
      volume.gain.setValueAtTime(0, from);
      volume.gain.linearRampToValueAtTime(0.3, from + 0.01);
      volume.gain.setValueAtTime(0.3, from + 0.15);
      volume.gain.linearRampToValueAtTime(0, from + 0.18);
      tone.connect(volume).connect(audio.destination);
      tone.start(from);
      tone.stop(from + 0.2);
    }
  }

  hear({ mode, alarms, session }) {
    const past = mode === "recording" || session.replayed === true;
    this.button.hidden = past;
    if (!this.on || past) return;
    const open = alarms.filter((alarm) => !alarm.acknowledged);
    const level = open.length === 0 ? null : open.some((alarm) => alarm.level === "critical") ? "critical" : "warning";
    const now = performance.now();
    const worse = level === "critical" && this.played !== "critical";
    if (level !== null && (worse || now - this.playedAt > TONES[level].again_ms)) {
      this.beep(TONES[level]);
      this.playedAt = now;
      this.played = level;
    }
    if (level === null) {
      this.played = null;
      this.playedAt = -Infinity;
    }
  }
}
