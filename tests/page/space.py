"""Tests the web page of the simulated device with three axes: every control, the four ways to move the hand, and how the page looks."""

import json
import os
import subprocess

from pace import MOST_CALLS_SPACE, worst_second


def text(page, element):
    return page.run(f"document.getElementById({element!r}).textContent")


def choose(page, control, value, event="change"):
    page.run(f"(() => {{ const c = document.getElementById({control!r}); if (c.type === 'checkbox') c.checked = {value!r} === 'true'; else c.value = {value!r}; c.dispatchEvent(new Event({event!r}, {{ bubbles: true }})); }})()")
    page.wait(0.2)
    page.until("!pending")


def click(page, control):
    page.run(f"document.getElementById({control!r}).click()")
    page.wait(0.1)


def rest(page):
    return page.run("['x', 'y', 'z'].map((axis) => run.last[`rest_${axis}_mm`])")


def presses(page, pictures, check):
    """Presses every virtual object with every control law that the page explains."""
    for thing in ("sphere", "plane", "inclined"):
        choose(page, "object", thing)
        if page.run("chosen.automatic") is False:
            click(page, "automatic")
        page.until("run.last && run.last.clock % 7 > 1.6 && run.last.clock % 7 < 2.0", 15)
        shown, force, given = page.run("[run.last.force_n / run.last.depth_mm, run.last.force_n, 1e3 * run.got]")
        check(abs(shown - 25) < 1.5 and force > 3, f"{thing}: shows {shown:.2f} of 25 N/mm at {force:.2f} N; at most {given:.3f} mJ given beyond what was taken")
        off = page.run("(() => { const r = run.last, f = ['x', 'y', 'z'].map((a) => r[`force_${a}_n`]), d = ['x', 'y', 'z'].map((a) => r[`surface_${a}_mm`] - r[`hip_${a}_mm`]); return Math.acos(Math.min(1, dot(f, d) / Math.hypot(...f) / Math.hypot(...d))); })()")
        off = 9.0 if off is None else off
        check(off < 0.1, f"{thing}: the force points to the surface point, {off:.3f} rad off")
        page.wait(1.8)
        if pictures:
            page.picture(os.path.join(pictures, f"space-{thing}.png"))
    choose(page, "object", "sphere")
    check(page.run("run.facts.states === 'estimated' && document.getElementById('law').value === 'shipped'"), "three axes: it begins with the shipped wall")
    for law in page.run("run.facts.laws"):
        choose(page, "law", law)
        check(page.run("run.facts.law") == law and page.run("document.getElementById('error').hidden"), f"law {law}")
    page.until("run.last && run.last.clock % 7 > 1.6 && run.last.clock % 7 < 2.0", 15)
    check(page.run("run.facts.states") == "measured", "a law by its name has the thesis' settings")
    choose(page, "law", "shipped")
    check(page.run("run.facts.states") == "estimated", "and back to the shipped wall")


def controls(page, check):
    choose(page, "stiffness-n", "10")
    check(page.run("run.facts.k_desired_n_per_m") == 10000, "a stiffness")
    choose(page, "stiffness", "1.3")
    check(abs(page.run("run.facts.k_desired_n_per_m") - 20000) < 200, "by the slider")
    choose(page, "stiffness-n", "-3")
    check("k_desired_n_per_m" in text(page, "error") and page.run("run.facts.k_desired_n_per_m") > 19000, f"a wrong one is refused: {text(page, 'error')}")
    choose(page, "stiffness-n", "25")
    check(page.run("document.getElementById('error').hidden"), "and forgotten with a right one")
    for control, fact in (("per-axis", "per_axis"), ("guard", "guard")):
        was = page.run(f"run.facts.{fact}")
        choose(page, control, str(not was).lower())
        once = page.run(f"run.facts.{fact}")
        choose(page, control, str(was).lower())
        check(once is not was and page.run(f"run.facts.{fact}") is was, f"{control}: on and off")
    surface(page, check)
    click(page, "run")
    page.wait(0.2)
    before = page.run("counted.done")
    for _ in range(3):
        click(page, "step")
    page.key(".")
    page.wait(0.1)
    check(page.run("counted.done") == before + 4, "paused; four single ticks are four ticks")
    page.key(" ")
    page.wait(0.3)
    check(page.run("counted.done") > before + 100, "runs again")
    choose(page, "speed", "0.05")
    start = page.run("[counted.done, performance.now()]")
    page.wait(2)
    end = page.run("[counted.done, performance.now()]")
    rate = 1e3 * (end[0] - start[0]) / (end[1] - start[1])
    check(40 < rate < 60, f"slow motion: {rate:.1f} ticks a second of 50")
    choose(page, "speed", "1")
    click(page, "reset")
    page.wait(0.2)
    check(page.run("run.last.clock") < 0.6, "starts again")
    seen = page.run("[view.camera.yaw, view.camera.pitch]")
    for control in ("turn-right", "turn-up"):
        click(page, control)
    page.key("q", hold=0.4)
    page.key("x", hold=0.3)
    now = page.run("[view.camera.yaw, view.camera.pitch]")
    check(abs(now[0] - seen[0]) > 0.05 and abs(now[1] - seen[1]) > 0.05, f"the view turns, by buttons and keys: {seen} to {now}")
    for control in ("turn-left", "turn-down"):
        click(page, control)
    page.run("(() => { Object.assign(view.camera, new Camera()); })()")


