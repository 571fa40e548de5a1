// The simulation loop of three axes.

let ROW;
let facts = null, rows = [], ticks = 0, autoTick = 0, dirty = 0;
let aim = null, automatic = false;
let hands = [0, 0, 0].map((x) => ({ x, v: 0 }));

const rateHz = () => facts?.rate_hz;

/** The hand's automatic motion on a surface: in, around, out; returns x, y and z in mm at the time `t` in s. */
const CYCLE_S = 7, DEEP_MM = 20;
function own(t) {
  const smooth = (s) => { const c = Math.max(0, Math.min(1, s)); return c * c * (3 - 2 * c); };
  const share = smooth(t / 1.2) - smooth((t - 5.2) / 1), around = 2 * Math.PI * smooth((t - 2) / 3);
  const above = 8 - (8 + DEEP_MM) * share, { radius_mm, normal } = facts;
  if (radius_mm) {
    const tilt = 0.9 * Math.sin(around), turn = 0.9 * (1 - Math.cos(around));
    const way = [Math.sin(tilt), Math.cos(tilt) * Math.sin(turn * 0.6), Math.cos(tilt) * Math.cos(turn * 0.6)];
    return way.map((n) => n * (radius_mm + above));
  }
  const [a, b] = along(normal), r = 28;
  return normal.map((n, i) => n * above + r * (Math.sin(around) * a[i] + (1 - Math.cos(around)) * b[i]));
}

function tick() {
  const period = 1 / facts.rate_hz;
  if (automatic) {
    hands = own((autoTick * period) % CYCLE_S).map((x) => ({ x, v: 0 }));
    autoTick += 1;
  } else {
    const goal = aim ?? facts.start_mm;
    hands.forEach((hand, i) => follow(hand, goal[i], period));
  }
  const row = numbers(wasm.live_space_tick(...hands.map((hand) => hand.x)), ROW.length);
  rows.push(ticks * period, ...row);
  ticks += 1;
  count.done += 1;
  dirty += 1;
}

function post() {
  if (!dirty) return;
  dirty = 0;
  const sent = Float64Array.from(rows);
  rows = [];
  postMessage({ type: "rows", rows: sent, count }, [sent.buffer]);
}

function rest() {
  hands = facts.start_mm.map((x) => ({ x, v: 0 }));
  aim = null;
  autoTick = 0;
}

function open({ choice, keep }) {
  put(choice);
  // Until settings are accepted there is no loop to keep, and the hand has to be put at the start position.
  keep &&= facts !== null;
  const failed = keep ? wasm.live_space_change() : wasm.live_space_open();
  if (failed) { postMessage({ type: "error", text: given() }); return; }
  wasm.live_space_facts();
  facts = JSON.parse(given());
  if (!keep) { rest(); ticks = 0; }
  rows = [];
  dirty = 0;
  clock();
  postMessage({ type: "opened", facts, keep });
}

const acts = {
  start: async (message) => {
    ROW = message.ROW;
    wasm = (await WebAssembly.instantiate(message.module, {})).exports;
    postMessage({ type: "ready" });
    work();
  },
  open,
  aim: (message) => { aim = message.mm; },
  automatic: (message) => { automatic = message.on; autoTick = 0; for (const hand of hands) hand.v = 0; },
  run: (message) => { ({ on: running, speed } = message); clock(); },
  step: () => { if (!running && facts) { tick(); post(); } },
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
