// Connects controls, figures and keys, and draws the frames.
const E = (c, i, name) => c[name][i];
const isWall = (run) => run.facts.has_wall !== 0;
/** Angle relative to the wall's surface, rad; without a wall, the angle itself. */
const fromSurface = (rad, run) => rad - (isWall(run) ? run.facts.surface_rad : 0);
const inside = (c, i, run) => fromSurface(E(c, i, "angle_rad"), run);
const inHand = (c, i, run) => fromSurface(E(c, i, "hand_rad"), run);
function stiffnessShown(c, i, run) {
  const e = inside(c, i, run);
  return isWall(run) && e > Math.max(2 * run.facts.encoder_step_rad, 2e-4) ? E(c, i, "motor_force_n_m") / e : NaN;
}
const line = (name, colour, of, more) => ({ name, colour, of, ...more });
const FIGURES = [
  { title: "Angle from the surface", unit: "mrad", least: 5, series: [
    line("knob", "a", (c, i, r) => 1e3 * inside(c, i, r)),
    line("virtual mass", "mass", (c, i, r) => 1e3 * fromSurface(E(c, i, "mass_rad"), r), { dash: [2, 2], first: true }),
    line("hand", "hand", (c, i, r) => (isWall(r) ? Math.max(-100, Math.min(300, 1e3 * inHand(c, i, r))) : 1e3 * inHand(c, i, r)), { dash: [7, 3, 2, 3], first: true, wide: 1.2 })] },
  { title: "Force", unit: "mN·m", least: 20, series: [
    line("of the motor, out of the wall", "a", (c, i) => 1e3 * E(c, i, "motor_force_n_m"))] },
  { title: "Displayed stiffness", unit: "N·m/rad", least: 1, level: (run) => run.facts.k_desired_n_m_per_rad, cap: 2.2, series: [
    line("force over penetration (dashed: k_de)", "a", stiffnessShown)] },
  { title: "Energy so far", unit: "mJ", least: 1, series: [
    line("absorbed by the wall (below 0: given away)", "a", (c, i) => 1e3 * E(c, i, "energy_true_j")),
    line("as the law counts it", "mass", (c, i) => 1e3 * E(c, i, "energy_observed_j"), { dash: [2, 2], first: true }),
    line("lost in the device", "shift", (c, i) => 1e3 * E(c, i, "energy_device_loss_j"), { dash: [7, 3], first: true, wide: 1.2 }),
    line("the guard's account", "force", (c, i) => 1e3 * E(c, i, "guard_account_j"), { first: true, wide: 1.2 }),
    line("put in by the hand", "hand", (c, i) => 1e3 * E(c, i, "energy_hand_j"), { dash: [7, 3, 2, 3], first: true, wide: 1.2 })] },
];
const plots = FIGURES.map((figure) => {
  const plot = new Plot(figureFor(figure.title, figure.series.map((s) => [s.name, s.colour, s.dash ?? []])), figure.unit, figure.least, figure.series);
  return Object.assign(plot, { level: figure.level, share: figure.cap });
});
const plane = new Plane(figureFor("Position and force", [["k_de", "muted", [6, 4]], ["k_c", "muted", [2, 3]]], true), "penetration, mrad", "force, mN·m", 10, 50,
  (c, i, r) => [1e3 * inside(c, i, r), 1e3 * E(c, i, "motor_force_n_m")]);
const phase = new Plane(figureFor("Position and velocity", [], true), "penetration, mrad", "velocity, rad/s", 10, 0.5,
  (c, i, r) => [1e3 * inside(c, i, r), E(c, i, "velocity_rad_per_s")]);
const stage = new Stage($("stage"));

