"""Tests the live pages in Chromium and Firefox without a window. Page of a simulated knob: every control, every preset, real time, and a record
that the program repeats. Then the pages of a board, of a report and of three axes.

    drive.py PROGRAM EMULATOR FIRMWARE [--short | SECONDS [FOLDER]]

EMULATOR and FIRMWARE are `-` if there is none. Control periods (ticks) are counted over SECONDS (20), pictures
go to FOLDER. `--short`: only the first installed browser, ticks over 5 s.

Exit code 0: all checks passed; 1: a check failed; 77: no browser installed. A browser that is not installed is skipped with a note.
"""

import csv
import glob
import json
import os
import struct
import subprocess
import sys
import tempfile
import time

import chromium
import firefox
from board import board
from editor import editor
from emulated import emulated
from pace import pace
from report import report
from serial import serial
from space import space

# Largest size of the page in bytes, so that it can be sent by mail. Longest time in s until a newly opened page simulates the wall.
MOST_BYTES, MOST_WAIT_S = 1_500_000, 10
failures = []


def check(holds, words):
    print(("ok   " if holds else "FAIL ") + words, flush=True)
    if not holds:
        failures.append(words)


def running(page):
    page.until("typeof runs !== 'undefined' && runs.length > 0 && !pending && runs[0].ring.size > 20")


def shown(page):
    return page.run("document.getElementById('error').hidden ? '' : document.getElementById('error').textContent")


def choose(page, control, value, event="change"):
    page.run(f"(() => {{ const c = document.getElementById('{control}'); c.value = {value!r}; "
             f"c.dispatchEvent(new Event('{event}', {{bubbles: true}})); }})()")
    page.wait(0.15)
    running(page)


def click(page, control):
    page.run(f"document.getElementById('{control}').click()")
    page.wait(0.1)


def value(page, path):
    return page.run(f"fields.get({path!r})?.value ?? null")


def presets(page, folder):
    for step in range(8):
        page.key(str(step))
        page.wait(0.3)
        running(page)
        page.wait(3.2 if step else 0.3)
        title = page.run("document.querySelector('[aria-current=step]').textContent")
        moved = page.run("Math.max(...runs[0].ring.columns.force_n_m)")
        check(shown(page) == "" and title.startswith(str(step)) and (step == 0 or moved > 0.01), f"preset {title}: largest force {moved:.3f} N·m")
        if folder:
            page.picture(os.path.join(folder, f"preset-{step}.png"))
        if step == 6:
            # A time in the hold of the press, in any repetition of the scene's motion.
            page.until("(runs[0].last.time_s % 4.8) > 2.9 && (runs[0].last.time_s % 4.8) < 3.8")
            shown_k = page.run("stiffnessShown(Object.fromEntries(COLUMNS.map((n) => [n, [runs[0].last[n]]])), 0, runs[0])")
            check(abs(shown_k - 14) < 0.7, f"ours shows {shown_k:.2f} of 14 N·m/rad in the press, and lets {1e3 * page.run('runs[0].got'):.2f} mJ out")
        if step == 7:
            guarded, bare = page.run("[runs[0].got, runs[1].got]")
            check(guarded <= 0.0205 < 0.1 < bare, f"the adversary gets out {1e3 * guarded:.1f} mJ with the guard, {1e3 * bare:.0f} mJ without")


def feels(page, folder):
    """Checks every shipped haptic effect in place of the wall: the knob moves by itself, the page shows the effect's walls and detents, the pointer
    turns the knob, and the page's own scene comes back."""
    for name in page.run("content.feels.map(([name]) => name)"):
        choose(page, "feel", name)
        page.wait(0.3)
        running(page)
        page.wait(1.2)
        facts = page.run("[runs[0].facts.has_wall, runs[0].facts.detents_per_rev, walls(runs[0].facts).length]")
        told = page.run("document.getElementById('told').textContent")
        turned = page.run("Math.max(...runs[0].ring.columns.angle_rad.slice(0, runs[0].ring.end)) > 0.01")
        drawn = page.run("(runs[0].profile?.shape ?? []).filter((point) => point !== 0).length")
        parts = page.run("Object.values(runs[0].parts).filter((part) => part).length")
        felt = name == "smooth" or facts[2] > 0 or drawn > 0 or parts > 0
        check(shown(page) == "" and facts[0] == 0 and felt and turned and told.startswith(f"{name}."), f"feel {name}: {facts[1]:.0f} detents a turn, {facts[2]} walls, {drawn} points of a profile, {parts} other parts")
        if folder:
            page.picture(os.path.join(folder, f"feel-{name}.png"))
    choose(page, "feel", "coarse-detents")
    page.wait(0.5)
    before = page.run("(() => { const at = runs[0].last.angle_rad; setAim(at + 1.5); return at; })()")
    page.wait(0.8)
    now = page.run("runs[0].last.angle_rad")
    check(now - before > 0.2, f"a pointer 1.5 rad further turns the knob by {now - before:.2f} rad")
    choose(page, "feel", "")
    page.wait(0.3)
    running(page)
    check(page.run("runs[0].facts.has_wall") == 1, "the page's own scene comes back")


