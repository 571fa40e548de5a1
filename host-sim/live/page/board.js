// The page for a connected device: shows its messages and records, and sends it commands.
const COLUMNS = content.columns, WINDOW_S = 4, PLANE_S = 2;
let hello = null, state = null, connected = false, deviceLost = null, run = null, troubles = { dropped: 0, damaged: 0 };
let took = { records: 0, missing: 0, at: 0, rate: 0 }, recent = { records: 0, since: performance.now() }, worst = 0;
const seen = { rows: 0 };

const inside = (c, i, r) => c.angle_rad[i] - r.facts.surface_rad;
const FIGURES = [
  ["Angle from the surface", "mrad", 5, [{ name: "knob, as measured", colour: "a", of: (c, i, r) => 1e3 * inside(c, i, r) }]],
  ["Force", "mN·m", 20, [
    { name: "of the device's law", colour: "a", of: (c, i) => 1e3 * c.force_n_m[i], wide: 2.4 },
    { name: "of the model on the same motion", colour: "b", dash: [5, 3], of: (c, i) => 1e3 * c.model_n_m[i] }]],
  ["Device less model", "µN·m", 1, [{ name: "0: the same to the bit", colour: "force", of: (c, i) => 1e6 * c.difference_n_m[i] }]],
  ["Energy, as the law counts it", "mJ", 1, [{ name: "absorbed by the wall", colour: "mass", of: (c, i) => 1e3 * c.energy_observed_j[i] }]],
  ["Current", "A", 0.1, [{ name: "measured, q axis", colour: "shift", of: (c, i) => c.current_q_a[i] }]],
  ["Control tick", "processor cycles", 100, [
    { name: "one tick", colour: "a", of: (c, i) => c.cycles[i] },
    { name: "its lateness", colour: "hand", dash: [7, 3], of: (c, i) => c.lateness_cycles[i] }]],
];
const plots = FIGURES.map(([title, unit, least, series]) => new Plot(figureFor(title, series.map((s) => [s.name, s.colour, s.dash ?? []])), unit, least, series));
const plane = new Plane(figureFor("Position and force", [["k_de", "muted", [6, 4]]], true), "penetration, mrad", "force, mN·m", 10, 50,
  (c, i, r) => [1e3 * inside(c, i, r), 1e3 * c.force_n_m[i]]);
const stage = new Stage($("stage"));

const READOUT = [
  ["Penetration", () => `${(1e3 * (run.last.angle_rad - run.facts.surface_rad)).toFixed(3)} mrad`],
  ["Force", () => `${(1e3 * run.last.force_n_m).toFixed(2)} mN·m`],
  ["Device less model", () => (Number.isNaN(run.last.difference_n_m) ? (hello.decimation > 1 ? "not every control period is sent" : "not known now") : `${(1e6 * run.last.difference_n_m).toFixed(2)} µN·m, at most ${(1e6 * worst).toFixed(2)}`)],
  ["Force reduced by", () => hello.limits.filter((_, bit) => run.last.limits & (1 << bit)).join(", ") || "nothing"],
  ["Records", () => `${took.rate.toFixed(0)} a second of ${(hello.rate_hz / hello.decimation).toFixed(0)}`],
  ["Missing", () => `${took.missing} of ${took.missing + took.records}`],
  ["Not carried by the port", () => `${troubles.dropped}`],
  ["Damaged frames", () => `${troubles.damaged}`],
];
const cells = READOUT.map(([name]) => {
  const box = document.createElement("div"), term = document.createElement("dt"), value = document.createElement("dd");
  term.textContent = name;
  box.append(term, value);
  $("readout").append(box);
  return value;
});

function begin(message) {
  const first = hello === null || hello.rate_hz !== message.rate_hz || hello.decimation !== message.decimation;
  hello = message;
  deviceLost = null;
  $("device").textContent = `${content.place}: ${message.device}`;
  const facts = { ...message, reach_rad_per_n_m: 0 };
  const length = Math.max(2000, Math.ceil((message.rate_hz / message.decimation) * WINDOW_S * 1.1));
  run = { facts, title: "", second: false, last: first ? null : run.last, ring: first ? new Ring(COLUMNS, length) : run.ring };
  fields(message.fields);
}

// Settings: one input for each field that the device reports.
const inputs = new Map();
function fields(all) {
  if (!inputs.size) {
    let table = "";
    for (const field of all) {
      const at = field.path.lastIndexOf(".");
      if (field.path.slice(0, at) !== table) {
        table = field.path.slice(0, at);
        const heading = document.createElement("h3");
        heading.textContent = table;
        $("fields").append(heading);
      }
      $("fields").append(setting(field, field.path.slice(at + 1)));
    }
  }
  for (const { path, shown } of all) {
    const input = inputs.get(path);
    input.value = shown;
    input.removeAttribute("aria-invalid");
  }
}
function setting({ path, unit, about, value }, name) {
  const label = document.createElement("label"), words = document.createElement("span"), small = document.createElement("small");
  const choices = value.type === "word" ? value.words : value.type === "boolean" ? ["true", "false"] : null;
  small.textContent = choices ? about : `${about}; ${value.min} to ${value.max}${unit ? ` ${unit}` : ""}`;
  words.append(name, small);
  const input = document.createElement(choices ? "select" : "input");
  if (choices) input.append(...choices.map((word) => new Option(word, word)));
  else { input.type = "text"; input.inputMode = "decimal"; }
  input.dataset.path = path;
  input.addEventListener("change", () => ask({ do: "set", path, value: input.value.trim() }));
  inputs.set(path, input);
  label.append(words, input);
  return label;
}

