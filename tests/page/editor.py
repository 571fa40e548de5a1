"""Tests the page of `touchstone feels edit`: every part of a feel is drawn, and is added, changed, removed and undone by keys alone."""

import os
import subprocess

# For every part of the editor: its checkbox, one of its fields, a text to type there, the path of this field in the scene, its
# value afterwards, and a JavaScript condition that holds while the part is drawn.
PARTS = (
    ("wall2", "at_rad", "35", "environment.wall2.at_rad", 0.610865, "walls(runs[0].facts).length > 0"),
    ("endstops", "upper_rad", "90", "environment.endstops.upper_rad", 1.570796, "walls(runs[0].facts).length === 2"),
    ("detents", "per_rev", "12", "environment.detents.per_rev", 12, "runs[0].parts.detents !== null"),
    ("click", "strength_n_m", "9", "environment.click.strength_n_m", 0.009, "runs[0].parts.clicks !== null"),
    ("spring", "stiffness_n_m_per_rad", "40", "environment.spring.stiffness_n_m_per_rad", 0.04, "runs[0].parts.spring !== null"),
    ("dry_friction", "strength_n_m", "4", "environment.dry_friction.strength_n_m", 0.004, "runs[0].parts.friction !== null"),
    ("damper", "damping_n_m_s_per_rad", "0.3", "environment.damper.damping_n_m_s_per_rad", 0.0003, "runs[0].parts.damper !== null"),
    ("inertia", "inertia_kg_m2", "50", "environment.inertia.inertia_kg_m2", 5e-6, "runs[0].parts.inertia !== null"),
    ("first_wall", "surface_rad", "40", "wall.surface_rad", 0.698132, "runs[0].facts.has_wall === 1"),
)


def settled(page):
    page.until("typeof runs !== 'undefined' && runs.length > 0 && !pending && runs[0].ring.size > 20")


def shown(page):
    return page.run("document.getElementById('error').hidden ? '' : document.getElementById('error').textContent")


# Whether the knob's picture differs from that of the same run without the part.
DRAWN = """(() => {
  const shot = (run) => { stage.draw([run], null); return document.getElementById('stage').toDataURL(); };
  // The lens eases to its width.
  for (let i = 0; i < 100; i += 1) stage.draw([runs[0]], null);
  const facts = { ...runs[0].facts, has_wall: 0, wall2_rad: NaN, lower_end_rad: NaN, upper_end_rad: NaN };
  return shot(runs[0]) !== shot({ ...runs[0], facts, parts: {}, profile: null });
})()"""


def editor(browser, program, pictures, folder, check):
    file = os.path.join(folder, "feel.html")
    subprocess.run([program, "--quiet", "feels", "edit", "smooth", "--no-open", "--out", file], check=True)
    page = browser(f"file://{file}", downloads=folder)
    try:
        page.until("typeof runs !== 'undefined' && runs.length > 0 && runs[0].last !== null", 60)
        check(page.run("document.getElementById('draw').open && document.getElementById('head').textContent") == "A feel under your hand", "the page of a feel opens with its editor")
        page.key("p")
        page.key("h")
        page.run("run(false)")
        check(not page.run(DRAWN), "a feel without parts: nothing is drawn around the knob")
        for name, field, typed, path, wanted, drawn in PARTS:
            one(page, name, field, typed, path, wanted, drawn, check)
        listed(page, check)
        for name, *_ in PARTS:
            tick(page, name)
        page.run("document.getElementById('part-profile').click()")
        page.wait(0.2)
        settled(page)
        check(page.run("runs[0].profile !== null && !document.getElementById('profile-part').hidden") and shown(page) == "", "all parts at once, with a drawn torque")
        marks = page.run("[...document.querySelectorAll('[data-part]')].filter((mark) => mark.hidden).length")
        check(marks == 0, "the key explains every part of the picture")
        page.run("run(true)")
        page.run("setAim(0.5)")
        page.wait(0.8)
        if pictures:
            page.picture(os.path.join(pictures, "editor.png"), whole=True)
        for width in (400, 1280):
            page.size(width, 900)
            page.wait(0.4)
            over = page.run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
            check(over <= 0, f"the editor at {width} px: nothing sticks out ({over})")
            if pictures and width == 400:
                page.picture(os.path.join(pictures, "editor-400.png"), whole=True)
        refused(page, check)
        steps = page.run("steps.length")
        for _ in range(steps):
            undo(page)
        left = page.run("PARTS.filter((part) => hasPart(fields, part)).length")
        check(left == 0 and page.run("document.getElementById('undo').disabled"), f"{steps} steps undone: the feel of the beginning, {left} parts")
        check(not page.problems, f"no complaint of {page.name} {page.problems[:3]}")
    finally:
        page.close()


