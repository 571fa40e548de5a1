// Runs the ticks in real time in a worker thread, so that drawing the page never delays a tick. The worker's script defines the
// functions `tick`, `post` and `rateHz`; `rateHz` returns undefined while no loop is open.
//
// A tick is late if it runs more than LATE_MS after its time. Ticks without any time to run (the machine slept, the page was hidden)
// are skipped and counted separately.

const LATE_MS = 10, MOST_BEHIND_MS = 250, POST_MS = 15;
// Cut-off frequency of the hand's motion, Hz. A pointer is read some 60 times a second; a hand moves smoothly, up to some 10 Hz.
const HAND_HZ = 8;

let running = false, speed = 1, origin = 0, due = 0, posted = 0;
let count = { done: 0, late: 0, skipped: 0 };

/** Moves the hand towards a goal for one tick, through a second-order low-pass filter that makes the motion smooth. */
function follow(hand, goal, period) {
  const w = Math.min(2 * Math.PI * HAND_HZ, 0.5 / period);
  hand.v += (w * w * (goal - hand.x) - 2 * w * hand.v) * period;
  hand.x += hand.v * period;
}

/** Restarts the clock, so that the time in which nothing ran is not made up for. */
function clock() {
  origin = performance.now();
  due = 0;
}

function work() {
  const now = performance.now();
  const rate = rateHz();
  if (running && rate) {
    const perMs = (rate * speed) / 1000;
    const behind = now - origin - due / perMs;
    if (behind > MOST_BEHIND_MS) {
      count.skipped += Math.floor(behind * perMs);
      origin += behind;
    }
    const last = Math.floor((now - origin) * perMs);
    while (due < last) {
      // Lateness is measured when the tick is run, not when the batch of ticks began.
      const lateness = performance.now() - origin - (due + 1) / perMs;
      if (lateness > LATE_MS) count.late += 1;
      due += 1;
      tick();
    }
  }
  if (now - posted >= POST_MS) { posted = now; post(); }
  setTimeout(work, 1);
}
