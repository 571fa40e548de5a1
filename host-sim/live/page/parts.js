// The parts of a feel: what a scene has, controls that add, change and remove each part, and undo.
const DEG = 180 / Math.PI;
/** A list of numbers as scenes have it. */
const asList = (values) => `[${values.map((value) => { const short = Number(value.toPrecision(9)); return Number.isInteger(short) ? short.toFixed(1) : short; }).join(", ")}]`;
// Every part: its table, its name, its meaning, the values with which it is added, and its fields: name, label, factor from the
// scene's unit to the shown one. `here` is the knob's angle in rad, rounded to a whole degree. `instead` names the table of the
// part that this part replaces when it is added.
const PARTS = [
  { table: "environment.first_wall", name: "Wall", about: "hard, on one side", flag: true, start: () => ({}),
    fields: [["wall.surface_rad", "begins at, °", DEG], ["wall.k_desired_n_m_per_rad", "stiffness, N·m/rad", 1]] },
  { table: "environment.wall2", name: "Second wall", about: "hard, on the side of your choice", start: (here) => ({ at_rad: here - 30 / DEG, solid: "below" }),
    fields: [["at_rad", "begins at, °", DEG], ["solid", "solid", ["below", "above"]]] },
  { table: "environment.endstops", name: "End stops", about: "a wall at either end", start: (here) => ({ lower_rad: here - 60 / DEG, upper_rad: here + 60 / DEG }),
    fields: [["lower_rad", "from, °", DEG], ["upper_rad", "to, °", DEG]] },
  { table: "environment.detents", name: "Detents", about: "angles that pull the knob in", start: () => ({ per_rev: 24, strength_n_m: 0.012 }),
    fields: [["per_rev", "in a turn", 1], ["strength_n_m", "torque, mN·m", 1e3], ["centre_rad", "one is at, °", DEG]] },
  { table: "environment.detent_list", name: "Listed detents", about: "angles of your choice that pull the knob in", instead: "environment.profile",
    start: (here) => ({ positions_rad: asList([-60, -30, 0, 30, 60].map((at) => here + at / DEG)), strengths_n_m: "[0.02]", widths_rad: asList([30 / DEG]) }),
    fields: [["positions_rad", "angles, °", DEG, "list"], ["strengths_n_m", "torque, mN·m: one or each", 1e3, "list"], ["widths_rad", "width, °: one or each", DEG, "list"]] },
  { table: "environment.click", name: "Clicks", about: "short pulses when the knob passes", start: () => ({ per_rev: 24, strength_n_m: 0.015 }),
    fields: [["per_rev", "in a turn", 1], ["strength_n_m", "torque, mN·m", 1e3], ["duration_s", "length, ms", 1e3], ["centre_rad", "one is at, °", DEG]] },
  { table: "environment.spring", name: "Centre spring", about: "draws the knob back", start: (here) => ({ centre_rad: here, stiffness_n_m_per_rad: 0.03, strength_n_m: 0.03 }),
    fields: [["centre_rad", "centre, °", DEG], ["stiffness_n_m_per_rad", "stiffness, mN·m/rad", 1e3], ["strength_n_m", "at most, mN·m", 1e3]] },
  { table: "environment.dry_friction", name: "Friction", about: "the same at every speed; holds at rest", start: () => ({ strength_n_m: 0.005 }),
    fields: [["strength_n_m", "torque, mN·m", 1e3], ["stretch_rad", "gives way for, °", DEG]] },
  { table: "environment.damper", name: "Damper", about: "the faster, the heavier", start: () => ({ damping_n_m_s_per_rad: 0.0005 }),
    fields: [["damping_n_m_s_per_rad", "damping, mN·m·s/rad", 1e3]] },
  { table: "environment.inertia", name: "Inertia", about: "heavier to start and to stop", start: () => ({ inertia_kg_m2: 1e-5 }),
    fields: [["inertia_kg_m2", "inertia, g·cm²", 1e7]] },
  { table: "environment.profile", name: "Drawn torque", about: "a curve over the angle, drawn below", instead: "environment.detent_list", start: () => ({ per_rev: 5, strength_n_m: 0.02 }), fields: [] },
];
/** The numbers that a person wrote, separated by commas or spaces; what is no number becomes NaN, which the scene refuses. */
const numbersOf = (text) => text.split(/[\s,;]+/).filter(Boolean).map(Number);
/** Path of a part's field in the scene. */
const pathIn = (part, name) => (name.includes(".") ? name : `${part.table}.${name}`);
/** Whether a printed scene has a part. */
function hasPart(printed, part) {
  if (part.flag) return printed.get(part.table)?.value !== "false";
  return !printed.get(part.table)?.absent && [...printed.keys()].some((key) => key.startsWith(`${part.table}.`));
}
const rounded = (value) => (typeof value === "number" ? Number(value.toPrecision(9)) : value);

