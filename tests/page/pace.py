"""Frames and ticks, second by second: what a page says of itself, counted from outside."""

import os

# Over some seconds the machine may be doing something else; over minutes the page must keep up.
LEAST_TICKS, LEAST_FRAMES, LEAST_FRAMES_LONG, LONG_S = 950, 30, 57, 300
# Drawing without a graphics card takes a processor: where others wait for one as well, frames say nothing of the page.
BUSY = 2.5 * (os.cpu_count() or 1)

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


def pace(page, seconds, check):
    page.key("6")
    page.wait(1)
    page.until("runs.length > 1 && !pending")
    worst_second(page, seconds, check, "two laws")


def worst_second(page, seconds, check, what):
    page.run(COUNT)
    page.wait(seconds + 1.5)
    rows = page.run("paced")
    page.run("(() => { window.paced = null; })()")
    took = sum(row[0] for row in rows)
    ticks, drawn = (sum(row[0] * row[column] for row in rows) / took for column in (3, 2))
    late, skipped = rows[-1][4], rows[-1][5]
    done = ticks * took
    print(f"     worst second of {len(rows)}: {min(row[2] for row in rows):.1f} frames, {min(row[3] for row in rows):.1f} ticks; {len(page.problems)} complaints of {page.name}")
    check(ticks > LEAST_TICKS and late < 0.02 * done, f"{what} for {took:.1f} s: {ticks:.1f} ticks a second of 1000, {late} of {done:.0f} late by more than 10 ms ({100 * late / done:.3f} %), {skipped} skipped")
    least = LEAST_FRAMES_LONG if seconds >= LONG_S else LEAST_FRAMES
    load = os.getloadavg()[0]
    if drawn < least and load > BUSY:
        print(f"     {drawn:.1f} frames a second drawn, not judged: {load:.1f} processes waited for {os.cpu_count()} processors")
        return
    check(drawn >= least, f"{drawn:.1f} frames a second drawn (60 wanted; fewer than {least} fail here)")
