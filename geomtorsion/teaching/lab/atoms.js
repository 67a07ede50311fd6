"use strict";
// A circuit from atom to atom. The element #data holds the crystals as JSON, each bond with its
// nearest lattice vector. Nothing is rounded here: whole numbers are added.
(() => {
  const { crystals, text } = JSON.parse(document.getElementById("data").textContent);
  const [which, crystal, image, result] = ["which", "crystal", "image", "result"].map((id) => document.getElementById(id));
  const PATH = "#0072B2", IMAGE = "#007a59", GAP = "#C24E00", INK = "#1d2330", PALE = "#c9ccd1";
  let atoms, steps, path, low, high;

  function load() {
    const found = crystals[which.value];
    atoms = found.atoms;
    steps = atoms.map(() => []);
    for (const [a, b, dx, dy] of found.bonds) {
      steps[a].push({ to: b, dx, dy });
      steps[b].push({ to: a, dx: -dx, dy: -dy });
    }
    low = [0, 1].map((k) => Math.min(...atoms.map((p) => p[k])) - 0.7);
    high = [0, 1].map((k) => Math.max(...atoms.map((p) => p[k])) + 0.7);
    path = [];
    draw();
  }

  // The shortest path along bonds; among equal ones the straightest.
  function way(from, to) {
    const before = new Map([[from, null]]);
    let rim = [from];
    while (rim.length && !before.has(to)) {
      const next = [];
      for (const a of rim) {
        const came = before.get(a);
        const same = (s) => came && s.dx === came.dx && s.dy === came.dy;
        for (const s of [...steps[a]].sort((x, y) => same(y) - same(x))) {
          if (before.has(s.to)) continue;
          before.set(s.to, { from: a, dx: s.dx, dy: s.dy });
          next.push(s.to);
        }
      }
      rim = next;
    }
    const found = [];
    for (let at = to; at !== from; at = before.get(at).from) {
      if (!before.get(at)) return [];
      found.unshift(at);
    }
    return found;
  }
  function go(to) {
    if (!path.length) path = [to];
    else if (to !== path[path.length - 1]) path.push(...way(path[path.length - 1], to));
    draw();
  }
  function label(a, b) { return steps[a].find((s) => s.to === b); }
  function closed() { return path.length > 2 && path[0] === path[path.length - 1]; }

  function draw() {
    const places = path.map((k) => atoms[k]);
    const sums = [[0, 0]];
    for (let k = 1; k < path.length; k++) {
      const s = label(path[k - 1], path[k]);
      sums.push([sums[k - 1][0] + s.dx, sums[k - 1][1] + s.dy]);
    }
    const size = [high[0] - low[0], high[1] - low[1]];
    frame(crystal, low, size);
    for (const line of bonds()) crystal.append(line);
    atoms.forEach((p, k) => crystal.append(dot(p, 0.17, path.includes(k) ? PATH : "#8a93a3", k)));
    trace(crystal, places, PATH);
    // The perfect lattice has the same size and the same start as the crystal.
    const start = path.length ? [Math.round(places[0][0] - 0.5) + 0.5, Math.round(places[0][1] - 0.5) + 0.5] : [0, 0];
    const shifted = sums.map(([x, y]) => [x + start[0], y + start[1]]);
    frame(image, low, size);
    for (let x = Math.ceil(low[0] - 0.5) + 0.5; x < high[0]; x++) {
      for (let y = Math.ceil(low[1] - 0.5) + 0.5; y < high[1]; y++) image.append(dot([x, y], 0.1, PALE));
    }
    if (path.length) trace(image, shifted, IMAGE);
    const last = sums[sums.length - 1];
    if (closed() && (last[0] || last[1])) arrow(image, shifted[0], shifted[shifted.length - 1]);
    result.textContent = resultText(last, places);
  }

  function bonds() {
    const near = [];
    steps.forEach((list, a) => list.forEach((s) => {
      if (s.to > a) near.push(line([atoms[a], atoms[s.to]], PALE, 0.05));
    }));
    return near;
  }
  function resultText(last, places) {
    const n = path.length - 1;
    const filled = (key, sense) => text[key].replace("{n}", n).replace("{b}", vector(last)).replace("{sense}", text[sense]);
    if (n < 0) return text.begin;
    if (!closed()) return filled(n === 1 ? "step" : "steps");
    let area = 0;
    places.forEach((p, k) => { const q = places[(k + 1) % places.length]; area += p[0] * q[1] - q[0] * p[1]; });
    const sense = Math.abs(area) < 1e-9 ? "straight" : area > 0 ? "anticlockwise" : "clockwise";
    return filled(last[0] || last[1] ? "open" : "closed", sense);
  }
  function vector(v) { return `(${v.map((x) => String(x).replace("-", "−")).join(", ")})`; }

  function element(name, attributes) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  }
  // y points up, so its sign changes in the picture.
  function frame(svg, from, size) {
    svg.replaceChildren();
    svg.setAttribute("viewBox", `${from[0]} ${-from[1] - size[1]} ${size[0]} ${size[1]}`);
  }
  function dot([x, y], r, color, number) {
    const made = element("circle", { cx: x, cy: -y, r, fill: color });
    if (number !== undefined) made.dataset.atom = number;
    return made;
  }
  function line(points, color, width) {
    return element("polyline", { points: points.map(([x, y]) => `${x},${-y}`).join(" "), fill: "none", stroke: color, "stroke-width": width, "stroke-linejoin": "round" });
  }
  function trace(svg, points, color) {
    if (!points.length) return;
    svg.append(line(points, color, 0.13));
    const end = points[points.length - 1];
    // A black dot is the start, as in every picture of the page. A ring is the current atom.
    // Clicks go to the atoms below.
    const marks = element("g", { "pointer-events": "none" });
    marks.append(dot(points[0], 0.2, INK));
    marks.append(element("circle", { cx: end[0], cy: -end[1], r: 0.33, fill: "none", stroke: color, "stroke-width": 0.1 }));
    svg.append(marks);
  }
  function arrow(svg, from, to) {
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]], long = Math.hypot(dx, dy);
    const [ux, uy] = [dx / long, dy / long];
    const neck = [to[0] - 0.45 * ux, to[1] - 0.45 * uy];
    svg.append(line([from, neck], GAP, 0.17));
    const head = [to, [neck[0] - 0.25 * uy, neck[1] + 0.25 * ux], [neck[0] + 0.25 * uy, neck[1] - 0.25 * ux]];
    svg.append(element("polygon", { points: head.map(([x, y]) => `${x},${-y}`).join(" "), fill: GAP }));
    const text = element("text", { x: (from[0] + to[0]) / 2 - uy * 0.6, y: -(from[1] + to[1]) / 2 - Math.abs(ux) * 0.35, fill: GAP, "font-size": 0.95, "font-weight": 600, "text-anchor": "middle", stroke: "#fff", "stroke-width": 0.18, "paint-order": "stroke" });
    text.textContent = "b";
    svg.append(text);
  }

  crystal.addEventListener("click", (event) => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(crystal.getScreenCTM().inverse());
    go(nearest([at.x, -at.y]));
  });
  crystal.addEventListener("keydown", (event) => {
    const keys = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    if (event.key === "Backspace") { path.pop(); draw(); event.preventDefault(); }
    // With a second key they are commands of the browser, such as the previous page.
    if (!(event.key in keys) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (!path.length) { go(nearest([-2, -2])); return; }
    const [dx, dy] = keys[event.key];
    const found = steps[path[path.length - 1]].find((s) => s.dx === dx && s.dy === dy);
    if (found) { path.push(found.to); draw(); }
  });
  function nearest(place) {
    let best = 0;
    atoms.forEach((p, k) => { if (Math.hypot(p[0] - place[0], p[1] - place[1]) < Math.hypot(atoms[best][0] - place[0], atoms[best][1] - place[1])) best = k; });
    return best;
  }
  document.getElementById("back").addEventListener("click", () => { path.pop(); draw(); });
  document.getElementById("restart").addEventListener("click", () => { path = []; draw(); });
  document.getElementById("example").addEventListener("click", () => {
    path = [nearest([-4.5, -2.5])];
    const [x, y] = atoms[path[0]];
    const walk = (dx, dy, on) => {
      for (let k = 0; on(k); k++) {
        const found = steps[path[path.length - 1]].find((s) => s.dx === dx && s.dy === dy);
        if (!found) return;
        path.push(found.to);
      }
    };
    const here = () => atoms[path[path.length - 1]];
    walk(1, 0, (k) => k < 9);
    walk(0, 1, (k) => k < 6);
    walk(-1, 0, () => here()[0] > x + 0.5);
    walk(0, -1, () => here()[1] > y + 0.5);
    draw();
  });
  which.addEventListener("change", load);
  load();
})();