def surface(page, check):
    """Chooses a texture and a material, and opens the link with them."""
    ridges = "Math.max(...Array.from({ length: Math.min(1500, run.ring.size) }, (_, i) => Math.abs(Math.hypot(...['x', 'y', 'z'].map((axis) => run.ring.at(`surface_${axis}_mm`, i))) - 30)))"
    choose(page, "texture", "0.5/5")
    page.until("run.ring.size > 1500 && run.last.depth_mm > 0", 15)
    page.wait(2)
    felt = page.run(ridges)
    check(0.2 < felt < 0.3, f"a texture of 0.5 mm: ridges of {felt:.3f} mm over the sphere, grooves below")
    for material in ("rubber", "wood", "metal"):
        choose(page, "material", material)
        check(page.run("document.getElementById('error').hidden && choice().includes('impact_vibration_hz=' + { rubber: 20, wood: 40, metal: 100 }[chosen.material])"), f"material {material}")
    link = page.run("location.hash")
    choose(page, "per-axis", "true")
    check(page.run("document.getElementById('material').disabled"), "one law for each axis has no material")
    choose(page, "per-axis", "false")
    for control, value in (("texture", ""), ("material", "")):
        choose(page, control, value)
    page.run(f"(() => {{ location.hash = {link!r}; }})()")
    page.until("!pending && document.getElementById('texture').value === '0.5/5' && document.getElementById('material').value === 'metal'", 10)
    check("metal" in link, f"a link carries texture and material: {link}")
    for control, value in (("texture", ""), ("material", "")):
        choose(page, control, value)


