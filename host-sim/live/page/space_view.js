// Draws three axes as an orthographic view that the user can turn; lengths in mm.

/** Direction of the view: unit vectors to the right, upwards and away from the viewer. */
class Camera {
  constructor() { this.yaw = 0.5; this.pitch = 0.45; this.span = 110; }
  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.max(-1.5, Math.min(1.5, this.pitch + pitch));
  }
  get right() { return [Math.cos(this.yaw), Math.sin(this.yaw), 0]; }
  get up() { return [-Math.sin(this.yaw) * Math.sin(this.pitch), Math.cos(this.yaw) * Math.sin(this.pitch), Math.cos(this.pitch)]; }
  get away() { return [-Math.sin(this.yaw) * Math.cos(this.pitch), Math.cos(this.yaw) * Math.cos(this.pitch), -Math.sin(this.pitch)]; }
  /** Pixels per millimetre. */
  scale(width, height) { return Math.min(width, height) / this.span; }
}
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const PATH_S = 2, NEWTON_MM = 3;

/** Draws the virtual object, the hand, and the force between them. */
class SpaceView {
  constructor(canvas) {
    this.canvas = canvas;
    this.camera = new Camera();
    this.still = document.createElement("canvas");
    this.drawn = "";
  }
  draw(run, aim) {
    const { g, width, height } = sheet(this.canvas), { camera } = this, { right, up } = camera, s = camera.scale(width, height);
    const at = (p) => [width / 2 + s * dot(p, right), height / 2 - s * dot(p, up)];
    this.object(g, run.facts, at, s, width, height);
    const row = run.last;
    if (!row) return;
    const place = (name, r = row) => ["x", "y", "z"].map((axis) => r[`${name}_${axis}_mm`]);
    const hip = place("hip"), surface = place("surface"), touching = row.depth_mm > 0, hidden = this.behind(hip, run.facts);
    // Path of the last seconds, drawn with at most one point per pixel.
    const { columns } = run.ring;
    let last = [-9, -9];
    stroke(g, ink.a, 1.6, [], () => run.ring.since(PATH_S, (i) => {
      const p = at([columns.hip_x_mm[i], columns.hip_y_mm[i], columns.hip_z_mm[i]]);
      if (last[0] === -9) g.moveTo(...p); else if (Math.hypot(p[0] - last[0], p[1] - last[1]) >= 1) g.lineTo(...p); else return;
      last = p;
    }));
    const meant = aim ?? place("rest");
    stroke(g, ink.hand, 1.6, [2, 4], () => { g.moveTo(...at(hip)); g.lineTo(...at(meant)); });
    this.ball(g, at(meant), 6, ink.hand, false);
    if (row.depth_mm > -15) {
      stroke(g, ink.shift, 2, touching ? [] : [3, 3], () => { g.moveTo(...at(hip)); g.lineTo(...at(surface)); });
    }
    if (row.force_n > 0.02) this.arrow(g, at(hip), at(hip.map((x, i) => x + NEWTON_MM * row[`force_${"xyz"[i]}_n`])));
    this.ball(g, at(hip), 8, ink.a, hidden);
    if (row.depth_mm > -15) this.diamond(g, at(surface));
  }
  diamond(g, [x, y]) {
    g.fillStyle = ink.shift;
    g.strokeStyle = ink.panel;
    g.lineWidth = 1.5;
    g.beginPath();
    for (const [dx, dy] of [[0, -6], [6, 0], [0, 6], [-6, 0]]) g.lineTo(x + dx, y + dy);
    g.closePath();
    g.stroke();
    g.fill();
  }
  ball(g, [x, y], r, colour, hollow) {
    g.beginPath();
    g.arc(x, y, r, 0, 7);
    if (hollow) { g.strokeStyle = colour; g.lineWidth = 2.5; g.stroke(); } else { g.fillStyle = colour; g.fill(); }
  }
  arrow(g, from, to) {
    const long = Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (long < 3) return;
    const [ux, uy] = [(to[0] - from[0]) / long, (to[1] - from[1]) / long], head = Math.min(11, long);
    stroke(g, ink.force, 4, [], () => { g.moveTo(...from); g.lineTo(to[0] - ux * head * 0.7, to[1] - uy * head * 0.7); });
    g.fillStyle = ink.force;
    g.beginPath();
    for (const [d, w] of [[0, 0], [-head, 6], [-head, -6]]) g.lineTo(to[0] + d * ux - w * uy, to[1] + d * uy + w * ux);
    g.fill();
  }
  /** Whether the virtual object hides a point from the viewer. */
  behind(p, { radius_mm, normal }) {
    const { away, right, up } = this.camera;
    if (radius_mm) return dot(p, away) > 0 && Math.hypot(dot(p, right), dot(p, up)) < radius_mm;
    return dot(normal, away) > 0;
  }
  /** Draws the virtual object. The object does not move, so its picture is kept until the view changes. */
  object(g, facts, at, s, width, height) {
    const { camera } = this, ratio = window.devicePixelRatio || 1;
    const drawn = JSON.stringify([camera.yaw, camera.pitch, camera.span, facts.radius_mm, facts.normal, width, height, ratio, ink.panel]);
    if (drawn !== this.drawn) {
      this.drawn = drawn;
      this.still.width = Math.round(width * ratio);
      this.still.height = Math.round(height * ratio);
      const still = this.still.getContext("2d");
      still.setTransform(ratio, 0, 0, ratio, 0, 0);
      still.fillStyle = ink.panel;
      still.fillRect(0, 0, width, height);
      still.font = "12px system-ui, sans-serif";
      if (facts.radius_mm) this.sphere(still, facts.radius_mm, at, s); else this.plane(still, facts.normal, at);
      this.axes(still, height);
    }
    g.drawImage(this.still, 0, 0, width, height);
  }
  sphere(g, radius, at, s) {
    const [x, y] = at([0, 0, 0]), { away } = this.camera;
    g.fillStyle = ink.wall;
    g.beginPath();
    g.arc(x, y, radius * s, 0, 7);
    g.fill();
    const line = (of) => {
      for (const front of [false, true]) stroke(g, ink.hatch, front ? 1.4 : 0.5, front ? [] : [2, 4], () => {
        let pen = false;
        for (let i = 0; i <= 72; i += 1) {
          const p = of((i * Math.PI) / 36);
          if (dot(p, away) <= 0 !== front) { pen = false; continue; }
          if (pen) g.lineTo(...at(p)); else g.moveTo(...at(p));
          pen = true;
        }
      });
    };
    for (let k = -2; k <= 2; k += 1) { const z = Math.sin((k * Math.PI) / 6), r = Math.cos((k * Math.PI) / 6); line((a) => [radius * r * Math.cos(a), radius * r * Math.sin(a), radius * z]); }
    for (let k = 0; k < 6; k += 1) { const c = Math.cos((k * Math.PI) / 6), d = Math.sin((k * Math.PI) / 6); line((a) => [radius * Math.cos(a) * c, radius * Math.cos(a) * d, radius * Math.sin(a)]); }
    stroke(g, ink.text, 1.5, [], () => g.arc(x, y, radius * s, 0, 7));
  }
  plane(g, normal, at) {
    const [a, b] = along(normal), p = (u, v) => at(a.map((n, i) => u * n + v * b[i]));
    g.fillStyle = ink.wall;
    g.beginPath();
    for (const [u, v] of [[-50, -50], [50, -50], [50, 50], [-50, 50]]) g.lineTo(...p(u, v));
    g.fill();
    stroke(g, ink.hatch, 1, [], () => { for (let k = -50; k <= 50; k += 10) { g.moveTo(...p(k, -50)); g.lineTo(...p(k, 50)); g.moveTo(...p(-50, k)); g.lineTo(...p(50, k)); } });
  }
  axes(g, height) {
    const { right, up } = this.camera;
    ["x", "y", "z"].forEach((name, i) => {
      const [dx, dy] = [26 * right[i], -26 * up[i]];
      stroke(g, ink.muted, 1.5, [], () => { g.moveTo(40, height - 40); g.lineTo(40 + dx, height - 40 + dy); });
      g.fillStyle = ink.muted;
      g.textAlign = "center";
      g.textBaseline = "middle";
      g.fillText(name, 40 + 1.4 * dx, height - 40 + 1.4 * dy);
    });
  }
}