def drawing(page, folder):
    """Checks the editor of torque profiles: five clicks per turn, edited and felt by keyboard alone, then drawn with the pointer, and exported."""
    began = time.monotonic()
    page.run("document.querySelector('#draw summary').focus()")
    if page.presses:
        page.key(" ")
    else:
        page.run("document.querySelector('#draw summary').click()")
    page.until("runs.length > 0 && runs[0].profile?.copies === 5 && !pending && runs[0].ring.size > 20")
    check(page.run("runs[0].facts.has_wall") == 0 and page.run("chosen.base") == "smooth", "drawing begins with five clicks in the place of the wall")
    pitch = page.run("runs[0].profile.length")
    page.run("document.getElementById('stage').focus()")
    page.key("ArrowRight", hold=2.2)
    page.key("h")
    page.wait(1.5)
    last = page.run("runs[0].last.angle_rad")
    clicks = round(last / pitch)
    check(clicks >= 1 and abs(last - clicks * pitch) < 0.15 * pitch, f"arrow keys turn it over {clicks} clicks; it rests {1e3 * (last - clicks * pitch):.1f} mrad beside the last, {time.monotonic() - began:.0f} s after it was begun")
    check(time.monotonic() - began < 120, "within two minutes")
    page.run("document.getElementById('profile').focus()")
    before = page.run("runs[0].profile.shape")
    page.key("ArrowRight")
    page.key("ArrowUp")
    page.until("runs[0].profile.shape[1] !== %r && !pending" % before[1])
    after = page.run("runs[0].profile.shape")
    check(abs(after[1] - before[1] - 0.1) < 1e-9 and after[2:] == before[2:], f"an arrow key on the curve changes one point from {before[1]} to {after[1]}")
    told = page.run("document.getElementById('profile').getAttribute('aria-valuetext')")
    check(told.startswith("point 2 of 8: -40 %"), f"and says so: {told}")
    left, top, width, height = page.run("(() => { const c = document.getElementById('profile'); c.scrollIntoView({block: 'center'}); const b = c.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")
    for kind, x, y in (("down", 0.001, 0.5), ("move", 0.5, 0.0455), ("move", 0.8, 0.5), ("up", 0.8, 0.5)):
        page.mouse(kind, left + x * width, top + y * height)
    page.until("Math.abs(runs[0].profile.shape[4] - 1) < 1e-9 && !pending")
    drawn = page.run("runs[0].profile.shape")
    check(drawn[:5] == [0, 0.25, 0.5, 0.75, 1], f"a pointer drawn over the curve sets every point that it passes: {drawn}")
    choose(page, "profile-from", "1")
    choose(page, "profile-copies", "12")
    choose(page, "profile-points", "16")
    page.until("runs[0].profile.copies === 12 && runs[0].profile.shape.length === 16 && !pending")
    shape = page.run("runs[0].profile.shape")
    check(shape[0] == 0 and shape[2] == -1 and shape[14] == 1 and shown(page) == "", f"magnetic detents, twelve in a turn, from 16 points: {shape}")
    check("environment.profile.shape" in page.run("decodeURIComponent(location.hash)"), "the page's address carries the drawing")
    choose(page, "profile-copies", "0.5")
    page.wait(0.4)
    check("environment.profile.per_rev" in shown(page), f"half a copy is refused: {shown(page)}")
    if folder:
        page.run("setAim(0.4)")
        page.wait(0.5)
        page.picture(os.path.join(folder, "draw.png"), whole=True)
        page.size(400, 900)
        page.wait(0.5)
        page.picture(os.path.join(folder, "draw-400.png"), whole=True)
        page.size(1280, 900)
    page.run("document.getElementById('draw').open = false")
    choose(page, "feel", "")
    running(page)