def saved(page, program, folder, check):
    """Saves the settings as scenes, which the program reads and runs. Settings that no scene has are refused with the control to change."""
    file = os.path.join(folder, "live-three-axes.toml")

    def scene():
        if os.path.exists(file):
            os.remove(file)
        page.run("document.getElementById('scene').focus()")
        if page.presses:
            page.key(" ")
        else:
            click(page, "scene")
        for _ in range(50):
            if os.path.exists(file) and os.path.getsize(file):
                break
            page.wait(0.1)
        said = text(page, "link-told")
        if not os.path.exists(file):
            return {}, said
        done = subprocess.run([program, "--json", "run", file, "--print"], capture_output=True, text=True)
        return json.loads(done.stdout) if done.returncode == 0 else {"refused": done.stderr}, said

    for control, value in (("object", "inclined"), ("texture", "0.1/2"), ("material", "metal")):
        choose(page, control, value)
    shown, said = scene()
    law, thing = shown.get("law", {}), shown.get("object", {})
    check(thing.get("kind") == "inclined" and thing.get("texture", {}).get("period_mm") == 2 and law.get("approach") == "shipped"
          and law.get("impact", {}).get("vibration_hz") == 100 and f"touchstone run {os.path.basename(file)}" in said, f"saves the shipped wall with texture and material: {shown}, {said}")
    out = subprocess.run([program, "--json", "run", file, "--expect", "passive"], capture_output=True, text=True)
    check(out.returncode == 0, f"touchstone run runs it: {out.returncode} {out.stderr}")
    for control, other, own, named in (("guard", "false", "true", "tick Energy guard"), ("per-axis", "true", "false", "clear One law for each axis"), ("stiffness-n", "10", "25", "tuned for 25 N/mm")):
        choose(page, control, other)
        shown, said = scene()
        check(not shown and named in said, f"{control} {other} is in no scene: {said}")
        choose(page, control, own)
    choose(page, "law", "enhanced-sfa")
    check("clear Energy guard" in scene()[1], "a thesis' law with a guard is in no scene")
    choose(page, "guard", "false")
    choose(page, "stiffness-n", "12.5")
    for law, axes, approach in (("enhanced-sfa", "false", "magnitude"), ("enhanced-sfa", "true", "per-axis"), ("spring", "false", "spring"), ("spring-damper", "false", "spring-damper")):
        choose(page, "law", law)
        choose(page, "per-axis", axes)
        shown, said = scene()
        own = shown.get("law", {})
        damped = page.run("/^virtual_damping_n_s_per_m=0(\\.0*)?$/m.test(choice())") is False
        check(damped == (law == "spring-damper"), f"{law}: {'with' if damped else 'without'} virtual damping")
        check((own.get("approach"), own.get("k_desired_n_per_mm"), own.get("impact")) == (approach, 12.5, None), f"saves {approach}: {shown}, {said}")
    choose(page, "law", "tdpa")
    check("there is no law tdpa" in scene()[1], "a law without an approach is in no scene")
    choose(page, "law", "spring")
    choose(page, "per-axis", "true")
    check("only the law enhanced-sfa" in scene()[1], "a spring for each axis is in no scene")
    for control, value in (("per-axis", "false"), ("guard", "true"), ("law", "shipped"), ("stiffness-n", "25"), ("object", "sphere"), ("texture", ""), ("material", "")):
        choose(page, control, value)


def refused(page, url, check):
    """Opens a link whose settings are refused: the page says so and starts with its own, with the hand at the start position."""
    if page.stills:
        # Otherwise the simulated hand presses, and the page puts it at the start position for that.
        page.still()
    page.go("about:blank")
    page.go(f"{url}#set=k_desired_n_per_m=-1")
    page.until("typeof runs !== 'undefined' && runs.length > 0 && run.ring.size > 100 && !pending")
    told, stiffness, beside = page.run("[document.getElementById('error').textContent, run.facts.k_desired_n_per_m, Math.max(...Array.from({ length: run.ring.size }, (_, i) => Math.hypot(...['x', 'y', 'z'].map((axis, k) => run.ring.at(`rest_${axis}_mm`, i) - run.facts.start_mm[k]))))]")
    check("k_desired_n_per_m" in told and stiffness == 25000, f"a link with refused settings opens the shipped wall: {told}")
    if page.stills:
        check(beside == 0, f"and the hand starts {beside:.1f} mm beside the start position")


def left_out(page, url, check):
    """Opens links with values that the page does not have: it names each, and everything else is as the link or the page's default says."""
    hold = "[chosen.object, chosen.texture, chosen.material, run.facts.k_desired_n_per_m, document.getElementById('error').textContent]"
    page.go("about:blank")
    page.go(f"{url}#object=plane&texture=0.2/3&material=stone&colour=red&set=k_desired_n_per_m=10000")
    page.until("typeof runs !== 'undefined' && runs.length > 0 && !pending")
    *held, told = page.run(hold)
    check(held == ["plane", "", "", 10000] and all(word in told for word in ("texture=0.2/3", "material=stone", "colour=red")), f"a link with unknown values: {held}, {told}")
    choose(page, "texture", "0.5/5")
    check(page.run("document.getElementById('error').hidden"), "and forgotten with the next choice")
    page.run("(() => { location.hash = '#material=wood&texture=stone'; })()")
    page.until("chosen.material === 'wood' && !pending")
    *held, told = page.run(hold)
    check(held == ["sphere", "", "wood", 25000] and "texture=stone" in told, f"a link in the open page: what it does not name is as shipped: {held}, {told}")
    for setting in ("texture_height_mm=0.1", "impact_vibration=0.3", "rate_hz=10000", "guard=true\nrate_hz=10000"):
        page.run(f"(() => {{ history.replaceState(null, '', '#'); location.hash = new URLSearchParams([['set', {setting!r}]]); }})()")
        page.until("!document.getElementById('error').hidden && !pending")
        told, rate, changes = page.run("[document.getElementById('error').textContent, run.facts.rate_hz, chosen.changes.size]")
        check(setting in told and rate == 1000 and changes == 0, f"a setting without a control: {told!r}")
        choose(page, "object", "plane")
    for link, shown in (("set=law=fba", "fba"), ("base=thesis", "enhanced-sfa"), ("base=shipped", "shipped")):
        page.run(f"(() => {{ location.hash = {link!r}; }})()")
        page.until(f"document.getElementById('law').value === {shown!r} && !pending")
        states, law = page.run("[run.facts.states, run.facts.law]")
        check((states, law) == ("estimated" if shown == "shipped" else "measured", law if shown == "shipped" else shown), f"{link}: the list of laws shows {shown}, which acts")


