// The stage: the knob, an enlarged view (lens) of the wall's surface, and the last 0.6 s as a strip below.

const STRIP_S = 0.6, STRIP_ROW = 1.5;

/** All walls of a run: the surface's angle in rad, and 1 if the wall is solid at larger angles, -1 if at smaller ones. */
const walls = (f) => [[f.has_wall === 0 ? NaN : f.surface_rad, 1], [f.wall2_rad, f.wall2_side], [f.wall3_rad, f.wall3_side], [f.wall4_rad, f.wall4_side], [f.lower_end_rad, -1], [f.upper_end_rad, 1]]
  .filter(([at]) => Number.isFinite(at));
/** Angle at the centre of lens and pointer, rad: the wall's surface, or the knob's angle if there is no wall. */
const middle = ({ facts, last }) => (facts.has_wall === 0 ? last?.angle_rad ?? facts.angle_rad : facts.surface_rad);
/** Half the width of the lens in rad, for a knob without a wall. */
const FEEL_HALF = 0.35;
/** Largest number of detents in a turn that are drawn as marks; more are drawn as a ring. */
const MOST_MARKS = 120;

/** Draws the last tick of each run in a part of the canvas. */
class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.views = [new Lens(), new Lens()];
    this.half = 0.02;
    this.knobs = [];
  }
  draw(runs, hand) {
    const { g, width, height } = sheet(this.canvas);
    const wide = width > 620 || runs.length === 1;
    this.knobs = [];
    this.follow(runs);
    runs.forEach((run, i) => {
      const n = runs.length;
      const box = wide ? { x: (width / n) * i, y: 0, w: width / n, h: height } : { x: 0, y: (height / n) * i, w: width, h: height / n };
      this.side(g, box, run, this.views[i], hand, n > 1);
    });
  }
  /** Adjusts half the width of the lenses, rad. All lenses have the same width, so that two runs can be compared. */
  follow(runs) {
    let widest = 0.01;
    for (const run of runs) {
      const { facts, ring } = run, at = middle(run);
      if (facts.has_wall === 0) { widest = Math.max(widest, FEEL_HALF / 1.25); continue; }
      ring.since(STRIP_S, (i) => { widest = Math.max(widest, Math.min(0.6, Math.abs(ring.columns.angle_rad[i] - at))); });
    }
    // The width changes in round steps, because a lens that zooms all the time cannot be read.
    const wanted = round(widest * 1.25);
    this.half += (wanted > this.half ? 0.4 : 0.15) * (wanted - this.half);
  }
  side(g, box, run, lens, hand, named) {
    const sideways = box.w > 1.5 * box.h;
    const knob = sideways ? { x: box.x, y: box.y, w: box.w * 0.36, h: box.h } : { x: box.x, y: box.y, w: box.w, h: box.h * 0.5 };
    const rest = sideways ? { x: box.x + box.w * 0.37, y: box.y, w: box.w * 0.62, h: box.h } : { x: box.x + 6, y: box.y + box.h * 0.5, w: box.w - 12, h: box.h * 0.5 };
    const colour = run.second ? ink.b : ink.a;
    if (named) {
      g.fillStyle = colour;
      g.textAlign = "left";
      g.textBaseline = "top";
      g.font = "600 13px system-ui, sans-serif";
      g.fillText(`${run.second ? "beside: " : ""}${run.title}`, box.x + 6, box.y + 1);
      g.font = "12px system-ui, sans-serif";
    }
    this.knob(g, knob, run, colour, hand);
    lens.draw(g, rest, run, colour, this.half, !named || !sideways);
  }
  knob(g, box, run, colour, hand) {
    const r = Math.max(20, Math.min(box.w, box.h) * 0.32), x = box.x + box.w / 2, y = box.y + box.h / 2 + 6;
    this.knobs.push({ x, y, r });
    const turn = (angle) => angle - Math.PI / 2, at = (angle, d) => [x + d * Math.cos(turn(angle)), y + d * Math.sin(turn(angle))];
    const { surface_rad: surface } = run.facts, row = run.last;
    // Each wall is a hatched sector that begins at its surface. A wall more than half a turn away is not drawn.
    for (const [from, way] of walls(run.facts)) {
      if (row && Math.abs(from - row.angle_rad) > Math.PI) continue;
      const low = Math.min(from, from + 0.9 * way), high = low + 0.9;
      g.fillStyle = ink.wall;
      g.beginPath();
      g.moveTo(...at(low, r * 1.08));
      g.arc(x, y, r * 1.4, turn(low), turn(high));
      g.arc(x, y, r * 1.08, turn(high), turn(low), true);
      g.fill();
      stroke(g, ink.hatch, 1, [], () => { for (let a = low; a < high; a += 0.09) { g.moveTo(...at(a, r * 1.08)); g.lineTo(...at(a + 0.07, r * 1.4)); } });
      stroke(g, ink.text, 2.5, [], () => { g.moveTo(...at(from, r * 1.04)); g.lineTo(...at(from, r * 1.44)); });
    }
    // A torque profile is drawn as its potential energy around the knob: low where the knob rests.
    const { profile } = run;
    if (profile && row) {
      stroke(g, ink.force, 2, [], () => {
        for (let i = 0; i <= 720; i += 1) {
          const a = row.angle_rad + ((i - 360) * Math.PI) / 360, d = r * (1.05 + 0.16 * heightAt(profile, a));
          if (i) g.lineTo(...at(a, d)); else g.moveTo(...at(a, d));
        }
      });
    }
    if (run.parts && row) this.parts(g, run.parts, row.angle_rad, at, { x, y, r });
    g.fillStyle = ink.panel;
    g.beginPath();
    g.arc(x, y, r, 0, 7);
    g.fill();
    stroke(g, ink.muted, 2, [], () => g.arc(x, y, r, 0, 7));
    if (!row) return;
    if (run.parts) this.inside(g, run.parts, row.angle_rad, at, { x, y, r });
    stroke(g, ink.line, 2, [], () => { for (let i = 0; i < 24; i += 1) { const a = row.angle_rad + (i * Math.PI) / 12; g.moveTo(...at(a, r * 0.9)); g.lineTo(...at(a, r * 0.98)); } });
    // Draws the wall's surface as the control law uses it, moved outwards by the law's offset.
    if (run.facts.has_wall !== 0 && row.surface_shifted_rad < surface - 1e-4) {
      const moved = Math.max(row.surface_shifted_rad, surface - 2.5);
      stroke(g, ink.shift, 2.5, [4, 3], () => { g.moveTo(...at(moved, r * 1.04)); g.lineTo(...at(moved, r * 1.36)); });
    }
    // Draws the rest point of the hand on a ring around the knob, and the hand's spring, which pulls the knob to the rest point.
    if (run.facts.reach_rad_per_n_m > 0 && hand !== null) {
      const aim = run.facts.has_wall === 0 ? Math.max(row.angle_rad - 2.8, Math.min(hand, row.angle_rad + 2.8)) : Math.max(-2.8, Math.min(hand, surface + 2.2));
      stroke(g, ink.hand, 2, [2, 4], () => g.arc(x, y, r * 1.2, turn(Math.min(aim, row.angle_rad)), turn(Math.max(aim, row.angle_rad))));
      g.fillStyle = ink.hand;
      g.beginPath();
      g.arc(...at(aim, r * 1.2), 7, 0, 7);
      g.fill();
    }
    // The force is drawn as an arc from the knob's mark in the direction in which the motor pushes.
    const push = Math.min(1.4, Math.abs(row.motor_force_n_m) * 4) * Math.sign(row.motor_force_n_m);
    if (Math.abs(push) > 0.01) {
      const from = row.angle_rad, to = from - push;
      stroke(g, ink.force, 5, [], () => g.arc(x, y, r * 0.62, turn(Math.min(from, to)), turn(Math.max(from, to))));
      const [hx, hy] = at(to, r * 0.62), along = turn(to) - (Math.PI / 2) * Math.sign(push);
      g.fillStyle = ink.force;
      g.beginPath();
      for (const [d, w] of [[11, 0], [0, 7], [0, -7]]) g.lineTo(hx + d * Math.cos(along) - w * Math.sin(along), hy + d * Math.sin(along) + w * Math.cos(along));
      g.fill();
    }
    stroke(g, colour, 6, [], () => { g.moveTo(...at(row.angle_rad, r * 0.35)); g.lineTo(...at(row.angle_rad, r * 0.97)); });
    g.fillStyle = colour;
    g.beginPath();
    g.arc(x, y, r * 0.12, 0, 7);
    g.fill();
  }
  /** The parts of a feel around the knob: detents as lines, clicks as triangles, friction as two brake pads. Too many marks are drawn as a ring. */
  parts(g, { detents, clicks, friction }, angle, at, { x, y, r }) {
    const around = (ring) => marksOf(ring, angle - Math.PI, angle + Math.PI, MOST_MARKS);
    if (detents) {
      const list = around(detents);
      if (list) stroke(g, ink.muted, 2, [], () => { for (const a of list) { g.moveTo(...at(a, r * 1.03)); g.lineTo(...at(a, r * 1.12)); } });
      else stroke(g, ink.muted, r * 0.06, [1, 2], () => g.arc(x, y, r * 1.07, 0, 7));
    }
    if (clicks) {
      const list = around(clicks);
      g.fillStyle = ink.mass;
      g.beginPath();
      for (const a of list ?? []) { const w = Math.min(0.03, clicks.pitch / 3); g.moveTo(...at(a, r * 1.14)); g.lineTo(...at(a - w, r * 1.22)); g.lineTo(...at(a + w, r * 1.22)); }
      g.fill();
      if (!list) stroke(g, ink.mass, r * 0.05, [1, 3], () => g.arc(x, y, r * 1.18, 0, 7));
    }
    if (friction) for (const from of [0.45, 2.4]) stroke(g, ink.hand, r * 0.1, [], () => g.arc(x, y, r * 1.07, from, from + 0.3));
  }
  /** The parts of a feel on the knob: the spring from its centre to the knob as a coil, the damper as a ring of oil, the added inertia as a heavy rim. */
  inside(g, { spring, damper, inertia }, angle, at, { x, y, r }) {
    if (damper) stroke(g, ink.a, r * 0.05, [2, 6], () => g.arc(x, y, r * 0.46, 0, 7));
    if (inertia) stroke(g, ink.mass, r * 0.07, [], () => g.arc(x, y, r * 0.55, 0, 7));
    if (!spring) return;
    // Beyond nearly half a turn the coil would begin to lie on itself.
    const way = Math.max(-2.9, Math.min(2.9, spring.centre - angle)), coils = 24;
    stroke(g, ink.shift, 2, [], () => { for (let i = 0; i <= coils; i += 1) g.lineTo(...at(angle + (way * i) / coils, r * (0.8 + (i % 2 ? 0.04 : -0.04) * (i > 0 && i < coils)))); });
    stroke(g, ink.shift, 3, [], () => { g.moveTo(...at(angle + way, r * 0.7)); g.lineTo(...at(angle + way, r * 1.1)); });
  }
}