def controls(page):
    page.key("0")
    running(page)
    for control, choice, path, wanted in (
        ("law", "fba", "law.kind", "fba"),
        ("law", "enhanced-sfa", "law.kind", "enhanced-sfa"),
        ("stiffness-n", "20", "wall.k_desired_n_m_per_rad", "20.0"),
        ("stiffness", "0.5", "wall.k_desired_n_m_per_rad", "3.16"),
        ("grip", "firm", "operator.grip", "firm"),
        ("grip", "none", "operator.grip", "none"),
        ("grip", "medium", "operator.grip", "medium"),
        ("delay", "1.5", "timing.computational_delay_s", "0.0015"),
        ("delay-n", "0", "timing.computational_delay_s", "0.0"),
        ("encoder", "4096", "encoder.counts_per_rev", "4096"),
        ("encoder", "none", "encoder.counts_per_rev", None),
        ("encoder", "40000", "encoder.counts_per_rev", "40000"),
    ):
        choose(page, control, choice)
        found = value(page, path)
        check(found == wanted and shown(page) == "", f"{control} {choice}: {path} = {found}")
    check("Nobody holds" not in page.run("document.getElementById('warnings').textContent"), "somebody holds the knob again")
    for control, path, on in (("friction", "device.friction.kinetic_n_m", lambda v: v is not None), ("guard", "law.guard.on", lambda v: v == "true")):
        before = on(value(page, path))
        click(page, control)
        page.wait(0.2)
        running(page)
        once = on(value(page, path))
        click(page, control)
        page.wait(0.2)
        running(page)
        check(once != before and on(value(page, path)) == before, f"{control}: off and on")
    choose(page, "other", "spring")
    check(page.run("runs.length") == 2 and page.run("runs[1].title").startswith("spring"), "a second law beside it")
    choose(page, "other", "")
    check(page.run("runs.length") == 1, "and away again")
    page.run("document.getElementById('all').open = true")
    page.wait(0.2)
    shown_fields = page.run("document.querySelectorAll('#fields label').length")
    check(shown_fields > 40, f"all settings: {shown_fields} fields")
    page.run("(() => { const label = [...document.querySelectorAll('#fields label')].find((l) => l.textContent.startsWith('law.energy_credit_j'));"
             " const input = label.querySelector('input'); input.value = '-3'; input.dispatchEvent(new Event('change')); })()")
    page.wait(0.3)
    check("law.energy_credit_j" in shown(page) and page.run("runs[0].ring.size") > 0, f"a wrong value is refused: {shown(page)}")
    page.run("document.getElementById('all').open = false")
    page.key("0")
    page.wait(0.2)
    running(page)
    choose(page, "strength", "1", "input")
    check(page.run("chosen.strength") == 1, "strength of the push")
    choose(page, "strength", "0.3", "input")


def transport(page):
    click(page, "run")
    page.wait(0.2)
    before = page.run("counted.done")
    for _ in range(3):
        click(page, "step")
    page.wait(0.1)
    check(page.run("counted.done") == before + 3, "paused; three single ticks are three ticks")
    page.key(".")
    page.wait(0.1)
    check(page.run("counted.done") == before + 4, "and one by the keyboard")
    page.key(" ")
    page.wait(0.3)
    check(page.run("counted.done") > before + 100 and page.run("running"), "runs again")
    choose(page, "speed", "0.05")
    start = page.run("[counted.done, performance.now()]")
    page.wait(2)
    end = page.run("[counted.done, performance.now()]")
    rate = 1e3 * (end[0] - start[0]) / (end[1] - start[1])
    check(40 < rate < 60, f"slow motion: {rate:.1f} ticks a second of 50")
    choose(page, "speed", "1")
    click(page, "automatic")
    page.wait(3.2)
    check(page.run("runs[0].last.force_n_m") > 0.05, "it presses by itself")
    click(page, "reset")
    page.wait(0.3)
    page.key("p")
    click(page, "sound")
    page.wait(0.5)
    if page.hears or page.run("audio.state") == "running":
        check(page.run("audio.state") == "running", "the force is heard")
    else:
        print(f"NOT RUN: {page.name} has no sound device here")
    page.key("s")
    page.wait(0.2)
    check(page.run("audio.state") == "suspended" and page.run("document.getElementById('sound').getAttribute('aria-pressed')") == "false", "and silent again")
    backwards(page)
    page.key("0")
    running(page)


