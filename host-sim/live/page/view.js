// Drawing tools: canvases, ring buffers, scrolling plots, and the plot of force over position. Lines differ in dash as well as in
// colour.
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
let ink = {};
function readInk() {
  for (const name of ["page", "panel", "text", "muted", "line", "a", "b", "wall", "hatch", "shift", "mass", "hand", "force"]) ink[name] = css(name);
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", readInk);

/** Prepares a canvas for drawing in CSS pixels at the screen's resolution. */
function sheet(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  // An opaque canvas is faster, because nothing below it is mixed in.
  const g = canvas.getContext("2d", { alpha: false });
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.fillStyle = ink.panel;
  g.fillRect(0, 0, width, height);
  g.font = "12px system-ui, sans-serif";
  g.lineJoin = "round";
  return { g, width, height };
}

function stroke(g, colour, width, dash, path) {
  g.strokeStyle = colour;
  g.lineWidth = width;
  g.setLineDash(dash);
  g.beginPath();
  path();
  g.stroke();
  g.setLineDash([]);
}

/** Lowest and highest value for each column or row of pixels; the arrays are reused. */
class Bins {
  constructor() { this.least = this.most = new Float64Array(0); this.broken = new Uint8Array(0); }
  clear(n) {
    if (this.least.length !== n) Object.assign(this, { least: new Float64Array(n), most: new Float64Array(n), broken: new Uint8Array(n) });
    this.least.fill(Infinity);
    this.most.fill(-Infinity);
    this.broken.fill(0);
    return this;
  }
}

/** Ring buffer of a run's last rows, with one array for each column. */
class Ring {
  constructor(names, length) {
    this.names = names;
    this.length = length;
    this.columns = Object.fromEntries(names.map((name) => [name, new Float64Array(length)]));
    this.end = 0;
  }
  push(rows) {
    const n = this.names.length;
    for (let at = 0; at < rows.length; at += n) {
      const to = this.end % this.length;
      for (let c = 0; c < n; c += 1) this.columns[this.names[c]][to] = rows[at + c];
      this.end += 1;
    }
  }
  get size() { return Math.min(this.end, this.length); }
  at(name, back) { return this.columns[name][(this.end - 1 - back) % this.length]; }
  /** Calls a function for every row of the last `seconds`, the oldest first. */
  since(seconds, act) {
    if (!this.size) return;
    const from = this.at("clock", 0) - seconds;
    let near = 0, far = this.size;
    while (far - near > 1) {
      const middle = (near + far) >> 1;
      if (this.at("clock", middle) > from) near = middle; else far = middle;
    }
    for (let i = (this.end - 1 - near) % this.length, left = near + 1; left > 0; left -= 1) {
      act(i);
      i = i + 1 === this.length ? 0 : i + 1;
    }
  }
}

/** The next round number at or above a value: 1, 2, 5 or 10 times a power of ten. */
function round(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= value * 0.999999);
}

/** Values at which an axis has a tick mark. */
function marks(low, high, wanted) {
  const step = round((high - low) / wanted), out = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) out.push(i * step);
  return out;
}

const number = (x) => (x === 0 ? "0" : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-4 ? x.toExponential(1) : String(Number(x.toPrecision(4))));

/** Range of an axis: it grows at once with the values shown, and shrinks slowly. */
class Range {
  constructor(least) { this.low = -least * 0.1; this.high = least; this.least = least; }
  follow(low, high) {
    if (!(low <= high)) return;
    const pad = 0.06 * Math.max(high - low, this.least);
    low = Math.min(low - pad, -0.1 * this.least); high = Math.max(high + pad, this.least);
    this.low = low < this.low ? low : this.low + 0.08 * (low - this.low);
    this.high = high > this.high ? high : this.high + 0.08 * (high - this.high);
  }
}