const READOUT = [
  ["Penetration", (r) => (isWall(r) ? `${(1e3 * (r.last.angle_rad - r.facts.surface_rad)).toFixed(2)} mrad` : `no wall; at ${((180 / Math.PI) * r.last.angle_rad).toFixed(1)}°`)],
  ["Force", (r) => `${(1e3 * r.last.motor_force_n_m).toFixed(1)} mN·m`],
  ["Displayed, desired", (r) => { if (!isWall(r)) return "no wall"; const c = Object.fromEntries(COLUMNS.map((n) => [n, [r.last[n]]])), k = stiffnessShown(c, 0, r); return `${Number.isFinite(k) ? k.toFixed(2) : "–"} of ${number(r.facts.k_desired_n_m_per_rad)} N·m/rad`; }],
  ["Shakes by (last 0.3 s)", (r) => { let low = Infinity, high = -Infinity; r.ring.since(0.3, (i) => { const x = r.ring.columns.angle_rad[i]; low = Math.min(low, x); high = Math.max(high, x); }); return `${(1e3 * (high - low)).toFixed(2)} mrad`; }],
  ["Absorbed by the wall", (r) => `${(1e3 * r.last.energy_true_j).toFixed(2)} mJ`],
  ["Most the hand got out", (r) => `${(1e3 * r.got).toFixed(2)} mJ`],
  ["Guard's account", (r) => (Number.isNaN(r.last.guard_account_j) ? "no guard" : `${(1e3 * r.last.guard_account_j).toFixed(2)} mJ${["", ", limits", ", off"][r.last.guard_acts]}`)],
  ["Offset", (r) => `${(1e3 * (r.facts.surface_rad - r.last.surface_shifted_rad)).toFixed(1)} mrad`],
];
const cells = READOUT.map(([name]) => {
  const box = document.createElement("div"), term = document.createElement("dt"), value = document.createElement("dd"), a = document.createElement("span"), b = document.createElement("span");
  term.textContent = name;
  a.className = "a";
  b.className = "b";
  value.append(a, b);
  box.append(term, value);
  $("readout").append(box);
  return [a, b];
});

function words(now) {
  READOUT.forEach(([, of], i) => cells[i].forEach((cell, side) => { cell.textContent = runs[side]?.last && runs[side].ring.size ? of(runs[side]) : ""; }));
  const pushing = aim === null ? 0 : Math.round(100 * Math.max(-1, Math.min(1, (aim - middle(runs[0])) / 3)));
  $("stage").setAttribute("aria-valuenow", pushing);
  $("stage").setAttribute("aria-valuetext", runs[0].last ? `${READOUT[0][1](runs[0])}${isWall(runs[0]) ? " into the wall" : ""}, ${READOUT[1][1](runs[0])}` : "");
  const passed = (now - rate.at) / 1000;
  if (passed >= 1) {
    rate = { at: now, done: counted.done, ticks: (counted.done - rate.done) / passed, frames: 0, fps: rate.frames / passed };
    const skipped = counted.skipped ? `, ${counted.skipped} skipped` : "";
    $("status").textContent = running ? `${rate.ticks.toFixed(0)} ticks a second of ${(runs[0].facts.rate_hz * chosen.speed).toFixed(0)}, ${counted.late} of ${counted.done} late (more than 10 ms)${skipped}, ${rate.fps.toFixed(0)} frames a second${ease.every > 1 ? `, one of ${ease.every} drawn to leave room for ticks` : ""}` : `paused after ${counted.done} ticks`;
  }
}

const figures = [
  ...plots.map((plot) => ({ canvas: plot.canvas, act: () => {
    const level = plot.level?.(runs[0]);
    if (plot.share) plot.cap = level * plot.share;
    plot.draw(runs, WINDOW_S, level);
  } })),
  { canvas: plane.canvas, act: () => plane.draw(runs, PLANE_S, [{ slope: runs[0].facts.k_desired_n_m_per_rad, dash: [6, 4] }, { slope: runs[0].facts.k_critical_n_m_per_rad, dash: [2, 3] }]) },
  { canvas: phase.canvas, act: () => phase.draw(runs, PLANE_S, []) },
];
figures.push({ canvas: $("profile"), act: () => { if ($("draw").open) editor.draw(runs[0].drawn, runs[0].last?.angle_rad ?? null); } });
const inSight = new Set();
const watch = new IntersectionObserver((entries) => { for (const entry of entries) inSight[entry.isIntersecting ? "add" : "delete"](entry.target); });
for (const figure of figures) watch.observe(figure.canvas);

let wordsAt = 0, drawn = 0, frames = 0;
/** Ticks have priority over drawing: while ticks come late, only every second, third … frame is drawn. */
const ease = { every: 1, at: 0, done: 0, late: 0, quiet: 0 };
const MOST_EASED = 6, LATE_SHARE = 0.002;
function easeOff(now) {
  if (now - ease.at < 1000) return;
  // `Math.max`: some runs restart the counts of ticks at 0.
  const late = Math.max(0, counted.late + counted.skipped - ease.late), done = Math.max(0, counted.done - ease.done);
  ease.quiet = late > LATE_SHARE * done ? 0 : ease.quiet + 1;
  if (ease.quiet === 0) ease.every = Math.min(MOST_EASED, ease.every + 1);
  else if (ease.quiet >= 3) { ease.every = Math.max(1, ease.every - 1); ease.quiet = 0; }
  Object.assign(ease, { at: now, done: counted.done, late: counted.late + counted.skipped });
}
function frame(now) {
  requestAnimationFrame(frame);
  turn(now);
  if (!runs.length || pending) return;
  easeOff(now);
  frames += 1;
  if (frames % ease.every) return;
  rate.frames += 1;
  const hand = runs[0].last?.rest_rad ?? null;
  const pointed = aim ?? (hand === null ? null : chosen.automatic ? unmapped(hand) : hand);
  stage.draw(runs, pointed);
  // Each frame draws the stage, and the next figure if it is in sight: one figure per frame leaves time for the ticks.
  const figure = figures[drawn++ % figures.length];
  if (inSight.has(figure.canvas)) figure.act();
  if (now - wordsAt > 120) { wordsAt = now; words(now); }
}
/** The pointer's angle, rad, that gives this rest point of the hand, the inverse of the worker's `target`. */
function unmapped(rest) {
  const { surface_rad, reach_rad_per_n_m } = runs[0].facts, deep = rest - surface_rad;
  return isWall(runs[0]) && deep > 0 ? surface_rad + deep / Math.max(1, chosen.strength * reach_rad_per_n_m) : rest;
}