def backwards(page):
    """Checks that turning a run with two control laws back and forth gives the same numbers to the bit."""
    page.key("6")
    running(page)
    page.until("runs[0].last.force_n_m > 0.05")
    click(page, "run")
    page.wait(0.2)
    now = "JSON.stringify(runs.map((r) => COLUMNS.map((name) => String(r.last[name]))))"

    def forward(ticks):
        page.run(f"for (let i = 0; i < {ticks}; i += 1) tell('step')")
        page.wait(0.5)
        return page.run(now)

    there = page.run(now)
    page.key("b")
    page.until(f"runs[0].last.clock < JSON.parse({there!r})[0][0] - 0.099")
    page.key(",")
    page.wait(0.3)
    first = page.run(now)
    gone = page.run(f"Math.round(1e3 * (JSON.parse({there!r})[0][0] - runs[0].last.clock))")
    again = forward(101)
    check(gone == 101 and again == there != first, f"{gone} ticks back and forth again: {len(json.loads(there))} laws, {len(json.loads(there)[0])} numbers each, the same to the bit")
    choose(page, "delay-n", "1")
    page.key(",")
    page.until("document.getElementById('record-told').textContent.startsWith('A setting was changed')")
    choose(page, "delay-n", "0")


def hands(page):
    """Checks the four ways to turn the knob."""
    def depth():
        return page.run("1e3 * (runs[0].last.angle_rad - runs[0].facts.surface_rad)")

    def released(words):
        page.key("h")
        page.wait(0.7)
        check(depth() < 0, f"{words}; let go, it comes out: {depth():.1f} mrad")

    released("keyboard")
    page.key("ArrowRight", hold=0.8)
    page.wait(0.3)
    inside = depth()
    check(inside > 0, f"the arrow key pushes in: {inside:.2f} mrad")
    released("keyboard")
    box = page.run("(() => { const b = document.getElementById('stage').getBoundingClientRect(), k = stage.knobs[0]; return [b.left + k.x, b.top + k.y, k.r]; })()")
    x, y, r = box
    page.mouse("down", x, y - 0.7 * r)
    for i in range(12):
        page.mouse("move", x + 0.07 * i * r, y - 0.7 * r)
        page.wait(0.02)
    page.wait(0.5)
    inside = depth()
    check(inside > 0, f"the mouse pushes in: {inside:.2f} mrad")
    page.mouse("up", x + r, y)
    released("mouse")
    for _ in range(12):
        page.wheel(x, y, 100)
    page.wait(0.5)
    check(depth() > 0, f"the wheel pushes in: {depth():.2f} mrad")
    released("wheel")
    if not page.touches:
        return
    page.touch("start", x, y - 0.7 * r)
    for i in range(12):
        page.touch("move", x + 0.07 * i * r, y - 0.7 * r)
        page.wait(0.02)
    page.wait(0.5)
    check(depth() > 0, f"a finger pushes in: {depth():.2f} mrad")
    page.touch("end", 0, 0)
    page.wait(0.5)


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}


def same(a, b):
    return struct.pack("<d", a) == struct.pack("<d", b) or (a != a and b != b)


