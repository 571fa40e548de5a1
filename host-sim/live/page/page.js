// The page of one axis: keeps the user's choices, controls the simulation loop and shows its results.
const content = JSON.parse(document.getElementById("content").textContent);
const $ = (id) => document.getElementById(id);
const COLUMNS = ["clock", ...content.row];
const WINDOW_S = 4, PLANE_S = 2;
const ENCODERS = [["none", "exact position"], ["1024", "1,024 counts a turn"], ["4096", "4,096 (12 bit)"], ["16384", "16,384 (14 bit)"], ["40000", "40,000 (optical disc)"], ["1000000", "1,000,000"]];

/** The user's choices: base scene, changes of it (`sets`), and changes for the second run (`b`; null: no second run). */
let chosen = { base: "own", step: 0, sets: new Map(), b: null, automatic: false, speed: 1, strength: 0.3 };
let good = null, pending = false, restoring = false, running = true, recording = false, recorded = null, hiddenPause = false;
let runs = [], fields = new Map(), aim = null, counted = { done: 0, late: 0, skipped: 0 }, rate = { at: 0, done: 0, ticks: 0, frames: 0, fps: 0 };
const seen = { rows: 0 };

const copy = (c) => ({ ...c, sets: new Map(c.sets), b: c.b && new Map(c.b) });
const baseOf = (c) => (c.base === "own" ? content.scene : c.base);
const pairs = (map) => [...map].map(([key, value]) => `${key}=${value}`);
const textOf = (c, more) => `${baseOf(c)}\0${[...pairs(c.sets), ...(more ? pairs(more) : [])].join("\n")}\n`;
const mapOf = (lines) => new Map((lines ?? []).map((line) => { const at = line.indexOf("="); return [line.slice(0, at), line.slice(at + 1)]; }));

