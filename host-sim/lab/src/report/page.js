// A read-out under the pointer. The page is complete without it: it only reads the drawn lines back.
"use strict";
(() => {
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
  let box = null, cursor = null;
  const clear = () => { box?.remove(); cursor?.remove(); box = cursor = null; };
  document.addEventListener("pointermove", (event) => {
    const plot = event.target.closest?.("svg.plot");
    if (!plot) return clear();
    // The browser's own tooltip would cover the read-out; assistive technology keeps the name.
    const title = plot.querySelector("title");
    if (title) { plot.setAttribute("aria-label", title.textContent); plot.removeAttribute("aria-labelledby"); title.remove(); }
    const area = [...plot.querySelectorAll("svg")].pop();
    const view = area.viewBox.baseVal, whole = plot.viewBox.baseVal, rect = plot.getBoundingClientRect();
    const scale = whole.width / rect.width;
    const fx = ((event.clientX - rect.left) * scale - area.x.baseVal.value) / area.width.baseVal.value;
    const fy = ((event.clientY - rect.top) * scale - area.y.baseVal.value) / area.height.baseVal.value;
    clear();
    if (fx < 0 || fx > 1 || fy < 0 || fy > 1) return;
    const x = axis(plot.dataset.x), y = axis(plot.dataset.y);
    const rows = [];
    const up = (fine) => y.max - fine / view.height * (y.max - y.min);
    if (x.unit.endsWith("s")) {
      rows.push("t = " + show(x.min + fx * (x.max - x.min), x));
      for (const line of decode(plot)) {
        const fine = at(line.parts, fx * view.width);
        if (fine !== null && line.name !== "zero") rows.push(line.name + ": " + show(up(fine), y));
      }
    } else {
      rows.push("x = " + show(x.min + fx * (x.max - x.min), x), "f = " + show(y.max - fy * (y.max - y.min), y));
    }
    cursor = plot.querySelector("path.grid").cloneNode(false);
    cursor.setAttribute("class", "cursor");
    cursor.setAttribute("d", `M${fx * view.width} 0V${view.height}` + (x.unit.endsWith("s") ? "" : `M0 ${fy * view.height}H${view.width}`));
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
})();
