// The simulation loop of one axis: one run, or two runs under the same hand.

// Largest number of recorded ticks. Ten minutes at 1 kHz with 14 columns take 67 MB.
const MOST_RECORDED = 600000;
// Largest number of ticks that a run can be turned back, and the time in s that is then drawn again. A run can be turned back while all its rest points are kept.
const MOST_PAST = 600000, DRAWN_S = 5;

let ROW, FACTS, TRACE;
const sides = [null, null];
let aim = null, strength = 0.3, automatic = false;
let hand = { x: 0, v: 0 }, ticks = 0, autoTick = 0, dirty = 0;
let record = null, every = 1;
/** Rest points of the hand in rad, one per tick of the run; null after a changed setting, or if there are more than MOST_PAST. */
let past = null;
/** Rest points of an opened file in rad, one per tick from the start of the run. */
let played = null, playedTick = 0;

function factsOf(side) {
  const values = numbers(wasm.live_facts(side.handle), FACTS.length);
  return Object.fromEntries(FACTS.map((name, i) => [name, values[i]]));
}

/** Opens, changes or closes (`scene` null) one of the two runs. After an error the run is unchanged. */
function setSide(index, scene, keep) {
  const side = sides[index];
  if (scene === null) {
    if (side) wasm.live_close(side.handle);
    sides[index] = null;
    return null;
  }
  put(scene);
  let handle;
  if (side && keep) {
    if (wasm.live_change(side.handle) < 0) return given();
    handle = side.handle;
  } else {
    handle = wasm.live_open();
    if (handle < 0) return given();
    if (side) wasm.live_close(side.handle);
  }
  sides[index] = { handle, rows: [] };
  sides[index].facts = factsOf(sides[index]);
  return null;
}

function told(index) {
  const side = sides[index];
  if (!side) return null;
  wasm.live_printed(side.handle);
  const printed = given();
  wasm.live_warnings(side.handle);
  return { facts: side.facts, printed, warnings: given() };
}

function open({ a, b, keep }) {
  stopRecord("the settings changed");
  const before = [sides[0], sides[1]];
  const error = setSide(0, a, keep) ?? setSide(1, b, keep && before[1] !== null);
  if (error !== null) {
    postMessage({ type: "error", text: error });
    return;
  }
  if (!keep) rest();
  past = keep ? null : [];
  clock();
  every = Math.max(1, Math.ceil(sides[0].facts.rate_hz / 4000));
  postMessage({ type: "opened", a: told(0), b: told(1), keep });
}

/** Makes the hand let go and wait at the start angle of the loop. */
function rest() {
  hand = { x: sides[0].facts.angle_rad, v: 0 };
  aim = null;
  autoTick = 0;
}

function reset() {
  for (const side of sides) if (side) wasm.live_reset(side.handle);
  rest();
  past = [];
  clock();
}

/** Turns the run back by `count` ticks: simulates it again from its start, which gives the same bits. */
function back(count) {
  if (past === null) {
    postMessage({ type: "back", a: null, b: null, why: "A setting was changed during the run, or it has more than 600,000 ticks: start again to be able to go back." });
    return;
  }
  stopRecord("the run was turned back");
  const to = Math.max(0, past.length - count), { rate_hz, angle_rad } = sides[0].facts, period = 1 / rate_hz;
  const begun = ticks - past.length, shown = to - Math.ceil(DRAWN_S * rate_hz), most = [];
  ticks = begun + to;
  autoTick = Math.max(0, autoTick - (past.length - to));
  past.length = to;
  const energy = ROW.indexOf("energy_hand_j");
  const all = sides.map((side) => {
    if (!side) return null;
    wasm.live_reset(side.handle);
    const rows = [];
    let peak = 0, got = 0;
    past.forEach((at, i) => {
      const row = numbers(wasm.live_tick(side.handle, at), ROW.length);
      peak = Math.max(peak, row[energy]);
      got = Math.max(got, peak - row[energy]);
      if (i >= shown && ((begun + i + 1) % every === 0 || i === to - 1)) rows.push((begun + i) * period, ...row);
    });
    side.rows = [];
    most.push({ peak, got });
    return Float64Array.from(rows);
  });
  hand = { x: past.at(-1) ?? angle_rad, v: 0 };
  aim = null;
  dirty = 0;
  clock();
  postMessage({ type: "back", a: all[0], b: all[1], most, why: `Tick ${to} of the run.` });
}

