// SPDX-License-Identifier: Apache-2.0
// The stream of snapshots. It notices when the dashboard's process stops, and connects again by itself.
const SILENT_MS = 1000; // it sends ten times a second
const DEAF_MS = 4000; // a host that is gone closes no connection
const AGAIN_MS = 500;

export class Stream {
  // opened(): the stream runs, for the first time or again; heard(snapshot); lost(since, signedOut): no data since then,
  // called repeatedly.
  constructor({ opened, heard, lost }) {
    this.calls = { opened, heard, lost };
    this.heardAt = performance.now();
    this.lastWord = new Date();
    this.signedOut = false;
    setInterval(() => this.watch(), 250);
    this.open();
  }

  open() {
    clearTimeout(this.again);
    this.source?.close();
    this.openedAt = performance.now();
    this.source = new EventSource("/events");
    this.source.onopen = () => {
      this.signedOut = false;
      this.calls.opened();
    };
    this.source.onmessage = (event) => {
      this.heardAt = performance.now();
      this.lastWord = new Date();
      this.calls.heard(JSON.parse(event.data));
    };
    this.source.onerror = () => {
      this.source.close();
      this.calls.lost(this.lastWord, this.signedOut);
      this.askWhy();
      this.again = setTimeout(() => this.open(), AGAIN_MS);
    };
  }

  // An EventSource does not distinguish a refusal from a lost connection.
  async askWhy() {
    const answer = await fetch("/style.css", { cache: "no-store" }).catch(() => null);
    this.signedOut = answer?.status === 403;
  }

  watch() {
    const now = performance.now();
    if (now - this.heardAt <= SILENT_MS) return;
    this.calls.lost(this.lastWord, this.signedOut);
    if (now - this.heardAt > DEAF_MS && now - this.openedAt > DEAF_MS) this.open();
  }
}
