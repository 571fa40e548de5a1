// A torque profile, torque over angle: read from a scene, drawn around the knob, edited by hand.

/** Reads the profile of a printed scene; null without one. `copies` is per turn (0: the profile occurs once), `start` and `end` are in rad, `strength` is the largest torque in N·m, `shape` has values of -1 to 1. */
function profileOf(printed) {
  const of = (name) => printed.get(`environment.profile.${name}`)?.value;
  if (!of("shape")) return null;
  const [copies, start, end, strength] = ["per_rev", "start_rad", "end_rad", "strength_n_m"].map((name) => Number(of(name)));
  return profileFrom({ copies, start, end, strength, shape: JSON.parse(of("shape")).map(Number) });
}
function profileFrom({ copies, start, end, strength, shape }) {
  const steps = copies > 0 ? shape.length : shape.length - 1;
  const length = copies > 0 ? (2 * Math.PI) / copies : end - start;
  // Potential energy of the profile at every point, scaled to 0 to 1. The torque pushes the knob towards lower energy, as a ball rolls downhill.
  const heights = [0];
  for (let i = 0; i < steps; i += 1) heights.push(heights[i] - (shape[i] + shape[(i + 1) % shape.length]) / 2);
  const least = Math.min(...heights), wide = Math.max(...heights) - least || 1;
  return { copies, start, end, strength, shape, steps, length, heights: heights.map((h) => (strength > 0 ? (h - least) / wide : 0)) };
}

/** Reads the listed detents of a printed scene, each with its angle and width in rad and its torque in N·m; null without any. */
function listOf(printed) {
  const of = (name) => { const field = printed.get(`environment.detent_list.${name}`); return field && !field.absent && field.value ? JSON.parse(field.value).map(Number) : []; };
  const strengths = of("strengths_n_m"), widths = of("widths_rad");
  const list = of("positions_rad").map((at, i) => ({ at, strength: strengths[i] ?? strengths[0], width: widths[i] ?? widths[0] }));
  return list.some((it) => it.strength > 0) ? list : null;
}
/** The torque of listed detents, in the form of profileOf. */
function listedProfile(list) {
  const [first, last] = [list[0], list.at(-1)], start = first.at - first.width / 2, end = last.at + last.width / 2, steps = 480;
  const strength = Math.max(...list.map((it) => it.strength));
  const torque = (angle) => list.reduce((sum, it) => { const size = (angle - it.at) / (it.width / 4); return Math.abs(size) < 2 ? sum - (it.strength / strength) * Math.sign(size) * Math.min(Math.abs(size), 2 - Math.abs(size)) : sum; }, 0);
  return profileFrom({ copies: 0, start, end, strength, shape: Array.from({ length: steps + 1 }, (_, i) => torque(start + ((end - start) * i) / steps)) });
}

/** What is drawn around the knob: the listed detents take the place of a drawn torque. */
const landscapeOf = (printed) => { const list = listOf(printed); return list ? listedProfile(list) : profileOf(printed); };

/** Index of the profile's point at an angle; a fraction lies between two points. */
function placeIn(profile, angle) {
  const share = (angle - profile.start) / profile.length;
  return profile.steps * (profile.copies > 0 ? share - Math.floor(share) : Math.max(0, Math.min(1, share)));
}
function between(list, place) {
  const before = Math.min(Math.floor(place), list.length - 1), way = place - before;
  return list[before] * (1 - way) + list[(before + 1) % list.length] * way;
}
const heightAt = (profile, angle) => between(profile.heights, placeIn(profile, angle));

/** Profiles to start from: name and points, as fractions (-1 to 1) of the largest torque. */
const SHAPES = [
  ["click", [0, -0.5, -1, -0.5, 0, 0.5, 1, 0.5]],
  ["magnetic detent", [0, -1, 0, 0, 0, 0, 0, 1]],
  ["ratchet", [0, -0.3, -0.3, -0.3, -0.3, -0.3, 0, 1]],
  ["string", [0, 0, 0, -0.5, -1, 0, 1, 0.5, 0, 0]],
  ["nothing", [0, 0, 0, 0, 0, 0, 0, 0]],
];
const PROFILE = "environment.profile";