def hands(page, check):
    page.key("h")
    page.wait(1)
    start = rest(page)
    page.key("ArrowRight", hold=0.5)
    page.key("ArrowDown", hold=0.5)
    page.key("i", hold=0.3)
    page.wait(0.4)
    moved = [b - a for a, b in zip(start, rest(page))]
    right, up, away = page.run("['right', 'up', 'away'].map((way) => dot(view.camera[way], " + repr(moved) + "))")
    check(right > 5 and up < -5 and away > 3, f"keys move the hand: {right:.1f} mm right, {up:.1f} up, {away:.1f} away")
    page.key("h")
    page.wait(1)
    check(max(abs(a - b) for a, b in zip(start, rest(page))) < 0.5, "let go, it goes back")
    x, y = page.run("(() => { const b = document.getElementById('stage').getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; })()")
    page.mouse("down", x, y - 100)
    for i in range(1, 13):
        page.mouse("move", x, y - 100 + 9 * i)
        page.wait(0.02)
    page.wait(0.6)
    force, depth = page.run("[run.last.force_n, run.last.depth_mm]")
    page.mouse("up", x, y)
    check(force > 0.5 and depth > 0, f"the mouse pushes in: {force:.2f} N at {depth:.3f} mm")
    page.wait(0.8)
    check(page.run("run.last.force_n") == 0, "and lets go")
    for _ in range(6):
        page.wheel(x, y, -100)
    page.wait(0.5)
    away = page.run("dot(view.camera.away, " + repr([b - a for a, b in zip(start, rest(page))]) + ")")
    check(away > 5, f"the wheel moves it away: {away:.1f} mm")
    page.key("h")
    page.wait(0.3)


def space(browser, program, pictures, folder, seconds, asked_for, check):
    file = os.path.join(folder, "space.html")
    subprocess.run([program, "--quiet", "live", "--dof", "3", "--no-open", "--out", file], check=True)
    check(os.path.getsize(file) <= 1_500_000, f"the page of three axes has {os.path.getsize(file)} bytes")
    page = browser(f"file://{file}", downloads=folder)
    try:
        # Before its script runs, the page's button named `run` is the value of `run`, and has no force.
        page.until("typeof run !== 'undefined' && run?.last?.force_n > 0.5", 20)
        check(page.run("chosen.automatic && aim === null"), "three axes: it presses by itself before anybody touched it")
        presses(page, pictures, check)
        controls(page, check)
        saved(page, program, folder, check)
        hands(page, check)
        click(page, "automatic")
        worst_second(page, seconds, asked_for, check, "three axes", MOST_CALLS_SPACE)
        for width in (400, 800, 1600):
            page.size(width, 900)
            page.wait(0.4)
            over = page.run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
            check(over <= 0, f"three axes, {width} px wide: nothing sticks out ({over})")
            if pictures:
                page.picture(os.path.join(pictures, f"space-{width}.png"), whole=True)
        page.size(1280, 1000)
        page.dark()
        page.wait(0.5)
        if pictures:
            page.picture(os.path.join(pictures, "space-dark.png"))
        refused(page, f"file://{file}", check)
        left_out(page, f"file://{file}", check)
        check(not page.problems, f"no complaint of {page.name} {page.problems[:3]}")
    finally:
        page.close()