// Keys that are held down turn the knob.
const held = new Set();
let turned = 0;
function turn(now) {
  const way = (held.has("ArrowRight") || held.has("ArrowUp") ? 1 : 0) - (held.has("ArrowLeft") || held.has("ArrowDown") ? 1 : 0);
  const passed = Math.min(0.1, (now - turned) / 1000);
  turned = now;
  if (way && runs.length) setAim(standing() + way * passed * (held.has("Shift") ? 0.12 : 0.7));
}
const KEYS = { " ": () => run(!running), ".": () => $("step").click(), ",": () => turnBack(1), b: () => turnBack(backTicks()), r: restart, p: () => automatic(!chosen.automatic), s: sound, c: () => record(!recording), h: letGo, Home: letGo };
addEventListener("keydown", (event) => {
  // In a text field, the browser undoes what was typed.
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && !/^(number|text)$/.test(event.target.type)) { event.preventDefault(); undo(); return; }
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  held[event.shiftKey ? "add" : "delete"]("Shift");
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && event.target.type !== "checkbox") return;
  if (event.key === " " && /^(BUTTON|SUMMARY|INPUT)$/.test(event.target.tagName)) return;
  if (event.key.startsWith("Arrow")) { held.add(event.key); event.preventDefault(); return; }
  if (/^[0-7]$/.test(event.key)) { preset(Number(event.key)); return; }
  const act = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (act && !event.repeat) { event.preventDefault(); act(); }
});
addEventListener("keyup", (event) => held.delete(event.key));
addEventListener("blur", () => held.clear());

// The pointer turns the knob by the angle that it moves around the knob's centre.
let grabbed = null;
$("stage").addEventListener("pointerdown", (event) => {
  const at = place(event), knob = stage.knobs.reduce((best, k) => (!best || Math.hypot(at.x - k.x, at.y - k.y) < Math.hypot(at.x - best.x, at.y - best.y) ? k : best), null);
  if (!knob) return;
  $("stage").setPointerCapture(event.pointerId);
  grabbed = { knob, around: Math.hypot(at.x - knob.x, at.y - knob.y) < 2.2 * knob.r, at };
  setAim(runs[0]?.last?.angle_rad ?? standing());
});
$("stage").addEventListener("pointermove", (event) => {
  if (!grabbed) return;
  const at = place(event), { knob, at: before } = grabbed;
  const angle = (p) => Math.atan2(p.y - knob.y, p.x - knob.x);
  // A pointer that starts beside the knob moves along a line, as in the lens: to the right is into the wall.
  let way = grabbed.around ? angle(at) - angle(before) : (at.x - before.x) / (2.5 * knob.r);
  if (way > Math.PI) way -= 2 * Math.PI;
  if (way < -Math.PI) way += 2 * Math.PI;
  grabbed.at = at;
  setAim(aim + way);
});
for (const name of ["pointerup", "pointercancel"]) $("stage").addEventListener(name, () => { if (grabbed) { grabbed = null; letGo(); } });
$("stage").addEventListener("wheel", (event) => { event.preventDefault(); setAim(standing() + Math.max(-0.1, Math.min(0.1, event.deltaY * 0.0006))); }, { passive: false });
function place(event) { const box = $("stage").getBoundingClientRect(); return { x: event.clientX - box.left, y: event.clientY - box.top }; }

