"""The board's page before the firmware itself, emulated: through a socket, and through a pseudo terminal as a serial port is one."""

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
    """The firmware on a port, with a hand that presses while it is armed."""

    def __init__(self, program, firmware):
        self.process = subprocess.Popen([program, "serve", firmware, "--tcp", "127.0.0.1:0", "--hand"], stdout=subprocess.PIPE, text=True)
        self.address = re.search(r"tcp:(\S+)", self.process.stdout.readline()).group(1)
        # What it says later, of clients and of its pace, is read so that it never waits.
        threading.Thread(target=self.process.stdout.read, daemon=True).start()

    def close(self):
        self.process.terminate()
        self.process.wait(timeout=10)


class Terminal:
    """A serial port that is none: a pseudo terminal before a socket, by a name that stays when it is plugged in again."""

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
        # Kept open until the program has it: a terminal that nobody has open is gone.
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
        """Bytes that mean nothing, towards the program."""
        for at in range(0, len(data), 1024):
            self.to_program(data[at:at + 1024])

    def pull(self):
        self.socket.shutdown(socket.SHUT_RDWR)
        self.socket.close()
        os.close(self.slave)
        os.close(self.master)


# Seconds of the firmware's own time that anything may take.
LONGEST_S = 60
# Seconds of this machine's time without a record after which the firmware stands still.
STANDSTILL_S = 60
# The shaft rests: its angle was within 0.002 rad for 0.3 s of the firmware's time. Without a record nothing is known.
AT_REST = """(() => {
  let low = Infinity, high = -Infinity;
  run.ring.since(0.3, (i) => { const x = run.ring.columns.angle_rad[i]; low = Math.min(low, x); high = Math.max(high, x); });
  return high >= low && high - low < 0.002;
})()"""


def calibrated(page):
    """Seconds of the firmware's time that a calibration took, of a shaft at rest."""
    began = own_time_s(page)
    own_time_until(page, "the shaft at rest", lambda: own_time_s(page) > began + 0.3 and page.run(AT_REST))
    press(page, "calibrate")
    phase(page, "calibrating")
    took_s = own_time_until(page, "the end of the calibration", lambda: text(page, "phase") != "calibrating")
    phase(page, "ready")
    return took_s


def own_time_until(page, what, done):
    """Waits in the firmware's own time, which a busy machine makes as long as it likes; says how much of it has passed."""
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
    """Seconds of the firmware's time that its records tell of, those that were lost included."""
    return page.run("(took.records + took.missing) * hello.decimation / hello.rate_hz")


def through(browser, program, address, way, pictures, check):
    """What a person does with a board, from its settings to the stop."""
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
            check("is disarmed" in text(page, "error"), f"plugged in again: {text(page, 'error')}")
        terminal.pull()
    finally:
        emulator.close()
