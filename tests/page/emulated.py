"""Tests the web page of a board with the board's firmware in an emulator. It is reached through a TCP port, and through a pseudo terminal that
stands for a serial port."""

import os
import pty
import re
import socket
import subprocess
import termios
import threading
import time
import tty

from board import change, click_at, phase, press, served_page, text


class Emulator:
    """The emulated firmware on a TCP port, with a simulated hand that presses while the motor is on."""

    def __init__(self, program, firmware):
        self.process = subprocess.Popen([program, "serve", firmware, "--tcp", "127.0.0.1:0", "--hand"], stdout=subprocess.PIPE, text=True)
        self.address = re.search(r"tcp:(\S+)", self.process.stdout.readline()).group(1)
        # Reads all later output, because the emulator would wait if nobody read it.
        threading.Thread(target=self.process.stdout.read, daemon=True).start()

    def close(self):
        self.process.terminate()
        self.process.wait(timeout=10)


class Terminal:
    """A pseudo terminal in place of a serial port, connected to the emulator's TCP port. It has the same name after it is plugged in again."""

    def __init__(self, address, folder):
        host, port = address.split(":")
        self.place, self.name = (host, int(port)), os.path.join(folder, "ttyBoard")
        self.plug()

    def plug(self):
        self.socket = socket.create_connection(self.place)
        self.master, slave = pty.openpty()
        tty.setraw(slave, termios.TCSANOW)
        beside = self.name + ".new"
        os.symlink(os.ttyname(slave), beside)
        os.replace(beside, self.name)
        # Kept open until the program opens it, because a pseudo terminal vanishes if nobody has it open.
        self.slave = slave
        for source, sink in ((self.from_board, self.to_program), (self.from_program, self.to_board)):
            threading.Thread(target=self.carry, args=(source, sink), daemon=True).start()

    def carry(self, source, sink):
        try:
            while data := source():
                sink(data)
        except OSError:
            pass

    def from_board(self):
        return self.socket.recv(1 << 14)

    def to_program(self, data):
        while data:
            data = data[os.write(self.master, data):]

    def from_program(self):
        return os.read(self.master, 1 << 14)

    def to_board(self, data):
        self.socket.sendall(data)

    def noise(self, data):
        """Sends meaningless bytes to the program, as noise on the cable."""
        for at in range(0, len(data), 1024):
            self.to_program(data[at:at + 1024])

    def pull(self):
        self.socket.shutdown(socket.SHUT_RDWR)
        self.socket.close()
        os.close(self.slave)
        os.close(self.master)


# Longest time that any step may take, in seconds of the firmware's own clock.
LONGEST_S = 60
# Seconds of this computer's clock without a telemetry record, after which the firmware counts as stuck.
STANDSTILL_S = 60
# JavaScript expression for a shaft at rest: its angle stayed within 0.002 rad for 0.3 s of the firmware's time. False without records.
AT_REST = """(() => {
  let low = Infinity, high = -Infinity;
  run.ring.since(0.3, (i) => { const x = run.ring.columns.angle_rad[i]; low = Math.min(low, x); high = Math.max(high, x); });
  return high >= low && high - low < 0.002;
})()"""


def calibrated(page):
    """Waits until the shaft is at rest, and calibrates. Returns the duration in seconds of the firmware's time."""
    began = own_time_s(page)
    own_time_until(page, "the shaft at rest", lambda: own_time_s(page) > began + 0.3 and page.run(AT_REST))
    press(page, "calibrate")
    phase(page, "calibrating")
    took_s = own_time_until(page, "the end of the calibration", lambda: text(page, "phase") != "calibrating")
    phase(page, "ready")
    return took_s


def own_time_until(page, what, done):
    """Waits until `done` is true, with a limit in the firmware's own time, which is slower on a busy computer. Returns the time that passed, s."""
    began = at = own_time_s(page)
    moved = time.monotonic()
    while not done():
        last, at = at, own_time_s(page)
        if at > last:
            moved = time.monotonic()
        still_s = time.monotonic() - moved
        if at - began > LONGEST_S or still_s > STANDSTILL_S:
            raise TimeoutError(f"{what} did not come in {at - began:.1f} s of the firmware's time, the last record {still_s:.0f} s ago")
        page.wait(0.2)
    return own_time_s(page) - began


def own_time_s(page):
    """Seconds of the firmware's time since the first telemetry record, from the number of records including lost ones."""
    return page.run("(took.records + took.missing) * hello.decimation / hello.rate_hz")


def through(browser, program, address, way, pictures, check):
    """Does what a user does with a board, from changing settings to the stop. Gives the page while the motor is on."""
    with served_page(browser, program, address) as (page, url):
        page.until("typeof run !== 'undefined' && run !== null && run.ring.size > 100", 60)
        check("firmware" in text(page, "device") and "simulated" not in text(page, "device"), f"{way}: {text(page, 'device')}")
        change(page, "wall.k_desired_n_m_per_rad", "4")
        page.until("hello.k_desired_n_m_per_rad === 4")
        took_s = calibrated(page)
        press(page, "arm")
        phase(page, "armed")
        page.until("run.ring.columns.force_n_m.some((f) => f > 0.02)", 60)
        page.wait(1)
        worst, judged = page.run("[worst, run.ring.columns.model_n_m.filter((x) => !Number.isNaN(x)).length]")
        check(worst == 0 and judged > 300, f"{way}: calibrated in {took_s:.1f} s of its own time and armed; the firmware less the model over {judged} ticks: at most {worst} N·m; {page.run('took.missing')} records missing")
        if pictures:
            page.picture(os.path.join(pictures, "board-emulated.png"))
        yield page, url
        click_at(page, "stop")
        phase(page, "stopped")
        check(not page.problems, f"{way}: the stop stops it; no complaint of {page.name} {page.problems[:3]}")


def emulated(browser, program, emulator_program, firmware, pictures, folder, check):
    emulator = Emulator(emulator_program, firmware)
    try:
        for page, url in through(browser, program, f"tcp:{emulator.address}", "the emulator's socket", pictures, check):
            token = re.search("token=(.*)", url).group(1)
            refused = page.run(f"new Promise((done) => {{ const s = new WebSocket(content.socket.replace({token!r}, {'0' * 32!r})); s.onopen = () => done('open'); s.onerror = () => done('shut'); }})")
            check(refused == "shut", "a wrong token is refused")
            page.problems.clear()
        terminal = Terminal(emulator.address, folder)
        for page, _ in through(browser, program, terminal.name, "a pseudo terminal", None, check):
            damaged = page.run("troubles.damaged")
            terminal.noise(os.urandom(100_000))
            page.until(f"troubles.damaged > {damaged} + 50", 30)
            phase(page, "armed")
            check(True, f"100,000 bytes of noise before it: {page.run('troubles.damaged')} damaged frames, and it goes on")
            terminal.pull()
            page.until("!document.getElementById('lost').hidden", 5)
            check(text(page, "phase") == "not connected", f"a pulled cable: {text(page, 'lost')[:80]}")
            terminal.plug()
            phase(page, "ready", 30)
            check("was disarmed" in text(page, "error"), f"plugged in again: {text(page, 'error')}")
        terminal.pull()
    finally:
        emulator.close()