function axes(g, box, x, y, xName, yName) {
  g.fillStyle = ink.muted;
  g.textBaseline = "middle";
  for (const v of marks(y.low, y.high, 4)) {
    const at = box.y + box.h * (1 - (v - y.low) / (y.high - y.low));
    stroke(g, ink.line, 1, [], () => { g.moveTo(box.x, at); g.lineTo(box.x + box.w, at); });
    g.textAlign = "right";
    g.fillText(number(v), box.x - 4, at);
  }
  g.textBaseline = "top";
  g.textAlign = "center";
  for (const v of marks(x.low, x.high, 5)) {
    const at = box.x + (box.w * (v - x.low)) / (x.high - x.low);
    g.fillText(number(v), at, box.y + box.h + 4);
  }
  g.textAlign = "left";
  g.fillText(yName, 2, 0);
  g.textAlign = "right";
  g.fillText(xName, box.x + box.w, box.y + box.h + 17);
}

const BOX = (width, height) => ({ x: 46, y: 16, w: width - 54, h: height - 46 });

/** A scrolling plot over time. `series`: {name, colour, dash, wide, of(columns, i, run)}. */
class Plot {
  constructor(canvas, unit, least, series) {
    Object.assign(this, { canvas, unit, series, range: new Range(least), rooms: [] });
  }
  draw(runs, seconds, level) {
    const { g, width, height } = sheet(this.canvas);
    const box = BOX(width, height), x = { low: -seconds, high: 0 }, y = this.range;
    const lines = [];
    let low = Infinity, high = -Infinity;
    for (const run of runs) {
      if (!run.ring.size) continue;
      const now = runs[0].ring.at("clock", 0), columns = run.ring.columns;
      for (const line of this.series) {
        if (run.second && line.first) continue;
        // Draws the lowest to the highest value in each column of pixels, so that no peak is lost at any rate.
        const n = Math.max(1, Math.floor(box.w)), { least, most, broken } = (this.rooms[lines.length] ??= new Bins()).clear(n);
        run.ring.since(seconds, (i) => {
          const value = line.of(columns, i, run);
          const at = Math.floor((1 + (columns.clock[i] - now) / seconds) * (n - 1));
          if (at >= 0 && at < n && columns.missing && (columns.missing[i] > 0 || !Number.isFinite(value))) broken[at] = 1;
          if (!(at >= 0 && at < n) || !Number.isFinite(value)) return;
          if (value < least[at]) least[at] = value;
          if (value > most[at]) most[at] = value;
          if (value < low) low = value;
          if (value > high) high = value;
        });
        lines.push({ line, run, least, most, n, broken });
      }
    }
    if (level !== undefined) high = Math.max(high, level * 1.1);
    y.follow(low, this.cap === undefined ? high : Math.min(high, this.cap));
    axes(g, box, x, y, "s", this.unit);
    g.save();
    g.beginPath();
    g.rect(box.x, box.y - 1, box.w, box.h + 2);
    g.clip();
    const yAt = (v) => box.y + box.h * (1 - (v - y.low) / (y.high - y.low));
    for (const run of runs) this.holes(g, box, run, seconds);
    if (level !== undefined) stroke(g, ink.muted, 1.5, [6, 4], () => { g.moveTo(box.x, yAt(level)); g.lineTo(box.x + box.w, yAt(level)); });
    for (const { line, run, least, most, n, broken } of lines) {
      stroke(g, run.second ? ink.b : ink[line.colour], line.wide ?? 1.6, run.second ? [5, 3] : line.dash ?? [], () => {
        let pen = false, gap = 0;
        for (let i = 0; i < n; i += 1) {
          if (least[i] === Infinity) { gap += 1; if (gap > Math.max(3, n / 100)) pen = false; continue; }
          gap = 0;
          const px = box.x + i;
          // No line is drawn across missing records.
          if (broken[i]) pen = false;
          if (pen) g.lineTo(px, yAt(least[i])); else g.moveTo(px, yAt(least[i]));
          if (most[i] !== least[i]) g.lineTo(px, yAt(most[i]));
          pen = true;
        }
      });
    }
    g.restore();
  }
  /** Draws a band over the time in which a board's records are missing: from the last record before the gap to the first after it. */
  holes(g, box, run, seconds) {
    const { clock, missing } = run.ring.columns;
    if (!missing || !run.ring.size) return;
    const now = run.ring.at("clock", 0), X = (t) => box.x + box.w * (1 + (t - now) / seconds);
    let before = null;
    g.fillStyle = ink.hatch;
    run.ring.since(seconds, (i) => {
      if (missing[i] > 0 && before !== null) g.fillRect(X(before), box.y, Math.max(1, X(clock[i]) - X(before)), box.h);
      before = clock[i];
    });
  }
}

