// Numbers under the pointer, enlarging by dragging, and two runs over each other. All but the last only reads the drawn
// lines back; the page is complete without it.
"use strict";
(() => {
  // A link into something folded unfolds it.
  const unfold = () => {
    const goal = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!goal) return;
    for (let e = goal; e; e = e.parentElement) if (e.tagName === "DETAILS") e.open = true;
    goal.scrollIntoView();
  };
  addEventListener("hashchange", unfold);
  addEventListener("load", unfold);
  document.addEventListener("click", (event) => {
    const link = event.target.closest?.("a[href^='#']");
    if (link && link.hash === location.hash) unfold();
  });
  const lines = new WeakMap();
  // The lines of a plot as lists of points in the fine steps of the drawing; see svg.rs for how they are written.
  const decode = (plot) => {
    if (!lines.has(plot)) {
      lines.set(plot, [...plot.querySelectorAll("path[data-n]")].map((path) => ({
        name: path.dataset.n,
        parts: path.getAttribute("d").split("M").slice(1).map((part) => {
          const n = part.match(/-?\d+/g).map(Number);
          const points = [[n[0], n[1]]];
          for (let i = 2; i + 1 < n.length; i += 2) {
            const [x, y] = points[points.length - 1];
            points.push([x + n[i], y + n[i + 1]]);
          }
          return points;
        }),
      })));
    }
    return lines.get(plot);
  };
  const axis = (text) => {
    const [min, max, ...unit] = text.split(" ");
    return { min: +min, max: +max, unit: unit.join(" ") };
  };
  const show = (value, a) => {
    const step = (a.max - a.min) / 500;
    if (Math.abs(value) < step / 2) value = 0;
    return value.toFixed(Math.max(0, Math.min(6, -Math.floor(Math.log10(step))))).replace("-", "\u2212") + " " + a.unit;
  };
  // The height of a line at x, between its drawn points.
  const at = (parts, x) => {
    for (const p of parts) {
      if (x < p[0][0] || x > p[p.length - 1][0]) continue;
      let low = 0, high = p.length - 1;
      while (high - low > 1) { const mid = (low + high) >> 1; if (p[mid][0] <= x) low = mid; else high = mid; }
      const width = p[high][0] - p[low][0];
      return width ? p[low][1] + (p[high][1] - p[low][1]) * (x - p[low][0]) / width : p[low][1];
    }
    return null;
  };
  let box = null, cursor = null, drag = null;
  const clear = () => { box?.remove(); cursor?.remove(); box = cursor = null; };
  document.addEventListener("pointermove", (event) => {
    const plot = event.target.closest?.("svg.plot");
    // Axes of names have no numbers to read.
    if (!plot || plot.closest(".picture") || drag) return clear();
    // The browser's own tooltip would cover the read-out; assistive technology keeps the name.
    const title = plot.querySelector("title");
    if (title) { plot.setAttribute("aria-label", title.textContent); plot.removeAttribute("aria-labelledby"); title.remove(); }
    const area = plot.querySelector("svg.lines");
    const view = area.viewBox.baseVal, whole = plot.viewBox.baseVal, rect = plot.getBoundingClientRect();
    const scale = whole.width / rect.width;
    const fx = ((event.clientX - rect.left) * scale - area.x.baseVal.value) / area.width.baseVal.value;
    const fy = ((event.clientY - rect.top) * scale - area.y.baseVal.value) / area.height.baseVal.value;
    clear();
    if (fx < 0 || fx > 1 || fy < 0 || fy > 1) return;
    const x = axis(plot.dataset.x), y = axis(plot.dataset.y);
    const rows = [];
    const up = (fine) => y.max - (fine - view.y) / view.height * (y.max - y.min);
    if (x.unit.endsWith("s")) {
      rows.push("t = " + show(x.min + fx * (x.max - x.min), x));
      for (const line of decode(plot)) {
        const fine = at(line.parts, view.x + fx * view.width);
        if (fine !== null && line.name) rows.push(line.name + ": " + show(up(fine), y));
      }
    } else {
      rows.push("x = " + show(x.min + fx * (x.max - x.min), x), "f = " + show(y.max - fy * (y.max - y.min), y));
    }
    cursor = plot.querySelector("path.grid").cloneNode(false);
    cursor.setAttribute("class", "cursor");
    cursor.setAttribute("d", `M${view.x + fx * view.width} ${view.y}v${view.height}` + (x.unit.endsWith("s") ? "" : `M${view.x} ${view.y + fy * view.height}h${view.width}`));
    area.append(cursor);
    const figure = plot.closest("figure");
    const outer = figure.getBoundingClientRect();
    box = document.createElement("div");
    box.className = "readout";
    box.append(...rows.flatMap((row, i) => (i ? [document.createElement("br"), row] : [row])));
    figure.append(box);
    const left = event.clientX - outer.left + 14;
    box.style.left = Math.max(0, left + box.offsetWidth > outer.width ? left - box.offsetWidth - 28 : left) + "px";
    box.style.top = Math.max(0, event.clientY - outer.top - box.offsetHeight - 8) + "px";
  });
  document.addEventListener("pointerleave", clear);

  // Round marks inside min..max, as quantity.rs chooses them.
  const marks = (min, max, wanted) => {
    const raw = (max - min) / Math.max(1, wanted), power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= 0.7 * raw) ?? power;
    const digits = Math.max(0, -Math.floor(Math.log10(step)));
    const all = [];
    for (let i = Math.ceil(min / step - 1e-6); i <= Math.floor(max / step + 1e-6) && all.length < 50; i++)
      all.push([i * step, (i * step).toFixed(digits).replace("-", "\u2212")]);
    return all;
  };
  const label = (text, x, y, name) => `<text x="${x}" y="${y}" class="${name}">${text}</text>`;
  // Grid and labels of a plot anew, after its ends have changed.
  const relabel = (plot) => {
    const area = plot.querySelector("svg.lines");
    const [left, top, wide, tall] = ["x", "y", "width", "height"].map((k) => area[k].baseVal.value);
    let grid = "", labels = "";
    const x = axis(plot.dataset.x), y = axis(plot.dataset.y);
    for (const [v, text] of marks(x.min, x.max, wide / 48 | 0)) {
      const at = left + (v - x.min) / (x.max - x.min) * wide;
      grid += `M${at} ${top}v${tall}`;
      labels += label(text, Math.min(at, plot.viewBox.baseVal.width - 3.2 * text.length), top + tall + 14.5, "tx");
    }
    for (const [v, text] of marks(y.min, y.max, tall / 34 | 0)) {
      const at = top + (1 - (v - y.min) / (y.max - y.min)) * tall;
      grid += `M${left} ${at}h${wide}`;
      labels += label(text, left - 6, at + 3.6, "ty");
    }
    plot.querySelector("path.grid").setAttribute("d", grid);
    plot.querySelector("g.labels").innerHTML = labels;
  };
  const look = (plot, box, x, y) => {
    for (const inner of plot.querySelectorAll("svg")) inner.setAttribute("viewBox", box.join(" "));
    plot.dataset.x = `${x.min} ${x.max} ${x.unit}`;
    plot.dataset.y = `${y.min} ${y.max} ${y.unit}`;
    relabel(plot);
  };
  const whole = new WeakMap();
  document.addEventListener("pointerdown", (event) => {
    const plot = event.target.closest?.("svg.plot");
    if (!plot || plot.closest(".picture") || event.button || event.pointerType === "touch") return;
    event.preventDefault();
    const rubber = document.createElement("div");
    rubber.className = "rubber";
    plot.closest("figure").append(rubber);
    drag = { plot, rubber, x: event.clientX, y: event.clientY };
  });
  document.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const outer = drag.plot.closest("figure").getBoundingClientRect();
    const place = { left: Math.min(drag.x, event.clientX) - outer.left, top: Math.min(drag.y, event.clientY) - outer.top,
      width: Math.abs(event.clientX - drag.x), height: Math.abs(event.clientY - drag.y) };
    for (const k in place) drag.rubber.style[k] = place[k] + "px";
  });
  document.addEventListener("pointerup", (event) => {
    if (!drag) return;
    const { plot, rubber, x: x0, y: y0 } = drag;
    rubber.remove();
    drag = null;
    if (Math.abs(event.clientX - x0) < 8) return;
    const area = plot.querySelector("svg.lines"), view = area.viewBox.baseVal;
    const frame = plot.getBoundingClientRect(), scale = frame.width / plot.viewBox.baseVal.width;
    const part = (at, start, from, long) => Math.min(1, Math.max(0, (at - start - from * scale) / (long * scale)));
    const share = (a, b, start, from, long) => [a, b].map((at) => part(at, start, from, long)).sort((p, q) => p - q);
    const [l, r] = share(x0, event.clientX, frame.left, area.x.baseVal.value, area.width.baseVal.value);
    // A drag along the axis keeps the height.
    const flat = Math.abs(event.clientY - y0) < 12;
    const [t, b] = flat ? [0, 1] : share(y0, event.clientY, frame.top, area.y.baseVal.value, area.height.baseVal.value);
    if (r - l < 1e-3 || b - t < 1e-3) return;
    const x = axis(plot.dataset.x), y = axis(plot.dataset.y);
    if (!whole.has(plot)) whole.set(plot, [[view.x, view.y, view.width, view.height], x, y]);
    const inside = (a, from, to) => ({ ...a, min: a.min + from * (a.max - a.min), max: a.min + to * (a.max - a.min) });
    look(plot, [view.x + l * view.width, view.y + t * view.height, (r - l) * view.width, (b - t) * view.height],
      inside(x, l, r), inside(y, 1 - b, 1 - t));
  });
  document.addEventListener("dblclick", (event) => {
    const plot = event.target.closest?.("svg.plot");
    if (plot && whole.has(plot)) look(plot, ...whole.get(plot));
  });

  // Two runs over each other.
  const overlay = document.getElementById("overlay");
  if (!overlay) return;
  const data = JSON.parse(document.getElementById("traces").textContent);
  const column = ([low, step, differences]) => { let sum = 0; return differences.map((d) => low + step * (sum += d)); };
  const unpack = (index) => {
    const run = data[index];
    if (!run.all) run.all = { t: column(run.t), x: column(run.x), f: column(run.f), e: column(run.e) };
    return run;
  };
  const size = { width: 480, height: 270, left: 40, top: 20, right: 10, bottom: 35 };
  const prefix = (largest, unit) => largest >= 1 || !largest ? [1, unit] : largest >= 1e-3 ? [1e-3, "m" + unit] : [1e-6, "\u00b5" + unit];
  const draw = (title, ax, ay, lines) => {
    const wide = size.width - size.left - size.right, tall = size.height - size.top - size.bottom;
    const span = (values) => values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
    const ends = (key) => {
      let [a, b] = span(lines.flatMap((line) => span(line[key])));
      if (!(b > a)) { a -= 1; b += 1; }
      const pad = key === "ys" ? 0.05 * (b - a) : 0;
      return [a - pad, b + pad];
    };
    const [x0, x1] = ends("xs"), [y0, y1] = ends("ys");
    const [fx, ux] = prefix(Math.max(Math.abs(x0), Math.abs(x1)), ax[1]), [fy, uy] = prefix(Math.max(Math.abs(y0), Math.abs(y1)), ay[1]);
    const path = ({ xs, ys, role, name }) => {
      let d = "", px = 0, py = 0;
      for (let i = 0; i < xs.length; i++) {
        const x = Math.round((xs[i] - x0) / (x1 - x0) * wide * 10), y = Math.round((1 - (ys[i] - y0) / (y1 - y0)) * tall * 10);
        d += i ? (i > 1 ? " " : "l") + (x - px) + " " + (y - py) : `M${x} ${y}`;
        px = x; py = y;
      }
      return `<path class="${role}" data-n="${name}" data-dense d="${d}"/>`;
    };
    const inner = (name, content) => `<svg class="${name}" x="${size.left}" y="${size.top}" width="${wide}" height="${tall}" viewBox="0 0 ${wide * 10} ${tall * 10}" preserveAspectRatio="none">${content}</svg>`;
    const figure = document.createElement("figure");
    figure.innerHTML = `<figcaption><strong>${title}</strong></figcaption><svg class='plot' viewBox="0 0 ${size.width} ${size.height}" role="img" aria-label="${title}"` +
      ` data-x="${x0 / fx} ${x1 / fx} ${ux}" data-y="${y0 / fy} ${y1 / fy} ${uy}">${inner("behind", "")}<path class="grid"/>${inner("lines", lines.map(path).join(""))}` +
      `<path class="axis" d="M${size.left} ${size.top}v${tall}h${wide}"/><g class="labels"></g>` +
      label(`${ay[0]} (${uy})`, 2, 11, "at") + label(`${ax[0]} (${ux})`, size.left + wide, size.height - 5, "at te") + "</svg>";
    relabel(figure.querySelector("svg.plot"));
    return figure;
  };
  const choose = ["run-a", "run-b"].map((id) => document.getElementById(id));
  const show2 = () => {
    const runs = choose.map((select, i) => ({ ...unpack(select.value), role: "ab"[i], name: select.selectedOptions[0].text.split(" \u00b7")[0] }));
    const lines = (x, y) => runs.map((run) => ({ role: run.role, name: run.name, xs: run.all[x], ys: run.all[y] }));
    overlay.replaceChildren(
      draw("Position", ["time", "s"], ["angle", "rad"], lines("t", "x")),
      draw("Force", ["time", "s"], ["force", "N\u00b7m"], lines("t", "f")),
      draw("Force against position", ["angle", "rad"], ["force", "N\u00b7m"], lines("x", "f")),
      draw("Energy of the wall's port", ["time", "s"], ["energy", "J"], lines("t", "e")));
  };
  choose.forEach((select) => select.addEventListener("change", show2));
  show2();
})();
