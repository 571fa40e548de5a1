// The serial port, in browsers with WebSerial. The WebAssembly module encodes and decodes the protocol with the device, without a
// program between page and device.
const content = JSON.parse(document.getElementById("content").textContent);
const $ = (id) => document.getElementById(id);
const BAUD = 921600, TURN_MS = 20, AGAIN_MS = 1000, SILENT_MS = 500;

/** Connection to the serial port. Calls `on.open`, `on.closed`, `on.words(message)` and `on.rows(numbers)`. */
class BoardLink {
  static peer = "the port";
  static lost = "NO PORT IS OPEN: press Connect. A device that was armed may still be armed: its power switch always works.";
  constructor(on) {
    Object.assign(this, { on, port: null, writer: null, heard: performance.now(), wanted: null, trying: false, refused: false });
    $("connect").hidden = false;
    $("connect").addEventListener("click", () => this.choose());
    unpacked().then((module) => WebAssembly.instantiate(module, {})).then((instance) => {
      wasm = instance.exports;
      put("serial port");
      wasm.live_board_new();
      if (!navigator.serial) { complain("This browser has no WebSerial (Chromium and related browsers have it). `touchstone live --port PORT` shows the same page in any browser."); return; }
      $("connect").disabled = false;
      setInterval(() => this.turn(), TURN_MS);
      setInterval(() => this.again(), AGAIN_MS);
    }, (error) => complain(`this browser cannot run WebAssembly: ${error}`));
    // Stops a device whose motor is on when the page is closed, if the browser still sends the bytes.
    addEventListener("pagehide", () => this.leave());
  }
  /** Lets the user choose the port in the browser's dialog. Later the page opens the port without the dialog. */
  async choose() {
    try {
      this.wanted = await navigator.serial.requestPort();
    } catch (error) {
      if (error.name !== "NotFoundError") complain(`no port: ${error.message}`);
      return;
    }
    this.run();
  }
  /** Opens the chosen port again. A port that was unplugged and plugged in again is a new object of the same device. */
  async again() {
    if (this.port || this.trying || !this.wanted) return;
    const there = await navigator.serial.getPorts(), id = JSON.stringify(this.wanted.getInfo());
    const same = there.find((port) => port === this.wanted) ?? there.find((port) => JSON.stringify(port.getInfo()) === id);
    if (!same) return;
    this.wanted = same;
    this.run();
  }
  async run() {
    if (this.port || this.trying) return;
    const port = this.wanted;
    this.trying = true;
    let why = "the port was closed";
    try {
      await port.open({ baudRate: BAUD, bufferSize: 65536 });
      Object.assign(this, { port, writer: port.writable.getWriter(), heard: performance.now() });
      $("connect").disabled = true;
      if (this.refused) complain("");
      this.refused = false;
      wasm.live_board_opened(performance.now());
      this.on.open();
      this.flush();
      // A damaged byte ends the reader, and the loop makes a new one. An unplugged cable ends the port's stream and the loop.
      while (port.readable) {
        try { await this.read(port); } catch (error) { why = error.message; }
      }
    } catch (error) { why = error.message; }
    this.trying = false;
    const was = this.port;
    this.port = this.writer = null;
    $("connect").disabled = false;
    if (!was) {
      // The timer of `again` repeats the attempt to open the port.
      this.refused = true;
      complain(`The port does not open: ${why} Close other programs and pages that use it, and check the cable.`);
      return;
    }
    port.close().catch(() => {});
    put(why);
    wasm.live_board_closed();
    this.flush();
    this.on.closed();
  }
  async read(port) {
    const reader = port.readable.getReader();
    try {
      for (;;) {
        const { value, done } = await reader.read();
        if (done) return;
        this.heard = performance.now();
        const room = wasm.live_text_room(value.length);
        new Uint8Array(wasm.memory.buffer, room, value.length).set(value);
        wasm.live_board_take(this.heard);
        this.flush();
      }
    } finally { reader.releaseLock(); }
  }
  turn() {
    if (!this.port) return;
    wasm.live_board_turn(performance.now());
    this.flush();
  }
  /** Writes the module's bytes to the port, and passes its messages and records to the page. */
  flush() {
    const bytes = wasm.live_board_out();
    if (bytes && this.writer) this.writer.write(new Uint8Array(wasm.memory.buffer, wasm.live_text(), bytes).slice()).catch(() => {});
    while (wasm.live_board_said()) this.on.words(JSON.parse(given()));
    const rows = wasm.live_board_rows();
    if (rows) this.on.rows(numbers(wasm.live_board_numbers(), rows).slice());
  }
  /** Gives a command to the module; returns whether the port was open. */
  send(order) {
    if (!this.writer) return false;
    put(JSON.stringify(order));
    wasm.live_board_order(performance.now());
    this.flush();
    return true;
  }
  leave() {
    if (this.writer && state && ["armed", "calibrating"].includes(state.phase)) this.send({ do: "stop" });
  }
  get silent() { return this.port !== null && performance.now() - this.heard > SILENT_MS; }
}
