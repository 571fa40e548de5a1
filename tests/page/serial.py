"""Tests the web page of a board that opens the serial port itself. A fake `navigator.serial` carries the bytes of a simulated knob's TCP port."""

import base64
import os
import random
import socket
import subprocess

from board import Knob, arm, change, phase, press, settings, text

# JavaScript that replaces the parts of WebSerial that a page uses. It has one port, which can be chosen and pulled out.
FAKE = """
window.fakeSerial = (() => {
  const decode = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const encode = (bytes) => { let text = ""; for (const byte of bytes) text += String.fromCharCode(byte); return btoa(text); };
  let input = null, sent = [], opened = 0, there = true, busy = false, options = null;
  const port = {
    readable: null, writable: null,
    getInfo: () => ({ usbVendorId: 0x0483, usbProductId: 0x374e }),
    open: async (asked) => {
      if (!there || busy) throw new DOMException("Failed to open serial port.", "NetworkError");
      options = asked;
      opened += 1;
      port.readable = new ReadableStream({ start: (controller) => { input = controller; } });
      port.writable = new WritableStream({ write: (bytes) => { for (const byte of bytes) sent.push(byte); } });
    },
    close: async () => { port.readable = port.writable = null; },
  };
  const serial = { requestPort: async () => { if (!navigator.userActivation.isActive) throw new DOMException("a person has to ask", "SecurityError"); return port; },
    getPorts: async () => (there ? [port] : []) };
  Object.defineProperty(Navigator.prototype, "serial", { get: () => serial });
  return {
    exchange: (bytes) => { if (bytes && input) input.enqueue(decode(bytes)); const out = encode(sent); sent = []; return out; },
    pull: () => { there = false; const was = input; input = null; const error = new DOMException("The device has been lost.", "NetworkError"); port.readable = null; was?.error(error); },
    plug: () => { there = true; }, busy: (is) => { busy = is; },
    opened: () => opened, options: () => options,
  };
})();
"""


class Cable:
    """Carries bytes between the page's fake serial port and the knob's TCP port, whenever the test waits."""

    def __init__(self, page, address):
        host, port = address.removeprefix("tcp:").split(":")
        self.page, self.place, self.socket, self.said = page, (host, int(port)), None, None
        self.plug()
        page.meanwhile = self.carry

    def plug(self):
        self.socket = socket.create_connection(self.place)
        self.socket.setblocking(False)

    def pull(self):
        self.socket.close()
        self.socket = None

    def carry(self):
        data = b""
        try:
            while self.socket and len(data) < 1 << 18:
                data += self.socket.recv(1 << 16)
        except BlockingIOError:
            pass
        hook, self.page.meanwhile = self.page.meanwhile, None
        out = base64.b64decode(self.page.run(f"fakeSerial.exchange({base64.b64encode(data).decode()!r})"))
        self.page.meanwhile = hook
        if self.socket and out:
            self.socket.setblocking(True)
            self.socket.sendall(out)
            self.socket.setblocking(False)


def connected(page):
    page.until("typeof run !== 'undefined' && run !== null && run.ring.size > 100")


def serial(browser, program, pictures, folder, check):
    file = os.path.join(folder, "board.html")
    subprocess.run([program, "--quiet", "live", "--serial", "--no-open", "--out", file], check=True)
    check(os.path.getsize(file) <= 1_500_000, f"a board's page with the port itself: {os.path.getsize(file)} bytes")
    without = browser(f"file://{file}", height=900)
    try:
        # Without a person nobody can choose a port. Checks what the page shows then.
        without.wait(1)
        check(text(without, "phase") == "not connected" and "press Connect" in text(without, "lost") and not without.problems, f"without a port: {text(without, 'lost')}")
    finally:
        without.close()
    knob = Knob(program)
    page = browser(f"file://{file}", height=1300, before=FAKE)
    try:
        page.until("document.getElementById('connect')?.disabled === false")
        cable = Cable(page, knob.address)
        page.run("fakeSerial.busy(true)")
        page.run("document.getElementById('connect').click()")
        page.until("document.getElementById('error').textContent.includes('does not open')", 3)
        check("Close other programs" in text(page, "error") and not page.run("document.getElementById('connect').disabled"), f"a port that another program has: {text(page, 'error')}")
        page.run("fakeSerial.busy(false)")
        connected(page)
        check(text(page, "error") == "", "it is opened as soon as it is free")
        phase(page, "boot")
        check(page.run("fakeSerial.options().baudRate") == 921600 and "protocol" in text(page, "device"), f"connected: {text(page, 'device')}")
        settings(page, check)
        change(page, "motor.continuous_current_a", "2")
        arm(page)
        page.wait(5)
        pushed, worst, judged = page.run("[Math.max(...run.ring.columns.force_n_m), worst, run.ring.columns.model_n_m.filter((x) => !Number.isNaN(x)).length]")
        check(pushed > 0.05 and judged > 1000 and worst == 0, f"the hand is pushed back with {pushed:.3f} N·m; device less model over {judged} ticks, computed in the page: at most {worst} N·m")
        rate, missing = page.run("[took.rate, took.missing]")
        check(rate > 900 and missing == 0, f"{rate:.0f} records a second of 1000, {missing} missing")
        if pictures:
            page.picture(os.path.join(pictures, "board-serial.png"))
        press(page, "disarm")
        phase(page, "ready")
        page.key("Escape")
        phase(page, "stopped")
        arm(page)
        page.run("inputs.get('wall.surface_rad').focus()")
        page.key(" ")
        phase(page, "stopped")
        check(True, "Space stops it, with the focus in a setting")
        arm(page)
        # Random bytes in pieces, as a serial port delivers them; some look like frames.
        noise = random.Random(15).randbytes(100_000)
        for at in range(0, len(noise), 4096):
            page.run(f"fakeSerial.exchange({base64.b64encode(noise[at:at + 4096]).decode()!r})")
            page.wait(0.02)
        page.until("troubles.damaged > 100")
        phase(page, "armed")
        check(not page.problems, f"100,000 bytes of noise: {page.run('troubles.damaged')} damaged frames, and it goes on {page.problems[:2]}")
        cable.pull()
        page.run("fakeSerial.pull()")
        page.until("!document.getElementById('lost').hidden", 3)
        check("power switch" in text(page, "lost") and text(page, "phase") == "not connected", "a pulled cable is shown at once")
        page.key("Escape")
        page.wait(0.1)
        check("NOT SENT" in text(page, "error"), f"and that a stop does not arrive: {text(page, 'error')}")
        cable.plug()
        page.run("fakeSerial.plug()")
        phase(page, "ready")
        check("was disarmed" in text(page, "error") and page.run("fakeSerial.opened()") == 2, f"plugged in again: {text(page, 'error')}")
        page.until("took.rate > 900")
        # Simulates a device that is silent while its port stays open.
        cable.pull()
        page.until("!document.getElementById('lost').hidden", 6)
        check("sends nothing" in text(page, "lost") or "does not answer" in text(page, "lost"), f"silence is noticed: {text(page, 'lost')[:90]}")
        cable.plug()
        phase(page, "ready")
        check(not page.problems, f"no complaint of {page.name} {page.problems[:3]}")
    finally:
        page.close()
        knob.close()