def tick(page, name):
    page.run(f"document.getElementById('part-{name}').focus()")
    if page.presses:
        page.key(" ")
    else:
        page.run(f"document.getElementById('part-{name}').click()")
    page.wait(0.2)
    settled(page)


def undo(page):
    page.run("document.getElementById('undo').click()")
    page.wait(0.1)
    settled(page)


def one(page, name, field, typed, path, wanted, drawn, check):
    """Checks one part: added by the space bar, changed by typing, drawn, undone, added again, removed."""
    tick(page, name)
    there, differs = page.run(drawn), page.run(DRAWN)
    page.run(f"(() => {{ const c = document.getElementById('part-{name}-{field}'); c.focus(); c.value = {typed!r}; c.dispatchEvent(new Event('change', {{bubbles: true}})); }})()")
    page.wait(0.2)
    settled(page)
    became = float(page.run(f"fields.get({path!r}).value"))
    check(abs(became - wanted) < 1e-5 and there and differs and shown(page) == "", f"part {name}: added, drawn, and {path} = {became}")
    undo(page)
    before = float(page.run(f"fields.get({path!r}).value"))
    undo(page)
    gone = not page.run(f"hasPart(fields, PARTS.find((part) => part.table === 'environment.{name}'))")
    check(abs(before - wanted) > 1e-9 and gone, f"part {name}: undone twice")
    tick(page, name)
    tick(page, name)
    gone = not page.run(f"hasPart(fields, PARTS.find((part) => part.table === 'environment.{name}'))")
    check(gone and shown(page) == "", f"part {name}: added and removed")


def listed(page, check):
    """Checks the listed detents: five are added by the space bar and drawn, their angles are typed as a list, and an overlap is refused."""
    tick(page, "detent_list")
    there = page.run("runs[0].parts.detents?.angles?.length === 5 && runs[0].profile !== null")
    check(there and page.run(DRAWN) and shown(page) == "", "five listed detents: added and drawn")

    def types(field, text):
        page.run(f"(() => {{ const c = document.getElementById('part-detent_list-{field}'); c.focus(); c.value = {text!r}; c.dispatchEvent(new Event('change', {{bubbles: true}})); }})()")
        page.wait(0.3)
        settled(page)
        return page.run("JSON.parse(fields.get('environment.detent_list.positions_rad').value).map((at) => Math.round(at * 180 / Math.PI)).join()")

    angles = types("positions_rad", "-60, -20, 20 65")
    check(angles == "-60,-20,20,65" and shown(page) == "", f"listed angles are typed: {angles}")
    angles = types("positions_rad", "0, 10")
    check(angles == "-60,-20,20,65" and "overlap" in shown(page), f"an overlap is refused: {shown(page)}")
    page.run("complain('')")
    page.run("document.activeElement.blur()")
    tick(page, "detent_list")
    check(not page.run("hasPart(fields, PARTS.find((part) => part.table === 'environment.detent_list'))"), "listed detents are removed")


def refused(page, check):
    """Checks that a refused value leaves the feel as it is, and is no step to undo."""
    before = page.run("[steps.length, fields.get('environment.detents.per_rev').value]")
    page.run("(() => { const c = document.getElementById('part-detents-per_rev'); c.value = '99999'; c.dispatchEvent(new Event('change')); })()")
    page.wait(0.4)
    settled(page)
    after = page.run("[steps.length, fields.get('environment.detents.per_rev').value]")
    check("environment.detents.per_rev" in shown(page) and before == after, f"too many detents are refused: {shown(page)}")
    page.run("complain('')")