/** Plots two quantities against each other over the last seconds. */
class Plane {
  constructor(canvas, xName, yName, xLeast, yLeast, of) {
    Object.assign(this, { canvas, xName, yName, of, x: new Range(xLeast), y: new Range(yLeast) });
  }
  draw(runs, seconds, slopes) {
    const { g, width, height } = sheet(this.canvas), box = BOX(width, height);
    let [xl, xh, yl, yh] = [Infinity, -Infinity, Infinity, -Infinity];
    const paths = runs.map((run) => {
      const points = [];
      run.ring.since(seconds, (i) => {
        const [px, py] = this.of(run.ring.columns, i, run);
        points.push(px, py);
        xl = Math.min(xl, px); xh = Math.max(xh, px); yl = Math.min(yl, py); yh = Math.max(yh, py);
      });
      return { run, points };
    });
    this.x.follow(xl, xh);
    this.y.follow(yl, yh);
    const { x, y } = this;
    axes(g, box, x, y, this.xName, this.yName);
    const X = (v) => box.x + (box.w * (v - x.low)) / (x.high - x.low), Y = (v) => box.y + box.h * (1 - (v - y.low) / (y.high - y.low));
    g.save();
    g.beginPath();
    g.rect(box.x, box.y, box.w, box.h);
    g.clip();
    stroke(g, ink.line, 1.5, [], () => { g.moveTo(X(0), box.y); g.lineTo(X(0), box.y + box.h); g.moveTo(box.x, Y(0)); g.lineTo(box.x + box.w, Y(0)); });
    for (const { slope, dash } of slopes) stroke(g, ink.muted, 1.3, dash, () => { g.moveTo(X(0), Y(0)); g.lineTo(X(x.high), Y(slope * x.high)); });
    for (const { run, points } of paths) {
      if (!points.length) continue;
      const colour = run.second ? ink.b : ink.a;
      stroke(g, colour, 1.3, run.second ? [5, 3] : [], () => { for (let i = 0; i < points.length; i += 2) g.lineTo(X(points[i]), Y(points[i + 1])); });
      g.fillStyle = colour;
      g.beginPath();
      g.arc(X(points.at(-2)), Y(points.at(-1)), 4, 0, 7);
      g.fill();
    }
    g.restore();
  }
}

/** Makes a figure with its title and a key for each line; returns its canvas. */
function figureFor(title, keys, tall) {
  const figure = document.createElement("figure"), caption = document.createElement("figcaption"), canvas = document.createElement("canvas");
  const name = document.createElement("strong");
  name.textContent = title;
  caption.append(name);
  for (const [text, colour, dash] of keys) {
    const key = document.createElement("span");
    key.className = "key";
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg"), mark = document.createElementNS("http://www.w3.org/2000/svg", "line");
    svg.setAttribute("viewBox", "0 0 26 8");
    svg.setAttribute("aria-hidden", "true");
    for (const [attribute, value] of [["x1", 0], ["x2", 26], ["y1", 4], ["y2", 4], ["stroke-width", 2.5], ["stroke-dasharray", dash.join(" ")]]) mark.setAttribute(attribute, value);
    mark.style.stroke = `var(--${colour})`;
    svg.append(mark);
    key.append(svg, text);
    caption.append(key);
  }
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `${title}, scrolling`);
  if (tall) figure.className = "tall";
  figure.append(caption, canvas);
  $("plots").append(figure);
  return canvas;
}