function ask(order) {
  $("answer").textContent = `${order.path ?? order.do}: sent`;
  if (!link.send(order)) complain(`NOT SENT (${order.do}): there is no connection to ${BoardLink.peer}.${order.do === "stop" ? " SWITCH THE POWER OFF." : ""}`);
}
const stop = () => ask({ do: "stop" });

function complain(text) {
  $("error").textContent = text;
  $("error").hidden = !text;
}
function answered({ do: what, path, error }) {
  complain(error ?? "");
  $("answer").textContent = `${path ?? what}: ${error ? "refused" : "done"}`;
  if (error && path && inputs.has(path)) inputs.get(path).setAttribute("aria-invalid", "true");
}

const MAY = { calibrate: ["boot", "stopped"], arm: ["ready"], disarm: ["armed"], zero: ["ready", "boot", "stopped"], save: ["boot", "stopped", "fault"], defaults: ["boot", "stopped", "fault", "ready"] };
function show() {
  const there = connected && deviceLost === null && state !== null, phase = there ? state.phase : "";
  $("phase").textContent = there ? phase : "not connected";
  $("phase").dataset.phase = phase;
  $("phase-told").textContent = there ? state.words : "This page does not know what the device does now.";
  for (const button of document.querySelectorAll("[data-do]")) button.disabled = !MAY[button.dataset.do].includes(phase);
  $("fields").disabled = !MAY.defaults.includes(phase);
  $("unsaved").textContent = !there ? "" : state.unsaved ? (MAY.save.includes(phase) ? "changed, not saved" : "changed, not saved; to save, stop first") : "as saved";
  const fault = there ? state.fault : null;
  $("fault").hidden = !fault;
  if (fault) {
    $("fault-name").textContent = `Fault ${fault.name}`;
    $("fault-meaning").textContent = `${fault.meaning} (${fault.value}, tick ${fault.tick})`;
    $("fault-check").textContent = fault.check;
    $("fault-clear").textContent = `${fault.clear || "Stop, then calibrate."} The stop is the red button above.`;
  }
  const lost = !connected ? BoardLink.lost
    : deviceLost !== null ? `NO CONNECTION TO THE DEVICE: ${deviceLost}. The device may still be armed: its power switch always works. This page tries to connect every second, and disarms the device first.` : "";
  $("lost").hidden = !lost;
  if ($("lost").textContent !== lost) $("lost").textContent = lost;
}

const heard = {
  hello: begin,
  state: (message) => { if (message.phase === "armed" && state?.phase !== "armed") worst = 0; state = message; },
  connection: ({ lost, done }) => { deviceLost = lost; $("answer").textContent = ""; if (done) complain(done); },
  done: answered,
  troubles: (message) => { troubles = message; },
};
const link = new BoardLink({
  open: () => { connected = true; show(); },
  closed: () => { connected = false; state = null; show(); },
  words: (message) => { heard[message.type](message); show(); },
  rows: (rows) => {
    if (!run || !rows.length) return;
    run.ring.push(rows);
    const n = COLUMNS.length, records = rows.length / n, missing = COLUMNS.indexOf("missing"), difference = COLUMNS.indexOf("difference_n_m");
    for (let at = 0; at < rows.length; at += n) {
      took.missing += rows[at + missing];
      if (Math.abs(rows[at + difference]) > worst) worst = Math.abs(rows[at + difference]);
    }
    took.records += records;
    recent.records += records;
    took.at = performance.now();
    seen.rows += records;
    run.last = Object.fromEntries(COLUMNS.map((name) => [name, run.ring.at(name, 0)]));
  },
});

const pictures = [...plots.map((plot) => ({ canvas: plot.canvas, act: () => plot.draw([run], WINDOW_S) })),
  { canvas: plane.canvas, act: () => plane.draw([run], PLANE_S, [{ slope: run.facts.k_desired_n_m_per_rad, dash: [6, 4] }]) }];
const inSight = new Set();
const watch = new IntersectionObserver((entries) => { for (const entry of entries) inSight[entry.isIntersecting ? "add" : "delete"](entry.target); });
for (const picture of pictures) watch.observe(picture.canvas);

let drawn = 0, wordsAt = 0;
function frame(now) {
  requestAnimationFrame(frame);
  if (!run) return;
  stage.draw([run], null);
  const picture = pictures[drawn++ % pictures.length];
  if (inSight.has(picture.canvas) && run.ring.size) picture.act();
  if (now - wordsAt < 150) return;
  wordsAt = now;
  const passed = (performance.now() - recent.since) / 1000;
  if (passed >= 1) { took.rate = recent.records / passed; recent = { records: 0, since: performance.now() }; }
  if (run.last) READOUT.forEach(([, of], i) => { cells[i].textContent = of(); });
  const quiet = performance.now() - took.at;
  $("status").textContent = !connected ? `No connection to ${BoardLink.peer}.` : link.silent ? `${BoardLink.peer} sends nothing any more.` : quiet > 300 ? `No record for ${(quiet / 1000).toFixed(1)} s.` : `Records arrive, ${took.records} so far.`;
}

// Escape and the space bar stop the device, whichever element has the focus. No element of this page needs a space.
addEventListener("keydown", (event) => {
  if (event.key !== "Escape" && event.key !== " ") return;
  event.preventDefault();
  event.stopImmediatePropagation();
  if (!event.repeat) stop();
}, { capture: true });
// Keeps the space bar from pressing the focused button when the key is released.
addEventListener("keyup", (event) => { if (event.key === " ") event.preventDefault(); }, { capture: true });
// The stop button acts when it is pressed, not when it is released.
$("stop").addEventListener("pointerdown", stop);
$("stop").addEventListener("click", (event) => { if (event.detail === 0) stop(); });
for (const button of document.querySelectorAll("[data-do]")) button.addEventListener("click", () => ask({ do: button.dataset.do }));

readInk();
show();
requestAnimationFrame(frame);