def record(page, program, folder):
    for law in ("enhanced-sfa", "spring"):
        for file in glob.glob(os.path.join(folder, "live-*")):
            os.remove(file)
        choose(page, "law", law)
        page.key("c")
        page.wait(0.3)
        page.key("ArrowRight", hold=1.0)
        page.wait(0.5)
        page.key("ArrowLeft", hold=0.3)
        page.wait(0.5)
        page.key("c")
        page.until("recorded !== null && !recording")
        click(page, "csv")
        click(page, "scene")
        paths = [os.path.join(folder, f"live-a.{end}") for end in ("csv", "toml")]
        for _ in range(100):
            if all(os.path.isfile(path) for path in paths):
                break
            page.wait(0.1)
        out = os.path.join(folder, f"again-{law}")
        done = subprocess.run([program, "run", paths[1], "--out", out], capture_output=True, text=True)
        check(done.returncode == 0, f"the recorded scene runs {done.stderr.strip()[-200:]}")
        if done.returncode:
            continue
        with open(paths[0], encoding="ascii") as file:
            bare = [cell for row in list(csv.reader(file))[1:] for cell in row if cell.lstrip("-").isdigit()]
        check(not bare, f"{law}: each number of the record has a decimal point {bare[:1]}")
        live, again = read(paths[0]), read(glob.glob(os.path.join(out, "traces", "*.csv"))[0])
        differing = [name for name in live if len(live[name]) != len(again[name]) or not all(map(same, live[name], again[name]))]
        touched = sum(force != 0 for force in live["force_n_m"])
        check(not differing and touched > 100 and list(live) == list(again),
              f"{law}: {len(live['time_s'])} ticks recorded, {touched} with a force, {len(live)} columns the same to the bit in the program {differing}")


def opened_files(page, program, folder):
    """Checks opened files: a record of the same scene gives the same forces, a recording of a board is drawn, any other file is refused."""
    page.put_file("file", os.path.join(folder, "live-a.csv"))
    page.until("openedFile !== null && runs.length === 2 && runs[1].file && openedFile.at > 1500", 30)
    at, compared, differing = page.run("[openedFile.at, openedFile.compared, openedFile.differing]")
    moved = page.run("Math.max(...runs[1].ring.columns.force_n_m)")
    check(compared > 1500 and differing == 0 and moved > 0.02, f"the last record, opened: {at} rows, {compared} ticks compared, {differing} with another force")
    page.key("0")
    page.wait(0.3)
    running(page)
    check(page.run("openedFile") is None and page.run("runs.length") == 1, "and away again")
    board_csv = os.path.join(folder, "monitor.csv")
    with open(board_csv, "w", encoding="ascii") as file:
        file.write("tick,time_s,count,penetration_rad,force_n_m,offset_rad,energy_observed_j,state\n")
        file.writelines(f"{i},{i / 1000},{i},{1e-4 * (i % 300 - 100)},{1e-3 * (i % 7)},0,0,armed\n" for i in range(1500) if i not in range(400, 450))
    page.put_file("file", board_csv)
    page.until("runs.length === 2 && openedFile.at === openedFile.length", 30)
    check(page.run("runs[1].last.force_n_m") == 0.001 * (1499 % 7), "an opened recording of a board")
    wrong = os.path.join(folder, "wrong.csv")
    with open(wrong, "w", encoding="ascii") as file:
        file.write("a,b\n1,2\n")
    page.key("0")
    running(page)
    page.put_file("file", wrong)
    page.until("!document.getElementById('error').hidden")
    check("it needs time_s" in shown(page), f"another file is refused: {shown(page)}")
    page.run("complain('')")


def link(page, url):
    page.key("6")
    page.wait(0.2)
    running(page)
    choose(page, "grip", "firm")
    address = page.run("location.hash")
    page.go("about:blank")
    page.go(url + address)
    page.wait(0.5)
    running(page)
    check(value(page, "operator.grip") == "firm" and value(page, "wall.k_desired_n_m_per_rad") == "14.0" and page.run("runs.length") == 2,
          f"a link carries the settings: {address}")
    click(page, "link")


def looks(page, pictures):
    """Checks that nothing sticks out of a narrow or wide page, and takes pictures, also in the dark colour scheme."""
    for width in (400, 800, 1600):
        page.size(width, 900)
        page.wait(0.4)
        over = page.run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        check(over <= 0, f"{width} px wide: nothing sticks out ({over})")
        if pictures:
            page.picture(os.path.join(pictures, f"width-{width}.png"), whole=True)
    page.size(1280, 900)
    page.dark()
    page.wait(0.6)
    if pictures:
        page.picture(os.path.join(pictures, "dark.png"))


