"""Measures whether a page keeps up: frames drawn and control periods (ticks) simulated in each second."""

import os

# Over minutes the page must keep up; in a few seconds the computer may be busy with something else. The number of frames per second
# depends on the computer, in particular without a graphics card, and is judged only on request (`cargo xtask page SECONDS`). Otherwise
# the page must go on drawing, and its canvas calls per frame are counted, which are the same on every computer.
LEAST_TICKS, LEAST_FRAMES, LEAST_FRAMES_LONG, LONG_S = 950, 30, 57, 300
LEAST_AT_ALL = 3
TRIES = 3
MOST_CALLS, MOST_CALLS_SPACE = 1_180, 940
# Load (number of waiting processes) above which frames and ticks are not judged. Drawing without a graphics card needs a whole processor.
BUSY = 2 * (os.cpu_count() or 1)

COUNT = """(() => {
  worker.postMessage({ type: "zero" });
  window.paced = [];
  let frames = 0, last = null, started = null;
  const beat = (now) => {
    if (window.paced === null) return;
    requestAnimationFrame(beat);
    frames += 1;
    started ??= now;
    if (last === null) { last = { now, frames, drawn: frames_drawn(), done: counted.done }; return; }
    if (now - last.now < 1000) return;
    const s = (now - last.now) / 1000;
    window.paced.push([s, (frames - last.frames) / s, (frames_drawn() - last.drawn) / s, (counted.done - last.done) / s, counted.late, counted.skipped]);
    last = { now, frames, drawn: frames_drawn(), done: counted.done };
  };
  const frames_drawn = () => drawn;
  setTimeout(() => requestAnimationFrame(beat), 300);
})()"""


# JavaScript that counts every call of a canvas' 2D context over some frames.
CALLS = """(() => {
  const own = CanvasRenderingContext2D.prototype, kept = [];
  window.asked = { calls: 0, from: drawn };
  for (const name of Object.getOwnPropertyNames(own)) {
    const it = Object.getOwnPropertyDescriptor(own, name);
    if (typeof it.value !== "function" || name === "constructor") continue;
    kept.push([name, it]);
    own[name] = function (...words) { window.asked.calls += 1; return it.value.apply(this, words); };
  }
  window.asked.end = () => {
    for (const [name, it] of kept) Object.defineProperty(own, name, it);
    return window.asked.calls / (drawn - window.asked.from);
  };
})()"""


def pace(page, seconds, asked_for, check):
    page.key("6")
    page.wait(1)
    page.until("runs.length > 1 && !pending")
    worst_second(page, seconds, asked_for, check, "two laws", MOST_CALLS)


def calls_a_frame(page, check, what, most):
    page.run(CALLS)
    page.until("drawn - asked.from >= 30", 30)
    calls = page.run("asked.end()")
    check(calls <= most, f"{what}: {calls:.0f} calls of a canvas for a frame (more than {most} fail)")


def counted(page, seconds):
    """Measures for some seconds. Returns a row per second: length in s, frames, drawn frames and ticks per second, late and skipped ticks so far."""
    page.run(COUNT)
    page.wait(seconds + 1.5)
    rows = page.run("paced")
    page.run("(() => { window.paced = null; })()")
    return rows


def worst_second(page, seconds, asked_for, check, what, most_calls):
    calls_a_frame(page, check, what, most_calls)
    # Without a requested measurement, another program may have used the processor, so a slow page is measured again.
    for _ in range(1 if asked_for else TRIES):
        rows = counted(page, seconds)
        took = sum(row[0] for row in rows)
        ticks, drawn = (sum(row[0] * row[column] for row in rows) / took for column in (3, 2))
        late, skipped = rows[-1][4], rows[-1][5]
        done = ticks * took
        keeps_up = ticks > LEAST_TICKS and late < 0.02 * done
        if keeps_up:
            break
    print(f"     worst second of {len(rows)}: {min(row[2] for row in rows):.1f} frames, {min(row[3] for row in rows):.1f} ticks; {len(page.problems)} complaints of {page.name}")
    told = f"{what} for {took:.1f} s: {ticks:.1f} ticks a second of 1000, {late} of {done:.0f} late by more than 10 ms ({100 * late / done:.3f} %), {skipped} skipped"
    load = os.getloadavg()[0]
    waited = f"not judged: {load:.1f} processes waited for {os.cpu_count()} processors"
    if keeps_up or asked_for or load <= BUSY:
        check(keeps_up, told)
    else:
        print(f"     {told}, {waited}")
    if not asked_for:
        check(drawn >= LEAST_AT_ALL, f"{drawn:.1f} frames a second drawn (60 wanted; judged by cargo xtask page SECONDS, here fewer than {LEAST_AT_ALL} fail)")
        return
    least = LEAST_FRAMES_LONG if seconds >= LONG_S else LEAST_FRAMES
    if drawn < least and load > BUSY:
        print(f"     {drawn:.1f} frames a second drawn, {waited}")
        return
    check(drawn >= least, f"{drawn:.1f} frames a second drawn (60 wanted; fewer than {least} fail here)")
