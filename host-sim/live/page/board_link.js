// The WebSocket to the program `touchstone live`: receives messages and records, sends commands, and notices when nothing arrives any more.
const content = JSON.parse(document.getElementById("content").textContent);
const $ = (id) => document.getElementById(id);
const AGAIN_MS = 1000, SILENT_MS = 500;

/** Connection to the program. Calls `on.open`, `on.closed`, `on.words(message)` and `on.rows(numbers)`. */
class BoardLink {
  static peer = "the program";
  static lost = "NO CONNECTION TO THE PROGRAM. The program disarms the device when it loses this page. If the program itself has ended, check the board: its power switch always works.";
  constructor(on) {
    this.on = on;
    this.heard = performance.now();
    this.open();
  }
  open() {
    const socket = new WebSocket(content.socket);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { this.heard = performance.now(); this.on.open(); };
    socket.onmessage = ({ data }) => {
      this.heard = performance.now();
      if (typeof data === "string") { this.on.words(JSON.parse(data)); return; }
      const numbers = new Float64Array(data);
      // Acknowledges the records after they are processed, so that the program notices a page that hangs.
      this.on.rows(numbers.subarray(1));
      this.send({ seen: numbers[0] });
    };
    socket.onclose = () => { this.on.closed(); setTimeout(() => this.open(), AGAIN_MS); };
  }
  /** Sends a command; returns whether the socket was open. */
  send(order) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(order));
    return true;
  }
  get silent() { return performance.now() - this.heard > SILENT_MS; }
}