const on = (id, name, act) => $(id).addEventListener(name, act);
on("run", "click", () => run(!running));
on("step", "click", () => { if (!running) tell("step"); });
const backTicks = () => Math.round(0.1 * runs[0].facts.rate_hz);
on("back", "click", () => turnBack(1));
on("back-more", "click", () => turnBack(backTicks()));
on("reset", "click", restart);
on("automatic", "click", () => automatic(!chosen.automatic));
on("sound", "click", sound);
on("speed", "change", () => { chosen.speed = Number($("speed").value); run(running); share(); });
on("feel", "change", () => feel($("feel").value));
on("law", "change", () => set("law.kind", $("law").value));
on("other", "change", () => setOther($("other").value));
on("stiffness", "input", () => { $("stiffness-n").value = Number((10 ** $("stiffness").value).toPrecision(3)); });
on("stiffness", "change", () => set("wall.k_desired_n_m_per_rad", Number((10 ** $("stiffness").value).toPrecision(3))));
on("stiffness-n", "change", () => set("wall.k_desired_n_m_per_rad", $("stiffness-n").value));
on("grip", "change", () => setGrip($("grip").value));
on("delay", "input", () => { $("delay-n").value = $("delay").value; });
for (const id of ["delay", "delay-n"]) on(id, "change", () => set("timing.computational_delay_s", Number((Number($(id).value) / 1e3).toPrecision(9))));
on("encoder", "change", () => { const n = $("encoder").value; if (n === "none") set("encoder", n); else { chosen.sets.delete("encoder"); set("encoder.counts_per_rev", n); } });
on("strength", "input", () => { chosen.strength = Number($("strength").value); $("strength-n").textContent = chosen.strength.toFixed(2); tell("strength", { n_m_per_rad: chosen.strength }); share(); });
on("friction", "change", () => { if ($("friction").checked) { chosen.sets.delete("device.friction"); set("device.friction.kinetic_n_m", "3e-4"); } else set("device.friction", "none"); });
on("guard", "change", () => { const path = guardField(), words = fields.get(path).words; set(path, words ? ($("guard").checked ? words.find((w) => !["none", "off"].includes(w)) : words.find((w) => ["none", "off"].includes(w))) : String($("guard").checked)); });
const editor = new ProfileEditor($("profile"), set);
const partControls = new PartControls($("parts"), { printed: () => fields, here: () => Math.round((runs[0]?.last?.angle_rad ?? 0) * DEG) / DEG, set, add: addPart }, { "environment.profile": $("profile-part") });
on("undo", "click", undo);
$("profile-from").append(new Option("…", ""), ...SHAPES.map(([name], i) => new Option(name, i)));
on("draw", "toggle", () => { if ($("draw").open) { if (content.edits || hasFeel()) showParts(); else startDrawing(); } });
on("profile-from", "change", () => { const shape = SHAPES[$("profile-from").value]?.[1]; if (shape) { editor.shape = shape.slice(); editor.chosen = 0; editor.send(); } });
on("profile-copies", "change", () => set(`${PROFILE}.per_rev`, $("profile-copies").value));
on("profile-strength", "change", () => set(`${PROFILE}.strength_n_m`, Number((Number($("profile-strength").value) / 1e3).toPrecision(9))));
on("profile-points", "change", () => editor.resample(Number($("profile-points").value)));
on("profile-save", "click", () => save("feel.toml", "application/toml", runs[0].printed));
on("all", "toggle", () => { if ($("all").open) showAll(); });
on("record", "click", () => record(!recording));
on("csv", "click", () => saveEach((file, name) => save(`${name}.csv`, "text/csv", csv(file))));
on("scene", "click", () => saveEach((file, name) => save(`${name}.toml`, "application/toml", file.scene)));
on("link", "click", async () => {
  try { await navigator.clipboard.writeText(location.href); $("record-told").textContent = "The page's address with these settings is copied."; }
  catch { $("record-told").textContent = `Copy it from the address bar: ${location.hash}`; }
});
addEventListener("hashchange", () => { if (fromAddress()) begin(); });
document.addEventListener("visibilitychange", () => {
  if (document.hidden && running) { hiddenPause = true; run(false); } else if (!document.hidden && hiddenPause) { hiddenPause = false; run(true); }
});

PRESETS.forEach((chapter, i) => {
  const button = document.createElement("button");
  button.textContent = `${i + 1} ${chapter.name}`;
  button.dataset.step = i + 1;
  button.setAttribute("aria-keyshortcuts", String(i + 1));
  button.addEventListener("click", () => preset(i + 1));
  $("story").append(button);
});
const own = document.createElement("button");
own.textContent = `0 ${content.name}`;
own.dataset.step = 0;
own.addEventListener("click", () => preset(0));
$("story").append(own);

readInk();
requestAnimationFrame(frame);
unpacked().then((module) => tell("start", { module, ROW: content.row, FACTS: content.facts, TRACE: content.trace }), (error) => complain(`this browser cannot run WebAssembly: ${error}`));
