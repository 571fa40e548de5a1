// The page of three axes: keeps the user's choices, controls the simulation loop and shows its results.
const content = JSON.parse(document.getElementById("content").textContent);
const $ = (id) => document.getElementById(id);
const COLUMNS = ["clock", ...content.row], WINDOW_S = 4;
const NORMALS = { plane: [0, 0, 1], inclined: [2 / 7, -3 / 7, 6 / 7] };

/** The user's choices: the settings with which the program made the page, and changes of them. */
const shipped = () => ({ object: content.object, texture: "", material: "", base: "shipped", changes: new Map() });
let chosen = { ...shipped(), automatic: false, speed: 1 };
let run = null, runs = [], running = true, aim = null, pending = true;
let counted = { done: 0, late: 0, skipped: 0 }, rate = { at: 0, done: 0, frames: 0 }, drawn = 0;

const worker = new Worker(URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" })));
const tell = (type, more) => worker.postMessage({ type, ...more });
const press = (id, on) => $(id).setAttribute("aria-pressed", String(on));

function choice() {
  const changes = new Map(chosen.changes);
  changes.set("object", chosen.object === "sphere" ? "sphere" : "plane");
  NORMALS[chosen.object]?.forEach((n, i) => changes.set(`normal_${"xyz"[i]}`, n));
  if (chosen.texture) chosen.texture.split("/").forEach((mm, i) => changes.set(["texture_height_mm", "texture_period_mm"][i], mm));
  const law = changes.get("law"), base = chosen.base === "shipped" ? content.shipped : content.thesis[Object.hasOwn(content.thesis, law) ? law : "enhanced-sfa"];
  const material = chosen.base === "shipped" ? content.materials.find(([name]) => name === chosen.material)?.[1] ?? "" : "";
  return base + material + [...changes].map(([key, value]) => `${key}=${value}\n`).join("");
}
/** The user's choices as the part of the page's address after the `#`. */
function address() {
  const { object, texture, material, base, changes } = chosen;
  return new URLSearchParams([...Object.entries({ object, texture, material, base }), ...[...changes].map((pair) => ["set", pair.join("=")])]);
}
/** A setting in the address. Only those with a control, so that the controls show what acts; the value is one line, so it adds no other. */
const SETTING = /^(law|k_desired_n_per_m|per_axis|guard)=(.*)$/;
/** Makes the choices those in the address: what it does not name is as shipped, what the page does not know is left out and told. */
function fromAddress() {
  const offered = (id) => [...$(id).options].map((option) => option.value), unknown = [];
  const words = new Map([...["object", "texture", "material"].map((id) => [id, offered(id)]), ["base", ["shipped", "thesis"]]]);
  Object.assign(chosen, shipped());
  for (const [name, value] of new URLSearchParams(location.hash.slice(1))) {
    const [, key, to] = name === "set" ? SETTING.exec(value) ?? [] : [];
    if (key) chosen.changes.set(key, to);
    else if (words.get(name)?.includes(value)) chosen[name] = value;
    else unknown.push(`${name}=${value}`);
  }
  // As in the list of laws, a law by its name has the thesis' settings.
  if (chosen.changes.has("law")) chosen.base = "thesis";
  notice = unknown.length ? `not taken from the link, because the page has no such choice: ${unknown.join(", ")}` : "";
}
/** Whether the worker has loaded the simulation. Choices of before are opened then. */
let ready = false;
/** Choices sent to the worker that it has not answered. Only the answer to the last one counts. */
let unanswered = 0;
function open(keep) {
  pending = true;
  if (!ready) return;
  unanswered += 1;
  tell("open", { choice: choice(), keep });
}
/** Whether this is the worker's answer to the last choice. */
const isLast = () => (unanswered = Math.max(0, unanswered - 1)) === 0;
/** The choices that were accepted last, and a message that stays until others are accepted. */
let good = shipped(), notice = "";
/** Chooses the shipped wall, or a law with the thesis' settings. */
function choose(law) {
  chosen.base = law === "shipped" ? "shipped" : "thesis";
  if (law === "shipped") chosen.changes.delete("law"); else chosen.changes.set("law", law);
  open(true);
}
function set(key, value) {
  chosen.changes.set(key, value);
  open(true);
}
function complain(text) {
  $("error").textContent = text;
  $("error").hidden = !text;
}

function opened({ facts, keep }) {
  pending = false;
  good = { object: chosen.object, texture: chosen.texture, material: chosen.material, base: chosen.base, changes: new Map(chosen.changes) };
  history.replaceState(null, "", `#${address()}`);
  const length = Math.max(2000, Math.ceil(facts.rate_hz * WINDOW_S * 1.1));
  run = { facts, second: false, title: "", ring: keep && run ? run.ring : new Ring(COLUMNS, length), last: keep ? run?.last ?? null : null, got: 0 };
  runs = [run];
  if (!$("law").length) $("law").append(new Option("as shipped", "shipped"), ...facts.laws.map((word) => new Option(`${word}, the thesis' settings`, word)));
  $("law").value = facts.states === "estimated" ? "shipped" : facts.law;
  $("object").value = chosen.object;
  $("texture").value = chosen.texture;
  $("material").value = chosen.material;
  // The law for each axis and the thesis' laws do not estimate the speed at the touch along the normal.
  $("material").disabled = chosen.base !== "shipped" || facts.per_axis;
  $("stiffness").value = Math.log10(facts.k_desired_n_per_m / 1e3);
  $("stiffness-n").value = facts.k_desired_n_per_m / 1e3;
  $("per-axis").checked = facts.per_axis;
  $("guard").checked = facts.guard;
}
worker.onmessage = ({ data }) => {
  // The hand moves by itself until the user moves it, unless the user's system asks for reduced motion.
  if (data.type === "ready") { ready = true; open(false); go(true); automatic(!matchMedia("(prefers-reduced-motion: reduce)").matches); }
  if (data.type === "opened" && isLast()) { complain(notice); notice = ""; opened(data); }
  if (data.type === "rows" && run && !pending) {
    run.ring.push(data.rows);
    counted = data.count;
    run.last = Object.fromEntries(COLUMNS.map((name) => [name, run.ring.at(name, 0)]));
    for (let at = COLUMNS.indexOf("energy_true_j"); at < data.rows.length; at += COLUMNS.length) run.got = Math.max(run.got, -data.rows[at]);
  }
  if (data.type === "error" && isLast()) {
    const text = [notice, data.text].filter(Boolean).join("; ");
    complain(text);
    if (good) { Object.assign(chosen, good); good = null; notice = text; open(true); }
  }
};
worker.onerror = (event) => complain(`the loop stopped: ${event.message}`);

function go(on) {
  running = on;
  $("run").textContent = on ? "Pause" : "Run";
  $("step").disabled = on;
  tell("run", { on, speed: chosen.speed });
}
function automatic(on) {
  chosen.automatic = on;
  press("automatic", on);
  $("by-itself").style.visibility = on ? "" : "hidden";
  tell("automatic", { on });
  if (on) aim = null;
}
function restart() {
  aim = null;
  open(false);
}
function letGo() {
  automatic(false);
  aim = null;
  tell("aim", { mm: null });
}
/** Moves the hand's rest point in the view, mm: to the right, upwards and away from the viewer. */
function move(right, up, away) {
  if (!run) return;
  if (chosen.automatic) automatic(false);
  const { camera } = view, from = aim ?? (run.last ? ["x", "y", "z"].map((axis) => run.last[`rest_${axis}_mm`]) : run.facts.start_mm);
  aim = from.map((x, i) => Math.max(-80, Math.min(80, x + right * camera.right[i] + up * camera.up[i] + away * camera.away[i])));
  tell("aim", { mm: aim });
}

const view = new SpaceView($("stage"));
const series = (name, colour, of, more) => ({ name, colour, of, ...more });
const FIGURES = [
  ["Depth below the surface", "mm", 1, [series("inside above 0", "a", (c, i) => Math.max(-5, c.depth_mm[i]))]],
  ["Force", "N", 2, [series("length", "a", (c, i) => c.force_n[i]), ...["x", "y", "z"].map((axis, k) => series(axis, ["shift", "mass", "hand"][k], (c, i) => c[`force_${axis}_n`][i], { dash: [[2, 2], [5, 3], [7, 3, 2, 3]][k], wide: 1.2 }))]],
  ["Displayed stiffness", "N/mm", 5, [series("force over depth (dashed: k_de)", "a", (c, i) => (c.depth_mm[i] > 0.02 ? c.force_n[i] / c.depth_mm[i] : NaN))]],
  ["Energy so far", "mJ", 5, [series("absorbed by the wall (below 0: given away)", "a", (c, i) => 1e3 * c.energy_true_j[i]), series("the guard's account", "force", (c, i) => 1e3 * c.guard_account_j[i], { dash: [2, 2] })]],
];
const plots = FIGURES.map(([title, unit, least, all]) => Object.assign(new Plot(figureFor(title, all.map((s) => [s.name, s.colour, s.dash ?? []])), unit, least, all), { stiffness: unit === "N/mm" }));

const READOUT = [
  ["Depth", () => `${run.last.depth_mm.toFixed(3)} mm`],
  ["Force", () => `${run.last.force_n.toFixed(2)} N`],
  ["Displayed, desired", () => `${run.last.depth_mm > 0.02 ? (run.last.force_n / run.last.depth_mm).toFixed(1) : "–"} of ${number(run.facts.k_desired_n_per_m / 1e3)} N/mm`],
  ["Speed", () => `${run.last.speed_mm_per_s.toFixed(0)} mm/s`],
  ["Absorbed by the wall", () => `${(1e3 * run.last.energy_true_j).toFixed(2)} mJ`],
  ["Most the wall gave (net)", () => `${(1e3 * run.got).toFixed(2)} mJ`],
  ["Guard's account", () => (Number.isNaN(run.last.guard_account_j) ? "no guard" : `${(1e3 * run.last.guard_account_j).toFixed(2)} mJ`)],
];
const cells = READOUT.map(([name]) => {
  const box = document.createElement("div"), term = document.createElement("dt"), value = document.createElement("dd");
  term.textContent = name;
  box.append(term, value);
  $("readout").append(box);
  return value;
});
const inSight = new Set();
const watch = new IntersectionObserver((entries) => { for (const entry of entries) inSight[entry.isIntersecting ? "add" : "delete"](entry.target); });
for (const plot of plots) watch.observe(plot.canvas);

let wordsAt = 0, before = 0;
function frame(now) {
  requestAnimationFrame(frame);
  const passed = Math.min(0.1, (now - before) / 1000);
  before = now;
  steer(passed);
  if (!run || pending) return;
  drawn += 1;
  rate.frames += 1;
  view.draw(run, aim);
  const plot = plots[drawn % plots.length], level = plot.stiffness ? run.facts.k_desired_n_per_m / 1e3 : undefined;
  if (plot.stiffness) plot.cap = 2.2 * level;
  if (inSight.has(plot.canvas) && run.ring.size) plot.draw(runs, WINDOW_S, level);
  if (now - wordsAt < 120) return;
  wordsAt = now;
  if (run.last) READOUT.forEach(([, of], i) => { cells[i].textContent = of(); });
  const s = (now - rate.at) / 1000;
  if (s < 1) return;
  $("status").textContent = running ? `${((counted.done - rate.done) / s).toFixed(0)} ticks a second of ${(run.facts.rate_hz * chosen.speed).toFixed(0)}, ${counted.late} of ${counted.done} late (more than 10 ms)${counted.skipped ? `, ${counted.skipped} skipped` : ""}, ${(rate.frames / s).toFixed(0)} frames a second` : `paused after ${counted.done} ticks`;
  rate = { at: now, done: counted.done, frames: 0 };
}

// Keys that are held down move the hand or turn the view.
const held = new Set();
function steer(s) {
  const way = (more, less) => Number(held.has(more)) - Number(held.has(less)), mm = s * (held.has("Shift") ? 8 : 45);
  const [right, up, away] = [way("ArrowRight", "ArrowLeft"), way("ArrowUp", "ArrowDown"), way("i", "o")];
  if (right || up || away) move(mm * right, mm * up, mm * away);
  view.camera.turn(1.2 * s * way("e", "q"), 1.2 * s * way("z", "x"));
}
const HELD = ["ArrowRight", "ArrowLeft", "ArrowUp", "ArrowDown", "i", "o", "q", "e", "z", "x"];
const KEYS = { " ": () => go(!running), ".": () => tell("step"), r: restart, p: () => automatic(!chosen.automatic), h: letGo };
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  held[event.shiftKey ? "add" : "delete"]("Shift");
  if (/^(INPUT|SELECT)$/.test(event.target.tagName) && event.target.type !== "checkbox") return;
  if (event.key === " " && /^(BUTTON|INPUT)$/.test(event.target.tagName)) return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (HELD.includes(key)) { held.add(key); event.preventDefault(); return; }
  if (KEYS[key] && !event.repeat) { event.preventDefault(); KEYS[key](); }
});
addEventListener("keyup", (event) => held.delete(event.key.length === 1 ? event.key.toLowerCase() : event.key));
addEventListener("blur", () => held.clear());

