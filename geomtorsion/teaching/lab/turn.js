"use strict";
// A picture in space that can be turned. The element #data holds its data as JSON.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const canvas = document.getElementById("space");
  const slider = document.getElementById("time");
  const clock = document.getElementById("clock");
  const play = document.getElementById("play");
  let pen = canvas.getContext("2d");
  const SOFT = "#5c6475", INK = "#1d2330", FAINT = "#c9ccd1";
  const view = { turn: data.turn, tilt: 0.42, zoom: 1, ...kept() };
  // The next frame of a running animation; 0 if none runs.
  let running = 0;

  function kept() {
    try { return JSON.parse(sessionStorage.getItem("view " + data.name)) ?? {}; } catch { return {}; }
  }
  function keep() {
    try { sessionStorage.setItem("view " + data.name, JSON.stringify(view)); } catch { /* not here */ }
  }

  // Some points at some times show the extent of the moving parts.
  const some = (all) => all.filter((_, k) => k % 16 === 0 || k === all.length - 1);
  const moved = some(data.attitudes).flatMap((m) => data.moving.flatMap((part) => some(part.points).map((p) => turn(m, p))));
  const still = [...data.curves.flatMap((curve) => curve.points), ...moved];
  const low = [0, 1, 2].map((k) => Math.min(...still.map((p) => p[k]), ...(data.globe ? [-data.globe] : [])));
  const high = [0, 1, 2].map((k) => Math.max(...still.map((p) => p[k]), ...(data.globe ? [data.globe] : [])));
  const ball = Math.max(0, ...moved.map((p) => Math.hypot(...p)));
  const centre = data.globe ? [0, 0, 0] : low.map((a, k) => (a + high[k]) / 2);
  const spans = low.map((a, k) => Math.max(high[k] - a, 1e-12));
  const widest = Math.max(...spans);
  // Unless lengths matter, each direction fills its share of the box.
  const scale = spans.map((s) => (data.equal || data.globe || ball ? 1 : (0.7 * widest) / Math.max(s, 1e-6 * widest)));
  const far = ball ? still.map((p) => Math.hypot(...p.map((x, k) => x - centre[k]))) : [Math.hypot(...spans.map((s, k) => (s * scale[k]) / 2))];
  const radius = data.globe || Math.max(...far, 1e-12);

  function camera() {
    const a = view.turn, e = view.tilt;
    return {
      right: [-Math.sin(a), Math.cos(a), 0],
      up: [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)],
      toward: [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)],
    };
  }
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  function blank(sheet) {
    const box = sheet.getBoundingClientRect();
    const fine = window.devicePixelRatio || 1;
    sheet.width = box.width * fine;
    sheet.height = box.height * fine;
    pen = sheet.getContext("2d");
    pen.setTransform(fine, 0, 0, fine, 0, 0);
    return box;
  }
  // The legend: a piece of each line as it looks, with its mark.
  function legend() {
    const curves = [...data.curves, ...data.moving];
    for (const sheet of document.querySelectorAll("li canvas")) {
      const curve = curves[Number(sheet.dataset.curve)];
      blank(sheet);
      line([[2, 8, 1, 0], [44, 8, 1, 0]], curve, curve.width);
      if (curve.mark) shape([44, 8, 1, 0], curve.mark, curve.color);
    }
  }
  // A pen with the methods of a canvas that writes SVG.
  class SvgPen {
    constructor(box) { Object.assign(this, { box, parts: [], path: "", dashes: [], globalAlpha: 1 }); }
    setLineDash(dashes) { this.dashes = dashes; }
    beginPath() { this.path = ""; }
    moveTo(x, y) { this.path += `M${x.toFixed(2)} ${y.toFixed(2)}`; }
    lineTo(x, y) { this.path += `${this.path ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`; }
    // Only whole circles are drawn.
    arc(x, y, r) { this.path += `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`; }
    closePath() { this.path += "Z"; }
    put(name, look, inner = "") { this.parts.push(`<${name} ${look} opacity="${this.globalAlpha}">${inner}</${name}>`); }
    stroke() { this.put("path", `d="${this.path}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}" stroke-linejoin="round" stroke-dasharray="${this.dashes.join(" ")}"`); }
    fill() { this.put("path", `d="${this.path}" fill="${this.fillStyle}"`); }
    measureText(text) { return canvas.getContext("2d").measureText(text); }
    text(text, x, y, look) {
      const plain = text.replace(/&/g, "&amp;").replace(/</g, "&lt;");
      this.put("text", `x="${x}" y="${y}" font-family="sans-serif" font-weight="600" font-size="14" ${look}`, plain);
    }
    strokeText(text, x, y) { this.text(text, x, y, `fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"`); }
    fillText(text, x, y) { this.text(text, x, y, `fill="${this.fillStyle}"`); }
    get written() {
      const { width, height } = this.box;
      return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">${this.parts.join("")}</svg>`;
    }
  }
  window.pictureAsSvg = () => {
    const box = canvas.getBoundingClientRect();
    pen = new SvgPen(box);
    drawn(box);
    const { written } = pen;
    draw();
    return written;
  };
  function draw() { drawn(blank(canvas)); }
  function drawn(box) {
    const eye = camera();
    const unit = ((data.globe ? 0.37 : 0.48) * Math.min(box.width, box.height) * view.zoom) / radius;
    const place = (point) => {
      const p = point.map((x, k) => (x - centre[k]) * scale[k]);
      return [box.width / 2 + unit * dot(p, eye.right), box.height / 2 - unit * dot(p, eye.up), dot(p, eye.toward), Math.hypot(...p)];
    };
    if (data.globe) globe(place, box, unit);
    axes(place);
    const k = now();
    for (const curve of data.curves) {
      const points = curve.points.map(place);
      if (curve.cone) cone(place([0, 0, 0]), points, curve.color);
      line(points, curve, curve.thin ? 1.2 : curve.width);
    }
    for (const curve of data.curves) ends(curve, place, k);
    for (const part of data.moving) {
      const turned = part.points.map((p) => turn(data.attitudes[k], p)).map(place);
      if (part.cone) cone(place([0, 0, 0]), turned, part.color);
      line(turned, part, part.width);
      if (part.tip) label(turned[turned.length - 1], part.tip, part.color);
    }
    if (clock && data.times) clock.textContent = "t = " + data.times[k].toPrecision(4);
  }
  function turn(m, p) {
    return [0, 1, 2].map((i) => m[3 * i] * p[0] + m[3 * i + 1] * p[1] + m[3 * i + 2] * p[2]);
  }
  function now() { return slider ? Number(slider.value) : 0; }

  function hidden(p) {
    // Behind the globe: farther than its middle, and within its outline.
    const off = Math.sqrt(Math.max(0, p[3] * p[3] - p[2] * p[2]));
    return data.globe && p[2] < -1e-9 && off < data.globe * 0.9999;
  }
  function line(points, look, width) {
    pen.strokeStyle = look.color;
    pen.lineWidth = width;
    pen.lineJoin = "round";
    pen.setLineDash(look.dashes ?? []);
    let from = 0;
    for (let i = 1; i <= points.length; i++) {
      if (i < points.length && hidden(points[i]) === hidden(points[from])) continue;
      pen.globalAlpha = hidden(points[from]) ? 0.28 : 1;
      pen.beginPath();
      points.slice(from, Math.min(i + 1, points.length)).forEach((p, n) => (n ? pen.lineTo(p[0], p[1]) : pen.moveTo(p[0], p[1])));
      pen.stroke();
      from = i;
    }
    pen.globalAlpha = 1;
    pen.setLineDash([]);
  }
  // A pale surface from the apex to a curve; all its triangles run the same way on the screen, so
  // that one filling covers them evenly.
  function cone(apex, points, color) {
    pen.beginPath();
    for (let i = 1; i < points.length; i++) {
      const pair = [points[i - 1], points[i]];
      const [a, b] = pair.map((p) => [p[0] - apex[0], p[1] - apex[1]]);
      if (a[0] * b[1] < a[1] * b[0]) pair.reverse();
      pen.moveTo(apex[0], apex[1]);
      for (const p of pair) pen.lineTo(p[0], p[1]);
      pen.closePath();
    }
    pen.fillStyle = color;
    pen.globalAlpha = 0.18;
    pen.fill();
    pen.globalAlpha = 1;
  }
  function ends(curve, place, k) {
    const last = curve.points.length - 1;
    const p = place(curve.points[curve.mark && slider ? Math.min(k, last) : last]);
    if (curve.cone) line([place([0, 0, 0]), p], { color: curve.color }, 3);
    if (curve.mark) {
      shape(place(curve.points[0]), "o", INK);
      shape(p, curve.mark, curve.color);
    }
    if (curve.tip) label(p, curve.tip, curve.color);
  }
  function shape(p, kind, color) {
    // Named as in matplotlib; a circle for every other name.
    const forms = {
      s: [[-1, -1], [1, -1], [1, 1], [-1, 1]], "^": [[0, -1.3], [1.2, 0.9], [-1.2, 0.9]],
      D: [[0, -1.4], [1.2, 0], [0, 1.4], [-1.2, 0]], v: [[0, 1.3], [1.2, -0.9], [-1.2, -0.9]],
      P: [[-0.4, -1.2], [0.4, -1.2], [0.4, -0.4], [1.2, -0.4], [1.2, 0.4], [0.4, 0.4], [0.4, 1.2], [-0.4, 1.2], [-0.4, 0.4], [-1.2, 0.4], [-1.2, -0.4], [-0.4, -0.4]],
    };
    forms.X = forms.P.map(([a, b]) => [(a - b) * Math.SQRT1_2, (a + b) * Math.SQRT1_2]);
    pen.globalAlpha = hidden(p) ? 0.45 : 1;
    pen.fillStyle = color;
    pen.strokeStyle = "#fff";
    pen.lineWidth = 1.2;
    pen.beginPath();
    if (forms[kind]) forms[kind].forEach(([a, b]) => pen.lineTo(p[0] + 6 * a, p[1] + 6 * b));
    else pen.arc(p[0], p[1], 5, 0, 7);
    pen.closePath();
    pen.fill();
    pen.stroke();
    pen.globalAlpha = 1;
  }
  function label(p, text, color) {
    pen.font = "600 14px system-ui, sans-serif";
    pen.strokeStyle = "#fff";
    pen.lineWidth = 3;
    const wide = canvas.getBoundingClientRect().width - pen.measureText(text).width - 3;
    const [x, y] = [Math.max(2, Math.min(p[0] + 9, wide)), Math.max(14, p[1] - 7)];
    pen.strokeText(text, x, y);
    pen.fillStyle = color;
    pen.fillText(text, x, y);
  }
  function globe(place, box, unit) {
    pen.strokeStyle = FAINT;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.arc(box.width / 2, box.height / 2, unit * data.globe, 0, 7);
    pen.stroke();
    const steps = [...Array(49).keys()].map((i) => (i * Math.PI) / 24);
    const rings = [-1, 0, 1].map((n) => steps.map((s) => [Math.cos(s) * Math.cos(n * 0.52), Math.sin(s) * Math.cos(n * 0.52), Math.sin(n * 0.52)]));
    for (const a of [0, 1.0472, 2.0944]) rings.push(steps.map((s) => [Math.cos(a) * Math.cos(s), Math.sin(a) * Math.cos(s), Math.sin(s)]));
    for (const ring of rings) line(ring.map((p) => place(p.map((x) => x * data.globe))), { color: "#e3e5e8" }, 1);
  }
  function axes(place) {
    const long = data.globe ? 1.22 * data.globe : ball ? 0.75 * ball : null;
    const corner = long ? [0, 0, 0] : low;
    data.axes.forEach((name, k) => {
      const end = corner.slice();
      end[k] = long ?? high[k] + 0.08 * spans[k];
      const [a, b] = [place(corner), place(end)];
      line([a, b].map((p) => [p[0], p[1], 1, 2 * radius]), { color: SOFT }, 1.2);
      const ends = [low[k], high[k]].map((x) => String(Number(x.toPrecision(3))).replace("-", "−"));
      label(b, long ? name : `${name}: ${ends.join(" … ")}`, SOFT);
    });
  }

  function changeView(turn, tilt, zoom = 1) {
    view.turn += turn;
    view.tilt = Math.max(-1.55, Math.min(1.55, view.tilt + tilt));
    view.zoom = Math.max(0.4, Math.min(6, view.zoom * zoom));
    keep();
    draw();
  }
  let held = null;
  canvas.addEventListener("pointerdown", (event) => { held = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    changeView(-0.01 * (event.clientX - held[0]), 0.01 * (event.clientY - held[1]));
    held = [event.clientX, event.clientY];
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { held = null; });
  canvas.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1], "+": [0, 0, 1.15], "-": [0, 0, 1 / 1.15] };
    // With a second key they belong to the browser: its own zoom, the page before.
    if (!(event.key in steps) || event.ctrlKey || event.metaKey || event.altKey) return;
    changeView(...steps[event.key]);
    event.preventDefault();
  });
  if (slider) {
    slider.addEventListener("input", draw);
    const each = (1000 * data.seconds) / Number(slider.max);
    let last = 0;
    const step = (time) => {
      const gone = Math.max(0, Math.floor((time - last) / each));
      if (gone) {
        slider.value = Number(slider.value) + gone;
        // The rest of the time counts for the next frame.
        last += gone * each;
        draw();
      }
      if (slider.value === slider.max) stop();
      else running = requestAnimationFrame(step);
    };
    const stop = () => {
      cancelAnimationFrame(running);
      running = 0;
      play.textContent = data.play;
    };
    play.addEventListener("click", () => {
      if (running) { stop(); return; }
      if (slider.value === slider.max) slider.value = 0;
      play.textContent = data.pause;
      last = performance.now();
      running = requestAnimationFrame(step);
    });
  }
  new ResizeObserver(draw).observe(canvas);
  legend();
  draw();
})();