/** What the picture needs of a printed scene's parts; null for a part that is not there or has no torque. */
function partsOf(printed) {
  const of = (path) => { const field = printed.get(path); return field && !field.absent ? Number(field.value) : NaN; };
  const ring = (table) => {
    const copies = of(`${table}.per_rev`), strength = of(`${table}.strength_n_m`);
    return strength > 0 ? { pitch: copies > 0 ? (2 * Math.PI) / copies : of(`${table}.pitch_rad`), centre: of(`${table}.centre_rad`), strength } : null;
  };
  const [centre, stiffness, strength] = ["centre_rad", "stiffness_n_m_per_rad", "strength_n_m"].map((name) => of(`environment.spring.${name}`));
  const friction = of("environment.dry_friction.strength_n_m"), damping = of("environment.damper.damping_n_m_s_per_rad");
  return {
    detents: listOf(printed) ? { angles: listOf(printed).map((it) => it.at) } : ring("environment.detents"), clicks: ring("environment.click"),
    spring: stiffness > 0 && strength > 0 ? { centre, reach: strength / stiffness } : null,
    friction: friction > 0 ? { stretch: of("environment.dry_friction.stretch_rad") } : null,
    damper: damping > 0 ? { damping } : null,
    inertia: of("environment.inertia.inertia_kg_m2") > 0 || null,
  };
}
/** Angles of a ring's marks between two angles; null if a regular ring has more than `most` of them, too many to draw apart. */
function marksOf({ pitch, centre, angles }, from, to, most) {
  if (angles) return angles.filter((at) => from <= at && at <= to);
  if ((to - from) / pitch > most) return null;
  const out = [];
  for (let i = Math.ceil((from - centre) / pitch); centre + i * pitch <= to; i += 1) out.push(centre + i * pitch);
  return out;
}

/** The controls of all parts in a box. `page` has `printed()`, `here()`, `set(path, value)`, `add(table, values)`. `inner` are elements that belong into a part's body, by table. */
class PartControls {
  constructor(box, page, inner) {
    this.page = page;
    this.rows = PARTS.map((part) => {
      const id = `part-${part.table.split(".")[1]}`, row = document.createElement("div"), label = document.createElement("label"), tick = document.createElement("input"), body = document.createElement("div"), about = document.createElement("small");
      row.className = "part";
      Object.assign(tick, { type: "checkbox", id });
      about.textContent = part.about;
      label.append(tick, ` ${part.name} `, about);
      body.className = "grid";
      tick.addEventListener("change", () => (tick.checked ? this.add(part) : page.set(part.table, part.flag ? "false" : "none")));
      const inputs = part.fields.map(([name, text, unit, list]) => {
        const words = Array.isArray(unit), input = document.createElement(words ? "select" : "input"), named = document.createElement("label");
        Object.assign(input, { id: `${id}-${name.split(".").at(-1)}` });
        if (words) input.append(...unit.map((word) => new Option(word, word))); else Object.assign(input, list ? { type: "text", inputMode: "text", spellcheck: false } : { type: "number", step: "any" });
        named.htmlFor = input.id;
        named.textContent = text;
        input.setAttribute("aria-label", `${part.name}: ${text}`);
        input.addEventListener("change", () => page.set(pathIn(part, name), words ? input.value : list ? asList(numbersOf(input.value).map((value) => value / unit)) : String(Number((Number(input.value) / unit).toPrecision(9)))));
        body.append(named, input);
        return { input, path: pathIn(part, name), unit, list };
      });
      row.append(label, body);
      if (inner[part.table]) row.append(inner[part.table]);
      box.append(row);
      return { part, tick, body, inputs, inner: inner[part.table] };
    });
  }
  add(part) { this.page.add(part, Object.fromEntries(Object.entries(part.start(this.page.here())).map(([name, value]) => [pathIn(part, name), String(rounded(value))]))); }
  /** Shows the parts of the running scene. A field in which the user writes keeps its text. */
  take() {
    const printed = this.page.printed();
    for (const { part, tick, body, inputs, inner } of this.rows) {
      tick.checked = hasPart(printed, part);
      body.hidden = !tick.checked || !inputs.length;
      if (inner) inner.hidden = !tick.checked;
      for (const { input, path, unit, list } of inputs) {
        const field = printed.get(path);
        if (!field || field.absent || (document.activeElement === input && input.tagName === "INPUT")) continue;
        input.value = Array.isArray(unit) ? field.value : list ? JSON.parse(field.value).map((value) => Number((value * unit).toPrecision(6))).join(", ") : Number((Number(field.value) * unit).toPrecision(6));
      }
    }
  }
}

// Choices before each change, for undo. Changes of one setting within a second are one step.
const MOST_STEPS = 200, ONE_STEP_MS = 1000;
let steps = [], stepped = { path: null, at: 0 };
function remember(path) {
  const now = performance.now(), goesOn = path === stepped.path && now - stepped.at < ONE_STEP_MS;
  stepped = { path, at: now };
  if (!goesOn) steps = [...steps, copy(chosen)].slice(-MOST_STEPS);
}
function undo() {
  const last = steps.pop();
  stepped.path = null;
  if (!last) return;
  const { base, step, sets, b } = last, stays = base === chosen.base;
  chosen = { ...chosen, base, step, sets, b };
  closeFile();
  if (stays) open(true); else begin();
}

/** Adds a part of a feel. `values` are the settings with which it begins, by path. */
function addPart(part, values) {
  remember(`add ${part.table}`);
  chosen.sets.delete(part.table);
  if (part.flag) chosen.sets.set(part.table, "true");
  if (part.instead) {
    for (const path of [...chosen.sets.keys()]) if (path.startsWith(`${part.instead}.`)) chosen.sets.delete(path);
    chosen.sets.set(part.instead, "none");
  }
  for (const [path, value] of Object.entries(values)) { chosen.sets.delete(path); chosen.sets.set(path, value); }
  open(true);
}