let grabbed = null;
$("stage").addEventListener("pointerdown", (event) => {
  $("stage").setPointerCapture(event.pointerId);
  grabbed = { x: event.clientX, y: event.clientY, turns: event.shiftKey || event.button === 2 };
});
$("stage").addEventListener("pointermove", (event) => {
  if (!grabbed) return;
  const dx = event.clientX - grabbed.x, dy = event.clientY - grabbed.y, canvas = $("stage"), s = view.camera.scale(canvas.clientWidth, canvas.clientHeight);
  Object.assign(grabbed, { x: event.clientX, y: event.clientY });
  if (grabbed.turns) view.camera.turn(-dx * 0.01, dy * 0.01); else move(dx / s, -dy / s, 0);
});
for (const name of ["pointerup", "pointercancel"]) $("stage").addEventListener(name, () => { if (grabbed && !grabbed.turns) letGo(); grabbed = null; });
$("stage").addEventListener("contextmenu", (event) => event.preventDefault());
$("stage").addEventListener("wheel", (event) => { event.preventDefault(); move(0, 0, -Math.max(-4, Math.min(4, event.deltaY * 0.02))); }, { passive: false });

const on = (id, name, act) => $(id).addEventListener(name, act);
on("run", "click", () => go(!running));
on("step", "click", () => tell("step"));
on("reset", "click", restart);
on("automatic", "click", () => automatic(!chosen.automatic));
on("speed", "change", () => { chosen.speed = Number($("speed").value); go(running); });
on("object", "change", () => { chosen.object = $("object").value; restart(); });
on("texture", "change", () => { chosen.texture = $("texture").value; open(true); });
on("material", "change", () => { chosen.material = $("material").value; open(true); });
on("link", "click", async () => {
  try { await navigator.clipboard.writeText(location.href); $("link-told").textContent = "The page's address with these settings is copied."; }
  catch { $("link-told").textContent = `Copy it from the address bar: ${location.hash}`; }
});
on("scene", "click", () => {
  // While changed settings are opened, the running ones are not yet those of the page.
  if (!run || pending) return;
  const why = notInScene(good.base, run.facts);
  if (!why) save("live-three-axes.toml", "application/toml", sceneOf(good, run.facts));
  $("link-told").textContent = why ? `Not saved. In a scene ${why}.` : "Saved as live-three-axes.toml. touchstone run live-three-axes.toml presses, slides and lets go with a simulated hand.";
});
addEventListener("hashchange", () => { fromAddress(); restart(); });
on("law", "change", () => choose($("law").value));
on("stiffness", "input", () => { $("stiffness-n").value = Number((10 ** $("stiffness").value).toPrecision(3)); });
for (const id of ["stiffness", "stiffness-n"]) on(id, "change", () => set("k_desired_n_per_m", Number(((id === "stiffness" ? 10 ** $(id).value : Number($(id).value)) * 1e3).toPrecision(6))));
on("per-axis", "change", () => set("per_axis", $("per-axis").checked));
on("guard", "change", () => set("guard", $("guard").checked));
for (const [id, yaw, pitch] of [["turn-left", -0.25, 0], ["turn-right", 0.25, 0], ["turn-up", 0, 0.25], ["turn-down", 0, -0.25]]) on(id, "click", () => view.camera.turn(yaw, pitch));
let hiddenPause = false;
document.addEventListener("visibilitychange", () => {
  if (document.hidden && running) { hiddenPause = true; go(false); } else if (!document.hidden && hiddenPause) { hiddenPause = false; go(true); }
});

$("material").append(new Option("none", ""), ...content.materials.map(([name]) => new Option(name)));
fromAddress();
readInk();
requestAnimationFrame(frame);
unpacked().then((module) => tell("start", { module, ROW: content.row }), (error) => complain(`this browser cannot run WebAssembly: ${error}`));