/** Editor of a profile for pointer and keys. `change(path, value)` changes a field of the scene. */
class ProfileEditor {
  constructor(canvas, change) {
    Object.assign(this, { canvas, change, shape: SHAPES[0][1].slice(), chosen: 0, before: null, sentAt: 0 });
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); this.before = null; this.dragged(event); });
    canvas.addEventListener("pointermove", (event) => { if (canvas.hasPointerCapture(event.pointerId)) this.dragged(event); });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { this.before = null; this.send(); });
    canvas.addEventListener("keydown", (event) => { if (this.key(event)) { event.preventDefault(); event.stopPropagation(); } });
  }
  /** Shows the scene's profile in the editor, unless the user is drawing. */
  take(profile) { if (this.before) return; if (this.shape.join() !== profile.shape.join()) this.shape = profile.shape.slice(); this.chosen = Math.min(this.chosen, this.shape.length - 1); this.say(); }
  at(event) {
    const box = this.canvas.getBoundingClientRect();
    const value = 1 - (2.2 * (event.clientY - box.top)) / box.height + 0.1;
    return { index: Math.max(0, Math.min(this.shape.length - 1, Math.round(((event.clientX - box.left) / box.width) * this.shape.length))), value: Math.max(-1, Math.min(1, Math.round(value * 20) / 20)) };
  }
  /** Sets every point that the pointer has passed since the last event. */
  dragged(event) {
    const to = this.at(event), from = this.before ?? to;
    const [low, high] = [from, to].sort((a, b) => a.index - b.index);
    for (let i = low.index; i <= high.index; i += 1) {
      const way = high.index > low.index ? (i - low.index) / (high.index - low.index) : 1;
      this.shape[i] = Number((low.value * (1 - way) + high.value * way).toFixed(2));
    }
    this.shape[to.index] = to.value;
    this.chosen = to.index;
    this.before = to;
    if (performance.now() - this.sentAt > 120) this.send();
  }
  key({ key, shiftKey }) {
    const n = this.shape.length, step = shiftKey ? 0.01 : 0.1;
    const moves = { ArrowLeft: n - 1, ArrowRight: 1, Home: n - this.chosen, End: 2 * n - 1 - this.chosen };
    const ways = { ArrowUp: step, ArrowDown: -step, PageUp: 0.5, PageDown: -0.5 };
    if (key in moves) this.chosen = (this.chosen + moves[key]) % n;
    else if (key in ways) { this.shape[this.chosen] = Number(Math.max(-1, Math.min(1, this.shape[this.chosen] + ways[key])).toFixed(2)); this.send(); }
    else return false;
    this.say();
    return true;
  }
  send() { this.sentAt = performance.now(); this.change(`${PROFILE}.shape`, `[${this.shape.map((v) => (Number.isInteger(v) ? v.toFixed(1) : v)).join(", ")}]`); this.say(); }
  say() {
    const value = this.shape[this.chosen];
    this.canvas.setAttribute("aria-valuenow", Math.round(100 * value));
    this.canvas.setAttribute("aria-valuetext", `point ${this.chosen + 1} of ${this.shape.length}: ${(100 * value).toFixed(0)} % of the torque, ${value > 0 ? "towards larger angles" : value < 0 ? "towards smaller angles" : "no push"}`);
  }
  /** Changes the number of points; the new points are interpolated between the old ones. */
  resample(n) { this.shape = Array.from({ length: n }, (_, i) => Number(between(this.shape, (i * this.shape.length) / n).toFixed(2))); this.chosen = 0; this.send(); }
  draw(profile, angle) {
    const { g, width, height } = sheet(this.canvas), n = this.shape.length;
    const X = (i) => (i / n) * width, Y = (v) => height * (0.5 - v / 2.2);
    stroke(g, ink.line, 1, [], () => { for (const v of [-1, 0, 1]) { g.moveTo(0, Y(v)); g.lineTo(width, Y(v)); } });
    g.fillStyle = ink.muted;
    g.textAlign = "right";
    g.textBaseline = "top";
    g.fillText("pushes towards larger angles", width - 4, 2);
    g.textBaseline = "bottom";
    g.fillText("towards smaller angles", width - 4, height - 2);
    const all = profile?.copies === 0 ? this.shape : [...this.shape, this.shape[0]];
    stroke(g, ink.force, 2, [], () => all.forEach((v, i) => (i ? g.lineTo(X(i), Y(v)) : g.moveTo(X(i), Y(v)))));
    this.shape.forEach((v, i) => { g.fillStyle = i === this.chosen ? ink.b : ink.force; g.beginPath(); g.arc(X(i), Y(v), i === this.chosen ? 6 : 4, 0, 7); g.fill(); });
    if (!profile || angle === null) return;
    const place = placeIn(profile, angle);
    stroke(g, ink.a, 1.5, [3, 3], () => { g.moveTo(X(place), 0); g.lineTo(X(place), height); });
    g.fillStyle = ink.a;
    g.beginPath();
    g.arc(X(place), Y(between(this.shape, place)), 6, 0, 7);
    g.fill();
  }
}