const worker = new Worker(URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" })));
const tell = (type, more) => worker.postMessage({ type, ...more });

function open(keep) {
  pending = true;
  tell("open", { a: textOf(chosen), b: chosen.b && textOf(chosen, chosen.b), keep });
  share();
}

function complain(text) {
  $("error").textContent = text;
  $("error").hidden = !text;
}

/** Parses a scene's printed text: every field with its value, its meaning and, if it has a choice of words, these words. */
function parse(printed) {
  const out = new Map();
  let table = "";
  for (const line of printed.split("\n")) {
    const heading = /^(# )?\[([a-z0-9_.]+)\](?: absent: (.*))?/.exec(line);
    if (heading) {
      table = `${heading[2]}.`;
      if (heading[1]) out.set(heading[2], { value: "none", about: heading[3], absent: true });
      continue;
    }
    const absent = /^# ([a-z0-9_]+) absent: (.*)$/.exec(line);
    if (absent) { out.set(table + absent[1], { value: "", about: absent[2], absent: true }); continue; }
    const field = /^([a-z0-9_]+) = ("(?:[^"\\]|\\.)*"|[^#]*?)\s*(?:# (.*))?$/.exec(line);
    if (!field) continue;
    const text = field[2].startsWith('"');
    const value = text ? JSON.parse(field[2]) : field[2];
    const about = field[3] ?? "", cut = about.lastIndexOf(": ");
    const words = text && cut > 0 && /^[a-z0-9-]+(, [a-z0-9-]+)+$/.test(about.slice(cut + 2)) ? about.slice(cut + 2).split(", ") : null;
    out.set(table + field[1], { value, about: words ? about.slice(0, cut) : about, words });
  }
  return out;
}

const field = (path) => fields.get(path)?.value;
function options(select, list, value) {
  const all = list.some(([v]) => v === value) ? list : [[value, value], ...list];
  const made = JSON.stringify(all);
  if (select.dataset.made !== made) {
    select.replaceChildren(...all.map(([v, name]) => new Option(name, v)));
    select.dataset.made = made;
  }
  select.value = value;
}

/** Shows the settings of the running scene in the page's controls. */
function show() {
  const words = (path) => (fields.get(path)?.words ?? []).map((word) => [word, word]);
  options($("feel"), [["", `of this page: ${content.name}`], ...content.feels.map(([name]) => [name, name])], feelOf(chosen.base) ? chosen.base : "");
  options($("law"), words("law.kind"), field("law.kind"));
  const other = chosen.b ? (chosen.b.get("law.kind") ?? "same") : "";
  options($("other"), [["", "nothing"], ["same", chosen.b && !chosen.b.get("law.kind") ? `the same, ${pairs(chosen.b).join(", ")}` : "the same law"], ...words("law.kind")], other);
  options($("grip"), [["none", "none: nobody holds it"], ["light", "light"], ["medium", "medium"], ["firm", "firm"]], field("operator.grip"));
  const counts = field("encoder.counts_per_rev");
  options($("encoder"), ENCODERS, counts === undefined ? "none" : String(Number(counts)));
  const k = Number(field("wall.k_desired_n_m_per_rad"));
  $("stiffness").value = Math.log10(Math.max(k, 0.1));
  $("stiffness-n").value = k;
  const delay = Number((Number(field("timing.computational_delay_s")) * 1e3).toPrecision(6));
  $("delay").value = delay;
  $("delay-n").value = delay;
  $("friction").checked = field("device.friction.kinetic_n_m") !== undefined;
  const guard = guardField();
  for (const part of document.querySelectorAll(".guard")) part.hidden = !guard;
  if (guard) $("guard").checked = guardOn(guard);
  $("strength").value = chosen.strength;
  $("strength-n").textContent = chosen.strength.toFixed(2);
  $("speed").value = String(chosen.speed);
  pressing();
  $("automatic").disabled = !runs[0]?.facts.motion_s;
  const nobody = field("operator.grip") === "none" ? "No hand holds the knob: it stays where it is.\n" : "";
  const warnings = (nobody + (runs[0]?.warnings ?? "")).trim(), many = warnings.split("\n").length;
  $("warnings").textContent = warnings;
  $("warned").hidden = !warnings;
  $("warned").firstElementChild.textContent = nobody ? nobody.trim() : many === 1 ? "One warning" : `${many} warnings`;
  if ($("all").open) showAll();
  if ($("draw").open) showParts();
  $("undo").disabled = !steps.length;
  const felt = runs[0], there = felt ? { ...felt.parts, wall: felt.facts.has_wall !== 0 || walls(felt.facts).length > 0, profile: felt.profile } : {};
  for (const mark of document.querySelectorAll("[data-part]")) mark.hidden = !there[mark.dataset.part];
}

// The drawn knob: a torque profile that the user draws.
/** Starts with a torque profile to change by drawing: five clicks in a turn, in place of the wall. */
function startDrawing() {
  remember("draw");
  closeFile();
  const shape = `[${SHAPES[0][1].map((v) => v.toFixed(1)).join(", ")}]`;
  chosen = { base: "smooth", step: 0, sets: new Map([[`${PROFILE}.per_rev`, "5"], [`${PROFILE}.strength_n_m`, "0.02"], [`${PROFILE}.shape`, shape]]), b: null, automatic: !wantsStill, speed: 1, strength: 0.3 };
  begin();
}
/** Whether the scene has a part besides a wall. */
const hasFeel = () => PARTS.some((part) => !part.flag && hasPart(fields, part));
function showParts() {
  if (!fields.size) return;
  partControls.take();
  showProfile();
}
function showProfile() {
  const profile = runs[0]?.drawn;
  if (!profile) return;
  editor.take(profile);
  if (document.activeElement !== $("profile-copies")) $("profile-copies").value = profile.copies;
  if (document.activeElement !== $("profile-strength")) $("profile-strength").value = Number((1e3 * profile.strength).toPrecision(6));
  const points = String(profile.shape.length);
  options($("profile-points"), ["8", "16", "32", "64"].map((n) => [n, n]), points);
}

const guardField = () => ["law.guard.enabled", "law.guard.kind", "law.guard.on"].find((path) => fields.has(path));
const guardOn = (path) => !["false", "none", "off"].includes(field(path));

/** The input of each setting in the list of all settings, and the text beside it, by path and kind. */
let listed = new Map();
function showAll() {
  const all = [...fields].filter(([path]) => !["name", "description", "operator.motion.file"].includes(path));
  const wordsOf = ({ words, value }) => words ?? (value === "true" || value === "false" ? ["true", "false"] : null);
  const keyed = all.map(([path, one]) => [`${path} ${wordsOf(one) ?? ""}`, path, one]);
  // Rows are kept while the same settings are there, so that a field keeps the focus and what is being typed.
  if (keyed.length !== listed.size || !keyed.every(([key]) => listed.has(key))) {
    listed = new Map(keyed.map(([key, path, one]) => [key, rowOf(path, wordsOf(one))]));
    $("fields").replaceChildren(...[...listed.values()].map(({ label }) => label));
  }
  for (const [key, , { value, about, absent }] of keyed) {
    const { input, small } = listed.get(key);
    small.textContent = absent ? `absent: ${about}` : about;
    if (input !== document.activeElement || input.tagName === "SELECT") input.value = value;
  }
}
function rowOf(path, words) {
  const label = document.createElement("label"), name = document.createElement("span"), small = document.createElement("small");
  name.append(path, small);
  const input = document.createElement(words ? "select" : "input");
  if (words) input.append(...words.map((word) => new Option(word, word)));
  else Object.assign(input, { type: "text", inputMode: "decimal" });
  input.addEventListener("change", () => set(path, input.value.trim() || "none"));
  label.append(name, input);
  return { label, input, small };
}

/** Sets how the knob is held. The grip `none` also removes the hand's motion. */
function setGrip(grip) {
  remember("operator.grip");
  chosen.sets.delete("operator.grip");
  chosen.sets.delete("operator.motion.kind");
  if (grip === "none") {
    for (const key of [...chosen.sets.keys()]) if (key.startsWith("operator.motion.")) chosen.sets.delete(key);
    chosen.sets.set("operator.motion.kind", "none");
  }
  set("operator.grip", grip);
}

/** Changes a setting while the simulation runs. */
function set(path, value) {
  remember(path);
  chosen.sets.delete(path);
  if (value === "none" || path === path.split(".")[0]) for (const key of [...chosen.sets.keys()]) if (key.startsWith(`${path}.`)) chosen.sets.delete(key);
  chosen.sets.set(path, value);
  open(true);
}

function setOther(law) {
  chosen.b = law === "" ? null : law === "same" ? (chosen.b ?? new Map()) : new Map([["law.kind", law]]);
  if (law === "same") chosen.b.delete("law.kind");
  open(true);
}

/** Whether the user's system asks for reduced motion. The knob then moves only when the user moves it. */
const wantsStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
function preset(step, demonstrate) {
  closeFile();
  const chapter = PRESETS[step - 1];
  chosen = { base: chapter ? "thesis-knob" : "own", step, sets: chapter ? mapOf(chapter.sets) : mapOf(content.sets), b: chapter?.b ? mapOf(chapter.b) : null, automatic: Boolean(chapter) || demonstrate === true, speed: 1, strength: chapter?.strength ?? 0.3 };
  begin();
}

/** Starts a shipped knob feel (clicks, switches, spring return) in place of the wall; without a name, the page's own scene. */
function feel(name) {
  if (!name) { preset(0); return; }
  closeFile();
  chosen = { base: name, step: 0, sets: new Map(), b: null, automatic: !wantsStill, speed: 1, strength: 0.3 };
  begin();
}
const feelOf = (name) => content.feels.find(([own]) => own === name);

/** Starts the chosen scene from its beginning. */
function begin() {
  aim = null;
  for (const button of $("story").children) {
    if (Number(button.dataset.step) === chosen.step && !feelOf(chosen.base)) button.setAttribute("aria-current", "step"); else button.removeAttribute("aria-current");
  }
  const chapter = PRESETS[chosen.step - 1];
  const title = document.createElement("strong");
  const felt = feelOf(chosen.base);
  title.textContent = chapter ? `${chosen.step}. ${chapter.name}.` : `${felt ? felt[0] : content.name}.`;
  $("told").replaceChildren(title, chapter ? chapter.text : felt ? felt[1] : content.description);
  tell("strength", { n_m_per_rad: chosen.strength });
  open(false);
  tell("automatic", { on: chosen.automatic });
  run(true);
}

function press(id, on) { $(id).setAttribute("aria-pressed", String(on)); }
function pressing() {
  press("automatic", chosen.automatic);
  $("by-itself").style.visibility = chosen.automatic ? "" : "hidden";
}
function run(on) {
  running = on;
  $("run").textContent = on ? "Pause" : "Run";
  $("step").disabled = on;
  tell("run", { on, speed: chosen.speed });
}
function automatic(on) {
  chosen.automatic = on && Boolean(runs[0]?.facts.motion_s);
  pressing();
  tell("automatic", { on: chosen.automatic });
  share();
}
function record(on) {
  closeFile();
  recording = on;
  press("record", on);
  $("record").textContent = on ? "Stop" : "Record";
  if (on) { letGo(); $("csv").disabled = $("scene").disabled = true; $("record-told").textContent = "Recording every tick from the start of the run."; }
  tell("record", { on });
}
/** Turns the run back by a number of ticks, after pausing it. */
function turnBack(ticks) {
  closeFile();
  if (running) run(false);
  tell("back", { ticks });
}
function turnedBack({ a, b, most, why }) {
  $("record-told").textContent = why;
  if (!a) return;
  [a, b].forEach((rows, i) => {
    if (!rows || !runs[i]) return;
    Object.assign(runs[i], most[i]);
    runs[i].ring.end = 0;
    runs[i].ring.push(rows);
    runs[i].last = rows.length ? Object.fromEntries(COLUMNS.map((name) => [name, runs[i].ring.at(name, 0)])) : null;
  });
  aim = null;
}
function restart() {
  closeFile();
  letGo();
  tell("reset");
}

// Pointer and keys move the hand.
function setAim(angle) {
  closeFile();
  if (chosen.automatic) automatic(false);
  const about = runs[0] ? middle(runs[0]) : 0.5;
  aim = Math.max(about - 3, Math.min(about + 3, angle));
  tell("aim", { rad: aim });
}
function letGo() { aim = null; tell("aim", { rad: null }); }
const standing = () => aim ?? runs[0]?.last?.angle_rad ?? 0;

/** Quotes a text for a shell, so that it is a single word. The page's address may come from a stranger. Control characters and marks of writing direction become U+FFFD. */
function shellWord(text) {
  if (/^[\w.,/:=+@%-]+$/.test(text)) return text;
  return `'${text.replace(/[\u0000-\u001f\u007f-\u009f\u200e\u200f\u2028-\u202e\u2066-\u2069]/g, "\ufffd").replaceAll("'", "'\\''")}'`;
}

/** Writes the chosen settings into the page's address, and shows the shell command for them. */
function share() {
  const query = new URLSearchParams();
  if (chosen.base !== "own") query.set("base", chosen.base);
  if (chosen.step) query.set("step", chosen.step);
  for (const line of pairs(chosen.sets)) query.append("set", line);
  if (chosen.b) { query.append("beside", ""); for (const line of pairs(chosen.b)) query.append("b", line); }
  if (chosen.automatic) query.set("press", "1");
  if (chosen.speed !== 1) query.set("speed", chosen.speed);
  if (chosen.strength !== 0.3) query.set("strength", chosen.strength);
  history.replaceState(null, "", `#${query}`);
  const line = (pair) => (pair.startsWith("preset=") ? `--preset=${shellWord(pair.slice(7))}` : `--set=${shellWord(pair)}`);
  // `content.source` is quoted already, word by word.
  $("command").textContent = ["touchstone live", chosen.base === "own" ? content.source : shellWord(chosen.base), ...pairs(chosen.sets).map(line)].join(" ");
}
function fromAddress() {
  const query = new URLSearchParams(location.hash.slice(1));
  const known = (name, least, most, otherwise) => { const n = Number(query.get(name) ?? otherwise); return n >= least && n <= most ? n : otherwise; };
  if (![...query.keys()].length) return false;
  chosen = {
    base: /^[\w.][\w.-]*$/.test(query.get("base") ?? "") ? query.get("base") : "own", step: known("step", 0, PRESETS.length, 0), sets: mapOf(query.getAll("set")),
    b: query.has("beside") ? mapOf(query.getAll("b")) : null, automatic: query.has("press"), speed: known("speed", 0.001, 1, 1), strength: known("strength", 0.01, 10, 0.3),
  };
  return true;
}

function opened({ a, b, keep }) {
  pending = false;
  good = copy(chosen);
  // The message on refused settings stays until settings are accepted.
  if (!restoring) complain("");
  restoring = false;
  fields = parse(a.printed);
  const sides = [a, b].filter((side) => side);
  runs = sides.map((side, i) => {
    const before = keep ? runs[i] : null;
    const laws = parse(side.printed);
    const guarded = laws.get("law.guard.on")?.value === "true" ? ", guarded" : "";
    const title = `${laws.get("law.kind").value}, ${number(side.facts.k_desired_n_m_per_rad)} N·m/rad${guarded}`;
    const length = Math.max(2000, Math.ceil(Math.min(side.facts.rate_hz, 4000) * WINDOW_S * 1.1));
    const ring = before && before.ring.length === length ? before.ring : new Ring(COLUMNS, length);
    return { ...side, title, ring, profile: landscapeOf(laws), drawn: profileOf(laws), parts: partsOf(laws), second: i === 1, last: before?.last ?? null, peak: 0, got: 0 };
  });
  // With a changed setting or a second law, the run is no longer comparable with the opened file.
  if (openedFile && !keep && !b) runs.push(fileRun(a)); else closeFile();
  if (chosen.automatic && !runs[0].facts.motion_s) automatic(false);
  if (!keep && !content.edits) $("draw").open = Boolean(runs[0].profile);
  show();
}

function took({ a, b, count, recorded: ticks }) {
  if (pending) return;
  [a, b].forEach((rows, i) => {
    const one = runs[i];
    if (!rows?.length || !one) return;
    one.ring.push(rows);
    seen.rows += rows.length / COLUMNS.length;
    one.last = Object.fromEntries(COLUMNS.map((name) => [name, one.ring.at(name, 0)]));
    // Most energy that the hand got out in any window of time, J: the largest fall of `energy_hand_j` from an earlier peak.
    for (let at = COLUMNS.indexOf("energy_hand_j"); at < rows.length; at += COLUMNS.length) {
      one.peak = Math.max(one.peak, rows[at]);
      one.got = Math.max(one.got, one.peak - rows[at]);
    }
  });
  if (a) follow(a);
  counted = count;
  if (ticks !== null && recording) $("record-told").textContent = `Recording: ${(ticks / runs[0].facts.rate_hz).toFixed(1)} s, ${ticks} ticks.`;
  if (a && chosen.speed === 1) play(a);
}

worker.onmessage = ({ data }) => {
  if (data.type === "ready") {
    if (content.edits) { $("draw").open = true; $("head").textContent = "A feel under your hand"; $("begin").textContent = "Drag the knob, and change its parts under Edit the feel."; }
    if (!fromAddress()) preset(0, !wantsStill); else begin(); }
  if (data.type === "opened") opened(data);
  if (data.type === "rows") took(data);
  // The run begins again, with no energy in any account.
  if (data.type === "reset") for (const one of runs) { one.ring.end = 0; Object.assign(one, { peak: 0, got: 0 }); }
  if (data.type === "back") turnedBack(data);
  if (data.type === "recorded") {
    recording = false;
    press("record", false);
    $("record").textContent = "Record";
    recorded = data;
    const some = data.ticks > 0;
    $("csv").disabled = $("scene").disabled = !some;
    $("record-told").textContent = some ? `${data.ticks} ticks recorded${data.why ? `, until ${data.why}` : ""}. Save both into one folder: touchstone run live-a.toml gives the same forces to the bit.` : "Nothing was recorded.";
  }
  if (data.type === "error") {
    pending = false;
    complain(data.text);
    // A refused change is no step to undo.
    if (good && steps.length && textOf(steps.at(-1)) === textOf(good)) steps.pop();
    if (good) { restoring = true; pending = true; chosen = copy(good); tell("open", { a: textOf(chosen), b: chosen.b && textOf(chosen, chosen.b), keep: true }); good = null; share(); }
  }
};
worker.onerror = (event) => complain(`the loop stopped: ${event.message}`);

// Saves recorded runs as files.
function saveEach(make) {
  recorded?.files.forEach((file, i) => { if (file) make(file, `live-${"ab"[i]}`); });
}
/** A number with a decimal point, as in every table of the program. Readers take a column that begins with many integers for one of integers. */
const decimal = (number) => (Number.isInteger(number) && Math.abs(number) < 1e21 ? number.toFixed(1) : String(number));
function csv({ rows }) {
  const names = content.row.slice(0, content.trace), lines = [names.join(",")];
  for (let at = 0; at < rows.length; at += names.length) lines.push(Array.from(rows.subarray(at, at + names.length), decimal).join(","));
  return `${lines.join("\n")}\n`;
}

// Plays the motor's force as sound. A steady force is silent; a limit cycle is audible.
let audio = null, mean = 0, next = 0;
function play(rows) {
  if (!audio || audio.state !== "running") return;
  const n = COLUMNS.length, at = COLUMNS.indexOf("motor_force_n_m"), ticks = rows.length / n, hz = Math.min(runs[0].facts.rate_hz, 4000);
  const more = Math.max(1, Math.ceil(8000 / hz)), samples = new Float32Array(ticks * more);
  let before = mean;
  for (let i = 0; i < ticks; i += 1) {
    const force = rows[i * n + at];
    mean += (force - mean) * (1 - Math.exp(-1 / (0.03 * hz)));
    const value = Math.max(-1, Math.min(1, (force - mean) * 4));
    for (let j = 0; j < more; j += 1) samples[i * more + j] = before + ((value - before) * (j + 1)) / more;
    before = value;
  }
  const buffer = audio.createBuffer(1, samples.length, hz * more), source = audio.createBufferSource();
  buffer.copyToChannel(samples, 0);
  source.buffer = buffer;
  source.connect(audio.destination);
  if (next < audio.currentTime || next > audio.currentTime + 0.4) next = audio.currentTime + 0.08;
  source.start(next);
  next += buffer.duration;
}
function sound() {
  audio ??= new AudioContext();
  const on = $("sound").getAttribute("aria-pressed") !== "true";
  press("sound", on);
  if (on) audio.resume(); else audio.suspend();
}