/** The lens: what happens at the wall's surface, enlarged. To the right is into the wall. */
class Lens {
  constructor() { this.bins = new Bins(); }
  draw(g, box, run, colour, half, titled) {
    const { facts, last: row } = run;
    const surface = middle(run), h = box.h;
    const X = (angle) => box.x + box.w * (0.5 + (angle - surface) / (2 * half)), top = box.y + 18, line = box.y + h * 0.3, strip = box.y + h * 0.56, low = box.y + h - 20;
    g.save();
    g.beginPath();
    g.rect(box.x, box.y, box.w, h);
    g.clip();
    for (const [from, way] of walls(facts)) {
      const edge = Math.max(box.x, Math.min(box.x + box.w, X(from))), end = way > 0 ? box.x + box.w : box.x, left = Math.min(edge, end);
      if (edge === end) continue;
      g.save();
      g.beginPath();
      g.rect(left, top, Math.abs(end - edge), low - top);
      g.clip();
      g.fillStyle = ink.wall;
      g.fillRect(left, top, Math.abs(end - edge), low - top);
      stroke(g, ink.hatch, 0.7, [], () => { for (let at = left - h; at < left + Math.abs(end - edge); at += 12) { g.moveTo(at, low); g.lineTo(at + low - top, top); } });
      g.restore();
      stroke(g, ink.text, 2.5, [], () => { g.moveTo(edge, top); g.lineTo(edge, low); });
    }
    if (run.profile) {
      stroke(g, ink.force, 2, [], () => {
        for (let x = 0; x <= box.w; x += 2) {
          const a = surface + (2 * half * x) / box.w - half, y = line + 14 + (strip - line - 24) * (1 - heightAt(run.profile, a));
          if (x) g.lineTo(box.x + x, y); else g.moveTo(box.x + x, y);
        }
      });
    }
    if (run.parts) this.felt(g, run.parts, { box, surface, half, X, top, line, strip, low });
    g.fillStyle = ink.muted;
    g.textBaseline = "bottom";
    g.textAlign = "center";
    for (const v of marks(-half, half, 5)) {
      const at = box.x + box.w * (0.5 + v / (2 * half));
      stroke(g, ink.muted, 1, [], () => { g.moveTo(at, low); g.lineTo(at, low + 4); });
      if (Math.abs(v) < 0.78 * half) g.fillText(number(v * 1e3), at, low + 18);
    }
    g.textAlign = "right";
    g.fillText("mrad", box.x + box.w - 2, low + 18);
    if (titled) {
      g.textAlign = "left";
      g.textBaseline = "top";
      g.fillText(facts.has_wall === 0 ? "around the knob, enlarged" : "the surface, enlarged: wall to the right", box.x + 4, box.y + 1);
    }
    if (row) {
      this.strip(g, run, X, strip, low, colour);
      this.parts(g, box, run, row, X, top, line, strip, colour);
    }
    g.restore();
  }
  /** The parts of a feel in the lens: each detent as a line and each click as a triangle, as long as they can be told apart; the spring's centre. */
  felt(g, { detents, clicks, spring }, { box, surface, half, X, top, line, strip, low }) {
    const seen = (ring) => (ring ? marksOf(ring, surface - half, surface + half, box.w / 6) ?? [] : []);
    stroke(g, ink.muted, 1, [2, 3], () => { for (const a of seen(detents)) { g.moveTo(X(a), top); g.lineTo(X(a), low); } });
    g.fillStyle = ink.mass;
    g.beginPath();
    for (const a of seen(clicks)) { g.moveTo(X(a), line + 12); g.lineTo(X(a) - 4, line + 22); g.lineTo(X(a) + 4, line + 22); }
    g.fill();
    if (!spring) return;
    const at = X(spring.centre), x = Math.max(box.x + 4, Math.min(box.x + box.w - 4, at)), beyond = Math.sign(at - x);
    if (!beyond) stroke(g, ink.shift, 2, [6, 3], () => { g.moveTo(x, top); g.lineTo(x, strip); });
    g.fillStyle = ink.shift;
    g.textBaseline = "top";
    g.textAlign = beyond > 0 || x > box.x + box.w * 0.8 ? "right" : "left";
    g.fillText(beyond < 0 ? "◂ centre of the spring" : beyond > 0 ? "centre of the spring ▸" : "centre of the spring", x + (g.textAlign === "left" ? 4 : -4), top + 2);
  }
  /** The last 0.6 s, the newest at the top: a limit cycle is a zigzag. Each row of pixels spans the lowest to the highest value, so that no tick is lost. */
  strip(g, { ring, facts }, X, top, low, colour) {
    const rows = Math.max(2, Math.floor((low - top) / STRIP_ROW)), now = ring.at("clock", 0), { clock } = ring.columns;
    g.lineJoin = "bevel";
    for (const [name, paint, wide, dash] of [["surface_shifted_rad", ink.shift, 1.4, 4], ["mass_rad", ink.mass, 1.4, 2], ["angle_rad", colour, 2, 0]]) {
      if (facts.has_wall === 0 && name !== "angle_rad") continue;
      const values = ring.columns[name];
      const { least, most } = this.bins.clear(rows);
      ring.since(STRIP_S, (i) => {
        const row = Math.floor((1 - (now - clock[i]) / STRIP_S) * (rows - 1));
        if (row < 0) return;
        if (values[i] < least[row]) least[row] = values[i];
        if (values[i] > most[row]) most[row] = values[i];
      });
      stroke(g, paint, wide, [], () => {
        let pen = false, at = 0;
        for (let row = 0; row < rows; row += 1) {
          // A dash is a group of rows that are drawn, followed by rows that are not. The canvas' own dashes take too long on a zigzag.
          if (least[row] === Infinity || (dash && row % (2 * dash) >= dash)) { pen = pen && least[row] === Infinity; continue; }
          const y = top + ((rows - 1 - row) / (rows - 1)) * (low - top), a = X(least[row]), b = X(most[row]);
          // Begins each row at the end that is nearer to the pen.
          const [first, second] = pen && Math.abs(at - b) < Math.abs(at - a) ? [b, a] : [a, b];
          if (pen) g.lineTo(first, y); else g.moveTo(first, y);
          if (second !== first) g.lineTo(second, y);
          at = second;
          pen = true;
        }
      });
    }
    g.lineJoin = "round";
  }
  parts(g, box, run, row, X, top, line, strip, colour) {
    const x = X(row.angle_rad), left = box.x + 4, right = box.x + box.w - 4;
    const shown = Math.max(left, Math.min(right, x));
    // Draws the wall's surface as the control law uses it, moved by the law's offset.
    const shifted = X(row.surface_shifted_rad);
    if (run.facts.has_wall !== 0 && row.surface_shifted_rad < run.facts.surface_rad - 1e-7) {
      const at = Math.max(left, shifted);
      stroke(g, ink.shift, 2.5, [5, 4], () => { g.moveTo(at, top); g.lineTo(at, strip); });
      g.fillStyle = ink.shift;
      g.textAlign = "left";
      g.textBaseline = "bottom";
      g.fillText(shifted < left ? "◂ offset surface" : "offset surface", at + 4, strip - 2);
    }
    // Marks the position at which a real wall of the desired stiffness would hold the knob against the present force.
    if (run.facts.has_wall !== 0 && row.force_n_m > 1e-4) {
      const ideal = X(run.facts.surface_rad + row.force_n_m / run.facts.k_desired_n_m_per_rad);
      stroke(g, ink.muted, 1.6, [], () => { g.moveTo(ideal, line - 16); g.lineTo(ideal - 6, line - 24); g.lineTo(ideal + 6, line - 24); g.closePath(); });
    }
    // Draws the virtual mass that the enhanced control law simulates, and the spring between this mass and the knob.
    if (Math.abs(row.mass_rad - row.angle_rad) > 1e-6) {
      const m = Math.max(left, Math.min(right, X(row.mass_rad))), y = line + 24;
      stroke(g, ink.mass, 1.4, [], () => { for (let i = 0; i <= 8; i += 1) g.lineTo(m + ((shown - m) * i) / 8, y + (i % 2 ? 4 : -4) * (i > 0 && i < 8)); });
      g.fillStyle = ink.mass;
      g.fillRect(m - 6, y - 6, 12, 12);
    }
    // Draws the motor's force as an arrow.
    const long = Math.min(box.w * 0.45, (Math.abs(row.motor_force_n_m) / 0.3) * box.w * 0.4);
    if (long > 1) {
      const to = shown - long * Math.sign(row.motor_force_n_m), back = Math.sign(shown - to) * Math.min(9, long);
      stroke(g, ink.force, 4, [], () => { g.moveTo(shown, line); g.lineTo(to + back * 0.7, line); });
      g.fillStyle = ink.force;
      g.beginPath();
      g.moveTo(to, line);
      g.lineTo(to + back, line - 7);
      g.lineTo(to + back, line + 7);
      g.fill();
    }
    stroke(g, colour, 1.2, [], () => { g.moveTo(shown, line - 12); g.lineTo(shown, strip); });
    g.fillStyle = colour;
    g.beginPath();
    g.arc(shown, line, 8, 0, 7);
    g.fill();
  }
}