// Rest point of the hand's spring, rad. Outside the wall it is the mouse pointer's angle. Inside, it lies so deep that the hand's
// steady torque on a wall of the desired stiffness is `strength` N·m per rad of the pointer's depth.
function target() {
  const { surface_rad, reach_rad_per_n_m, motion_s, rate_hz, angle_rad, has_wall } = sides[0].facts;
  if (automatic && motion_s > 0) {
    const time = (autoTick / rate_hz) % (motion_s + 0.3);
    return wasm.live_own_rest(sides[0].handle, Math.min(time, motion_s));
  }
  // Without a wall the rest point is the pointer's angle, or stays where the hand is.
  if (has_wall === 0) return aim ?? hand.x;
  const at = aim ?? Math.min(angle_rad, surface_rad - 0.05);
  const inside = at - surface_rad;
  return inside > 0 ? surface_rad + inside * Math.max(1, strength * reach_rad_per_n_m) : at;
}

const rateHz = () => sides[0]?.facts.rate_hz;

function tick() {
  const period = 1 / sides[0].facts.rate_hz;
  const goal = played ? played[Math.min(playedTick++, played.length - 1)] : target();
  if (played) {
    hand = { x: goal, v: 0 };
  } else if (automatic) {
    // The scene's own motion is smooth and needs no low-pass.
    autoTick += 1;
    hand = { x: goal, v: 0 };
  } else {
    follow(hand, goal, period);
  }
  const time = ticks * period;
  ticks += 1;
  if (past && past.push(hand.x) > MOST_PAST) past = null;
  for (let i = 0; i < 2; i += 1) {
    const side = sides[i];
    if (!side) continue;
    const row = numbers(wasm.live_tick(side.handle, hand.x), ROW.length);
    if (record) for (let c = 0; c < TRACE; c += 1) record.rows[i].push(row[c]);
    if (ticks % every === 0) side.rows.push(time, ...row);
  }
  count.done += 1;
  dirty += 1;
  if (record && (record.ticks += 1) >= MOST_RECORDED) stopRecord("it is full");
}

function post() {
  if (!dirty) return;
  dirty = 0;
  const rows = sides.map((side) => (side ? Float64Array.from(side.rows) : null));
  for (const side of sides) if (side) side.rows = [];
  const recorded = record ? record.ticks : null;
  postMessage({ type: "rows", a: rows[0], b: rows[1], count, recorded }, rows.filter((r) => r).map((r) => r.buffer));
}

function startRecord() {
  reset();
  postMessage({ type: "reset" });
  record = { ticks: 0, rows: [[], []] };
}

function stopRecord(why) {
  if (!record) return;
  const done = record;
  record = null;
  const files = sides.map((side, i) => {
    if (!side || done.ticks === 0) return null;
    put(`live-${"ab"[i]}.csv`);
    wasm.live_replay(side.handle);
    return { rows: Float64Array.from(done.rows[i]), scene: given() };
  });
  postMessage({ type: "recorded", ticks: done.ticks, files, why });
}

const acts = {
  start: async (message) => {
    ({ ROW, FACTS, TRACE } = message);
    wasm = (await WebAssembly.instantiate(message.module, {})).exports;
    postMessage({ type: "ready" });
    work();
  },
  open,
  aim: (message) => { aim = message.rad; },
  play: (message) => { played = message.rests; playedTick = 0; },
  strength: (message) => { strength = message.n_m_per_rad; },
  automatic: (message) => { automatic = message.on; autoTick = 0; hand.v = 0; },
  run: (message) => {
    running = message.on;
    speed = message.speed;
    clock();
  },
  step: () => { if (!running && sides[0]) { tick(); post(); } },
  back: (message) => { if (!running && sides[0]) back(message.ticks); },
  reset: () => { stopRecord("the run started again"); reset(); postMessage({ type: "reset" }); },
  record: (message) => { if (message.on) startRecord(); else stopRecord(""); },
  zero: () => { count = { done: 0, late: 0, skipped: 0 }; },
};

onmessage = (event) => {
  try {
    const done = acts[event.data.type](event.data);
    if (done) done.catch((error) => postMessage({ type: "error", text: String(error) }));
  } catch (error) {
    running = false;
    postMessage({ type: "error", text: `the loop stopped: ${error}` });
  }
};
