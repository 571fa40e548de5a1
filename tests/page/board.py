"""Tests the web page of a board with a simulated knob on a TCP port: every control, a faulty cable, and how the page looks."""

import contextlib
import os
import re
import subprocess


class Knob:
    """The program `touchstone demo` on a TCP port. Lines of text to its input simulate faults, such as `pull` for the cable."""

    def __init__(self, program):
        self.process = subprocess.Popen([program, "--quiet", "demo", "--port-only", "--listen", "127.0.0.1:0"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()

    def happens(self, what):
        self.process.stdin.write(what + "\n")
        self.process.stdin.flush()

    def close(self):
        self.process.stdin.close()
        self.process.terminate()
        self.process.wait(timeout=10)


def text(page, element):
    return page.run(f"document.getElementById({element!r}).textContent")


def phase(page, wanted, limit=20):
    try:
        page.until(f"document.getElementById('phase').textContent === {wanted!r}", limit)
    except TimeoutError as error:
        raise TimeoutError(f"{text(page, 'phase')!r}, {text(page, 'fault-name')!r}, {text(page, 'error')!r} instead of {wanted!r}") from error


def press(page, what):
    """Waits until a button of the page is enabled, and clicks it."""
    page.until(f"!document.querySelector('[data-do={what}]').disabled")
    page.run(f"document.querySelector('[data-do={what}]').click()")


def change(page, path, value):
    page.run(f"(() => {{ const input = inputs.get({path!r}); input.value = {value!r}; input.dispatchEvent(new Event('change')); }})()")
    page.wait(0.3)


def arm(page):
    press(page, "calibrate")
    phase(page, "calibrating")
    phase(page, "ready", 60)
    press(page, "arm")
    phase(page, "armed")


def stops(page, check):
    """Checks every way to stop the device, with the focus on different elements of the page."""
    for name, act in (
        ("Esc", lambda: page.key("Escape")),
        ("Space with the focus in a setting", lambda: (page.run("inputs.get('wall.surface_rad').focus()"), page.key(" "))),
        ("Space with the focus on another button", lambda: (page.run("document.querySelector('[data-do=disarm]').focus()"), page.key(" "))),
        ("the button", lambda: click_at(page, "stop")),
    ):
        arm(page)
        page.run("scrollTo(0, document.body.scrollHeight)")
        page.wait(0.2)
        act()
        started = page.run("performance.now()")
        phase(page, "stopped")
        check(True, f"{name} stops it; seen after {page.run('performance.now()') - started:.0f} ms")
    page.run("scrollTo(0, 0)")


def click_at(page, element):
    x, y = page.run(f"(() => {{ const b = document.getElementById({element!r}).getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; }})()")
    page.mouse("down", x, y)
    page.mouse("up", x, y)


def settings(page, check):
    rows = page.run("inputs.size")
    check(rows > 50, f"{rows} settings, each with its range: {page.run('''document.querySelector('#fields small').textContent''')!r}")
    change(page, "wall.k_desired_n_m_per_rad", "12")
    check(page.run("hello.k_desired_n_m_per_rad") == 12 and text(page, "answer").endswith("done"), "a stiffness is set")
    # The page shows this when it gets the device's state, which may arrive after the answer.
    check(page.comes_true("document.getElementById('unsaved').textContent.startsWith('changed')"), "and is not saved")
    change(page, "wall.k_desired_n_m_per_rad", "-4")
    check("outside" in text(page, "error") and page.run("inputs.get('wall.k_desired_n_m_per_rad').getAttribute('aria-invalid')") == "true", f"a wrong one is refused: {text(page, 'error')}")
    press(page, "save")
    page.until("document.getElementById('unsaved').textContent === 'as saved'")
    press(page, "defaults")
    page.until("hello.k_desired_n_m_per_rad !== 12")
    check(text(page, "error") == "", "saved, and back to the defaults")
    press(page, "zero")
    page.until("document.getElementById('answer').textContent === 'zero: done'")


@contextlib.contextmanager
def served_page(browser, program, address):
    """Starts the program that serves a device's page and opens the page. Gives the page and its address; ends the program afterwards."""
    served = subprocess.Popen([program, "live", "--no-open", "--port", address], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    page = None
    try:
        url = re.search(r"http://\S+", served.stdout.readline()).group()
        page = browser(url, height=1300)
        yield page, url
    finally:
        if page:
            page.close()
        served.terminate()
        served.wait(timeout=10)


def board(browser, program, pictures, check):
    knob = Knob(program)
    with contextlib.closing(knob), served_page(browser, program, knob.address) as (page, url):
        page.until("typeof run !== 'undefined' && run !== null && run.ring.size > 100")
        phase(page, "boot")
        check(all(page.run(f"document.querySelector('[data-do={what}]').disabled") for what in ("arm", "disarm")), "what may not be asked cannot be pressed")
        settings(page, check)
        # With the default current limit, several calibrations in a row raise a fault, so the limit is raised.
        change(page, "motor.continuous_current_a", "2")
        arm(page)
        page.wait(6)
        pushed, worst, judged = page.run("[Math.max(...run.ring.columns.force_n_m), worst, run.ring.columns.model_n_m.filter((x) => !Number.isNaN(x)).length]")
        check(pushed > 0.05 and judged > 1000, f"the hand is pushed back with {pushed:.3f} N·m at most")
        check(worst == 0, f"device less model over {judged} ticks: at most {worst} N·m")
        rate, missing = page.run("[took.rate, took.missing]")
        check(rate > 900, f"{rate:.0f} records a second of 1000, {missing} missing so far, {page.run('link.socket.bufferedAmount')} bytes waiting")
        if pictures:
            page.picture(os.path.join(pictures, "board.png"))
        before = page.run("took.missing")
        knob.happens("gap 300")
        page.until(f"took.missing >= {before + 300}")
        page.wait(0.3)
        check(page.run("run.ring.columns.missing.some((n) => n > 200)"), f"300 records that are missing are counted: {page.run('took.missing') - before}")
        check(page.run("Number.isNaN(run.last.difference_n_m)"), "and the model does not guess")
        if pictures:
            page.picture(os.path.join(pictures, "board-gap.png"))
        press(page, "disarm")
        phase(page, "ready")
        page.key("Escape")
        phase(page, "stopped")
        stops(page, check)
        arm(page)
        knob.happens("volts 40")
        phase(page, "fault")
        page.until("!document.getElementById('fault').hidden")
        check("over-voltage" in text(page, "fault-name") and "bus" in text(page, "fault-meaning") and "device stop" in text(page, "fault-clear"),
              f"a fault is explained: {text(page, 'fault-name')}")
        if pictures:
            page.picture(os.path.join(pictures, "board-fault.png"))
        knob.happens("volts 24")
        page.wait(0.2)
        page.key("Escape")
        phase(page, "stopped")
        check(page.run("document.getElementById('fault').hidden"), "the stop clears it")
        arm(page)
        knob.happens("noise 100000")
        page.until("troubles.damaged > 0")
        phase(page, "armed")
        check(True, f"100,000 bytes of noise: {page.run('troubles.damaged')} damaged frames, and it goes on")
        knob.happens("pull")
        page.until("!document.getElementById('lost').hidden", 3)
        check("power switch" in text(page, "lost") and text(page, "phase") == "not connected", "a pulled cable is shown at once")
        page.key("Escape")
        page.until("document.getElementById('error').textContent.includes('no connection')")
        knob.happens("plug")
        phase(page, "ready")
        check("was disarmed" in text(page, "error"), f"plugged in again: {text(page, 'error')}")
        for width in (400, 800, 1600):
            page.size(width, 900)
            page.wait(0.4)
            over = page.run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
            page.run("scrollTo(0, document.body.scrollHeight)")
            page.wait(0.1)
            reach = page.run("(() => { const b = document.getElementById('stop').getBoundingClientRect(); return b.top >= 0 && b.bottom <= innerHeight && b.left >= 0 && b.right <= innerWidth; })()")
            page.run("scrollTo(0, 0)")
            check(over <= 0 and reach, f"board, {width} px wide: nothing sticks out ({over}), the stop is in reach")
            if pictures:
                page.picture(os.path.join(pictures, f"board-{width}.png"))
        page.size(1280, 1300)
        page.dark()
        page.wait(0.6)
        if pictures:
            page.picture(os.path.join(pictures, "board-dark.png"))
        check(not page.problems, f"no complaint of the browser {page.problems[:3]}")
        # When the page is closed, the device is switched off. A page of another origin cannot connect.
        press(page, "arm")
        phase(page, "armed")
        page.go("about:blank")
        page.wait(0.5)
        page.go(url)
        page.until("typeof run !== 'undefined' && run !== null")
        phase(page, "ready")
        check(True, "a page that goes away disarms")
        token = re.search("token=(.*)", url).group(1)
        page.problems.clear()
        page.go("about:blank")
        page.wait(0.3)
        shut = f"new Promise((done) => {{ const s = new WebSocket({url.replace('http', 'ws').replace('/?', '/socket?')!r}); s.onopen = () => done('open'); s.onerror = () => done('shut'); }})"
        check(page.run(shut) == "shut" and len(token) == 32, "a page of another origin does not get in, even with the token")
