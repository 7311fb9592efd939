// A machine on a canvas: orthographic view that turns, shifts and zooms, drawn from far to near.
const COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#7f7f7f", "#8c6bb1", "#a6761d", "#666600"];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const n = Math.hypot(...a) || 1; return a.map(x => x / n); };
const ink = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
// From blue over green to yellow (Viridis at nine places).
const SCALE = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
function tint(value, range) {
  const s = Math.min(1, Math.max(0, (value - range[0]) / (range[1] - range[0] || 1))) * (SCALE.length - 1);
  const k = Math.min(SCALE.length - 2, Math.floor(s)), f = s - k;
  return "rgb(" + SCALE[k].map((c, i) => Math.round(c + (SCALE[k + 1][i] - c) * f)).join(",") + ")";
}
// The frame before an instant and how far the next one is.
function between(times, t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) { const middle = (low + high) >> 1; if (times[middle] <= t) low = middle; else high = middle; }
  const span = times[high] - times[low];
  return [low, high, span > 0 ? Math.min(1, Math.max(0, (t - times[low]) / span)) : 0];
}
const mix = (a, b, f) => a.map((x, i) => x + (b[i] - x) * f);
class Camera {
  constructor(view) { this.first = view; this.reset(); }
  reset() {
    const right = unit(this.first[0]), towards = unit(cross(this.first[0], this.first[1]));
    this.right = unit(cross(cross(towards, right), towards)); this.up = cross(towards, this.right); this.shift = [0, 0]; this.zoom = 1;
  }
  turn(dx, dy) {
    const about = (v, axis, angle) => { // Rodrigues' formula
      const c = Math.cos(angle), s = Math.sin(angle), w = cross(axis, v), d = dot(axis, v) * (1 - c);
      return v.map((x, i) => x * c + w[i] * s + axis[i] * d);
    };
    const upright = unit(this.first[1]);
    this.right = about(this.right, upright, -dx); this.up = about(this.up, upright, -dx);
    this.up = about(this.up, this.right, -dy); this.right = unit(this.right); this.up = unit(this.up);
  }
}
class Scene {
  constructor(stage, index) {
    this.stage = stage; this.figure = document.createElement("figure"); this.canvas = document.createElement("canvas");
    this.canvas.tabIndex = 0; this.canvas.setAttribute("role", "img"); this.canvas.id = "scene" + index;
    this.canvas.setAttribute("aria-label", `${stage.title || "motion"}: ${stage.bodies.map(b => b.name).filter(n => n).join(", ") || "structure"}. Arrow keys turn, plus and minus zoom, 0 resets the view.`);
    this.caption = document.createElement("figcaption"); this.figure.append(this.canvas, this.caption);
    this.bounds(); this.share = 0; this.forces = false; this.most = 1;
  }
  bounds() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const see = (p, r = 0) => p.forEach((x, i) => { low[i] = Math.min(low[i], x - r); high[i] = Math.max(high[i], x + r); });
    for (const body of this.stage.bodies) {
      const s = body.shape;
      if (s.kind === "mesh" || s.kind === "modal") { (s.places ?? s.poses).forEach((_, k) => this.point(s, k, k, 0).forEach(p => see(p))); }
      else { const r = s.radius ?? Math.max(0, ...s.points.map(p => Math.hypot(...p))); for (const pose of s.poses) see(pose.slice(0, 3), r); }
    }
    for (const link of this.stage.links) if (link.kind !== "slider") for (const e of link.ends) { see(e.slice(0, 3)); see(e.slice(3)); }
    for (const path of this.stage.paths) for (const p of path) see(p);
    if (!isFinite(low[0])) { low.fill(-1); high.fill(1); }
    this.near = [[...low], [...high]];
    const [right, up] = this.stage.view.map(unit), seen = (x, y) => see(right.map((a, i) => a * x + up[i] * y));
    for (const [x, y] of this.stage.flight) seen(x, y);
    if (this.stage.flight.length && this.stage.barrier) seen(...this.stage.barrier);
    this.far = [low, high];
  }
  point(shape, k0, k1, f) { // vertices of a body in ground axes, and its origin
    if (shape.kind === "mesh") { const p = mix(shape.places[k0], shape.places[k1], f); return Array.from({ length: p.length / 3 }, (_, i) => p.slice(3 * i, 3 * i + 3)); }
    const pose = mix(shape.poses[k0], shape.poses[k1], f), origin = pose.slice(0, 3), a = unit(pose.slice(3, 6));
    const c = unit(cross(a, pose.slice(6, 9))), b = cross(c, a);
    let points = shape.points ?? [[0, 0, 0]];
    if (shape.kind === "modal") { const q = mix(shape.coordinates[k0], shape.coordinates[k1], f); points = points.map((p, j) => p.map((x, i) => q.reduce((sum, c, m) => sum + c * shape.basis[m][3 * j + i], x))); }
    return points.map(p => origin.map((o, i) => o + a[i] * p[0] + b[i] * p[1] + c[i] * p[2]));
  }
  draw(t, camera) {
    const stage = this.stage, ratio = window.devicePixelRatio || 1, width = this.canvas.clientWidth || 480, height = Math.round(Math.min(width * 0.75, 460));
    this.canvas.style.height = height + "px"; this.canvas.width = width * ratio; this.canvas.height = height * ratio;
    const g = this.canvas.getContext("2d"); g.scale(ratio, ratio); g.lineJoin = "round";
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(k => [0, 1, 2].map(i => (k >> i & 1 ? this.high : this.low)[i]));
    const middle = mix(this.low, this.high, 0.5), towards = cross(camera.right, camera.up);
    const half = [camera.right, camera.up].map(axis => Math.max(1e-9, ...corners.map(c => Math.abs(dot(axis, c.map((x, i) => x - middle[i]))))));
    const scale = 0.43 * Math.min(width / half[0], height / half[1]) * camera.zoom;
    const flat = p => { const d = p.map((x, i) => x - middle[i]); return [width / 2 + scale * (dot(camera.right, d) + camera.shift[0]), height / 2 - scale * (dot(camera.up, d) + camera.shift[1])]; };
    const line = points => { g.beginPath(); points.forEach((p, i) => i ? g.lineTo(...p) : g.moveTo(...p)); };
    const square = this.stage.view.every((axis, k) => dot(unit(axis), [camera.right, camera.up][k]) > 0.9999);
    if (square && stage.ground !== null) { const y = flat(stage.view[1].map(x => x * stage.ground))[1]; g.strokeStyle = "#8c6d31"; g.lineWidth = 1.5; line([[0, y], [width, y]]); g.stroke(); }
    if (square && stage.barrier) { const at = h => flat(stage.view[0].map((x, i) => x * stage.barrier[0] + stage.view[1][i] * h)); g.strokeStyle = ink("--ink"); g.lineWidth = 3; line([at(stage.ground ?? 0), at(stage.barrier[1])]); g.stroke(); }
    if (square && stage.flight.length) { g.strokeStyle = ink("--accent"); g.lineWidth = 1.5; g.setLineDash([6, 4]); line(stage.flight.map(([x, y]) => flat(stage.view[0].map((a, i) => a * x + stage.view[1][i] * y)))); g.stroke(); g.setLineDash([]); }
    g.strokeStyle = ink("--faint"); g.lineWidth = 1; for (const path of stage.paths) { line(path.map(flat)); g.stroke(); }
    let [k0, k1, f] = between(stage.times, t); if (stage.swings) { k0 = 0; k1 = 1; f = Math.cos(2 * Math.PI * t); }
    const parts = [];
    stage.bodies.forEach((body, index) => {
      const shape = body.shape, points = this.point(shape, k0, k1, f), colour = COLOURS[index % COLOURS.length];
      const depth = list => list.reduce((s, p) => s + dot(towards, p), 0) / list.length;
      const outline = (list, fill, alpha, edge) => () => {
        if (list.length > 2) { line(list); g.closePath(); g.globalAlpha = alpha; g.fillStyle = fill; g.fill(); g.globalAlpha = 1; } else line(list);
        const thin = list.length > 2 && thickness(list) < 2; g.strokeStyle = list.length > 2 && !thin ? edge : fill; g.lineWidth = thin || list.length === 2 ? 3 : 0.7; g.stroke();
      };
      if (shape.faces) {
        const values = stage.range && shape.values.length && shape.values[k0].length ? mix(shape.values[k0], shape.values[k1], stage.swings ? Math.abs(f) : f) : null;
        shape.faces.forEach((face, i) => { const list = face.map(k => points[k]);
          parts.push([depth(list), outline(list.map(flat), values ? tint(values[i], stage.range) : colour, values ? 1 : 0.55, values ? "rgba(0,0,0,.25)" : colour)]); });
      } else if (shape.kind === "sphere") {
        parts.push([depth(points), () => { g.beginPath(); g.arc(...flat(points[0]), Math.max(2, shape.radius * scale), 0, 7); g.globalAlpha = 0.55; g.fillStyle = colour; g.fill(); g.globalAlpha = 1; g.strokeStyle = colour; g.lineWidth = 1.2; g.stroke(); }]);
      } else if (shape.kind === "hull") {
        parts.push([depth(points), outline(hull(points.map(flat)), colour, 0.5, colour)]);
      } else {
        const origin = flat(mix(shape.poses[k0], shape.poses[k1], f).slice(0, 3));
        parts.push([depth(points), () => { g.strokeStyle = colour; g.lineWidth = 2; for (const p of points) { line([origin, flat(p)]); g.stroke(); } g.beginPath(); g.arc(...origin, 3, 0, 7); g.fillStyle = colour; g.fill(); }]);
      }
    });
    parts.sort((a, b) => a[0] - b[0]).forEach(part => part[1]());
    for (const link of stage.links) {
      const e = mix(link.ends[k0], link.ends[k1], f), a = flat(e.slice(0, 3)), b = flat(e.slice(3));
      g.lineWidth = 1.5; g.strokeStyle = link.kind === "rod" ? "#a0521d" : link.kind === "spring" ? "#b0298a" : link.body !== undefined ? COLOURS[link.body % COLOURS.length] : ink("--faint");
      if (link.kind === "spring") {
        const n = 12, d = [b[0] - a[0], b[1] - a[1]], l = Math.hypot(...d) || 1, w = [-d[1] / l * 5, d[0] / l * 5];
        line(Array.from({ length: n + 1 }, (_, i) => { const s = i === 0 || i === n ? 0 : i % 2 ? 1 : -1; return [a[0] + d[0] * i / n + w[0] * s, a[1] + d[1] * i / n + w[1] * s]; })); g.stroke();
      } else if (link.kind === "slider") {
        const d = [b[0] - a[0], b[1] - a[1]], l = Math.hypot(...d) || 1; line([-14, 14].map(s => [a[0] + d[0] / l * s, a[1] + d[1] / l * s])); g.lineWidth = 4; g.stroke();
      } else if (link.kind !== "hinge") { line([a, b]); g.stroke(); }
      if (link.kind === "hinge") { g.beginPath(); g.arc(...a, Math.max(0.7, Math.min(3.5, 140 / stage.links.length)), 0, 7); g.fillStyle = link.grounded ? ink("--ink") : ink("--back"); g.fill(); g.strokeStyle = ink("--ink"); g.stroke(); }
    }
    if (this.forces) {
      g.font = "11px system-ui, sans-serif"; g.textBaseline = "bottom"; g.textAlign = "left";
      for (const arrow of stage.arrows) {
        const e = mix(arrow.forces[k0], arrow.forces[k1], f), size = Math.hypot(...e.slice(3)); if (size < 1e-9 * this.most) continue;
        const a = flat(e.slice(0, 3)), b = [dot(camera.right, e.slice(3)), -dot(camera.up, e.slice(3))].map((x, i) => a[i] + 90 * x / Math.sqrt(size * this.most));
        const d = [b[0] - a[0], b[1] - a[1]], l = Math.hypot(...d); g.strokeStyle = g.fillStyle = arrow.applied ? "#d7191c" : "#2c7bb6"; g.lineWidth = 2; line([a, b]); g.stroke();
        if (l > 3) { const [u, v] = [d[0] / l, d[1] / l]; line([b, [b[0] - 7 * u + 3 * v, b[1] - 7 * v - 3 * u], [b[0] - 7 * u - 3 * v, b[1] - 7 * v + 3 * u]]); g.closePath(); g.fill(); } else { g.beginPath(); g.arc(...a, 5, 0, 7); g.stroke(); }
        const text = size.toPrecision(4) + " N"; g.lineWidth = 3; g.strokeStyle = ink("--panel"); g.strokeText(text, b[0] + 4, b[1]); g.fillText(text, b[0] + 4, b[1]);
      }
    }
    if (stage.range) {
      const [w, h] = [Math.min(150, width / 3), 9], x = width - w - 12;
      g.globalAlpha = 0.8; g.fillStyle = ink("--panel"); g.fillRect(x - 6, 4, w + 14, 34); g.globalAlpha = 1;
      SCALE.forEach((_, i) => { g.fillStyle = tint(i, [0, SCALE.length - 1]); g.fillRect(x + w * i / SCALE.length, 10, w / SCALE.length + 1, h); });
      g.fillStyle = ink("--faint"); g.font = "11px system-ui, sans-serif"; g.textBaseline = "top"; g.textAlign = "left"; g.fillText(number(stage.range[0]), x, 22); g.textAlign = "right"; g.fillText(number(stage.range[1]), x + w, 22);
    }
    this.caption.textContent = (stage.title || "motion") + (stage.label ? ` (${stage.label})` : "");
    this.scale = scale;
  }
}
// Area of a face of the picture by its length: a face that is thinner than a line is drawn as one.
function thickness(list) {
  let area = 0, length = 0; list.forEach((p, i) => { const q = list[(i + 1) % list.length]; area += p[0] * q[1] - p[1] * q[0]; length = Math.max(length, Math.hypot(q[0] - p[0], q[1] - p[1])); });
  return Math.abs(area) / 2 / (length || 1);
}
// Convex hull of points of the picture (Andrew's monotone chain).
function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const chain = list => { const c = []; for (const p of list) { while (c.length > 1) { const [a, b] = c.slice(-2); if ((b[0] - a[0]) * (p[1] - a[1]) > (b[1] - a[1]) * (p[0] - a[0])) break; c.pop(); } c.push(p); } c.pop(); return c; };
  const all = [...chain(sorted), ...chain(sorted.reverse())]; return all.length > 1 ? all : points;
}