def simulated(browser, program, seconds, asked_for, pictures):
    """Tests the page of a simulated knob with one axis."""
    with tempfile.TemporaryDirectory() as folder:
        url = page_file(program, folder)
        page = browser(url, downloads=folder)
        try:
            newcomer(page)
            presets(page, pictures)
            feels(page, pictures)
            drawing(page, pictures)
            controls(page)
            transport(page)
            hands(page)
            record(page, program, folder)
            opened_files(page, program, folder)
            link(page, url)
            pace(page, seconds, asked_for, check)
            looks(page, pictures)
            still(page, url)
            check(not page.problems, f"no complaint of {page.name} {page.problems[:3]}")
        finally:
            page.close()


def newcomer(page):
    """Checks that a newly opened page soon simulates a wall that pushes back, without any setting."""
    page.until("typeof runs !== 'undefined' && runs.length > 0 && runs[0].last !== null", 60)
    there = page.run("performance.now() / 1e3")
    page.until("runs[0].last.force_n_m > 0.01", 10)
    check(page.run("chosen.automatic && aim === null"), "it presses by itself before anybody touched it")
    page.key("ArrowRight", hold=0.5)
    check(page.run("!chosen.automatic"), "and no more once somebody did")
    page.until("runs[0].last.force_n_m > 0.01", 10)
    pushed = page.run("performance.now() / 1e3")
    page.key("h")
    page.wait(0.7)
    check(page.run("runs[0].last.force_n_m") == 0, "and lets go")
    check(there < MOST_WAIT_S, f"a newcomer's page: ticks {there:.2f} s after it was opened, a wall under the arrow key {pushed:.2f} s after")


def still(page, url):
    """Checks that the knob does not move by itself for a user who asks for reduced motion."""
    if not page.stills:
        return
    page.still()
    page.go("about:blank")
    page.go(url)
    page.until("typeof runs !== 'undefined' && runs.length > 0 && runs[0].last !== null", 60)
    start = page.run("runs[0].last.angle_rad")
    page.wait(2)
    check(page.run("runs[0].last.angle_rad") == start and page.run("!chosen.automatic"), "with less motion wanted, it waits to be touched")


def page_file(program, folder):
    file = os.path.join(folder, "page.html")
    started = time.monotonic()
    subprocess.run([program, "--quiet", "live", "--no-open", "--out", file], check=True)
    print(f"     touchstone live: {time.monotonic() - started:.2f} s")
    size = os.path.getsize(file)
    check(size <= MOST_BYTES, f"the page has {size} bytes")
    return f"file://{file}"


def main():
    program, emulator, firmware = (None if path == "-" else os.path.abspath(path) for path in sys.argv[1:4])
    short = sys.argv[4:] == ["--short"]
    asked_for = len(sys.argv) > 4 and not short
    seconds = float(sys.argv[4]) if asked_for else 5 if short else 20
    pictures = sys.argv[5] if len(sys.argv) > 5 else None
    if not firmware and not short:
        print("NOT RUN: the firmware's board path; there is no emulator here")
    browsers = [browser for find, browser in ((chromium.find, chromium.Chromium), (firefox.find, firefox.Firefox)) if find()]
    for browser in (chromium.Chromium, firefox.Firefox):
        if browser not in browsers and browsers and not short:
            print(f"NOT RUN: no {browser.name} here: install it, or name one in {browser.name.upper()}")
    if short:
        browsers = browsers[:1]
    for browser in browsers:
        print(f"-- {browser.name}")
        its = os.path.join(pictures, browser.name.lower()) if pictures else None
        if its:
            os.makedirs(its, exist_ok=True)
        # Only the first browser runs the emulated firmware and the long measurement of frames.
        first = browser is browsers[0]
        board(browser, program, its, check)
        with tempfile.TemporaryDirectory() as folder:
            serial(browser, program, its, folder, check)
            if firmware and first:
                emulated(browser, program, emulator, firmware, its, folder, check)
            report(browser, program, its, folder, check)
            space(browser, program, its, folder, min(seconds, 5), asked_for, check)
            editor(browser, program, its, folder, check)
        simulated(browser, program, seconds if first else min(seconds, 5), asked_for, its)
    if not browsers:
        print("NOT RUN: neither Chromium nor Firefox here: install one, or name it in CHROMIUM or FIREFOX")
        return 77
    print(f"the pages: {len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
