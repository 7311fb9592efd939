// Curves on a canvas, with the values under the pointer.
const number = x => x === 0 ? "0" : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(3) : String(+x.toPrecision(5));
function ticks(low, high, count) {
  const raw = (high - low) / count || 1, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].find(s => s * power >= raw) * power, all = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) all.push(k * step); return all;
}
class LineChart {
  constructor(chart, index) {
    this.chart = chart; this.figure = document.createElement("figure"); this.canvas = document.createElement("canvas"); this.caption = document.createElement("figcaption");
    this.canvas.tabIndex = 0; this.canvas.setAttribute("role", "img"); this.canvas.id = "chart" + index;
    this.canvas.setAttribute("aria-label", `${chart.title} against ${chart.across}: ${chart.curves.map(c => c.points.length ? `${c.name} ends at ${number(c.points[c.points.length - 1][1])}` : c.name).join("; ")}`);
    const title = document.createElement("strong"); title.textContent = chart.title;
    const legend = document.createElement("div"); legend.className = "legend";
    chart.curves.forEach((c, i) => { const s = document.createElement("span"); s.textContent = c.name; s.style.setProperty("--c", COLOURS[i % COLOURS.length]); legend.append(s); });
    this.figure.append(title, this.canvas, legend, this.caption); this.at = null;
    const move = e => { const box = this.canvas.getBoundingClientRect(); this.at = (e.clientX - box.left - this.left) / (this.width - this.left - 10); this.draw(); };
    this.canvas.addEventListener("pointermove", move); this.canvas.addEventListener("pointerdown", move);
    this.canvas.addEventListener("pointerleave", () => { this.at = null; this.draw(); });
    this.canvas.addEventListener("keydown", e => { const d = { ArrowLeft: -0.01, ArrowRight: 0.01 }[e.key]; if (d) { e.preventDefault(); this.at = Math.min(1, Math.max(0, (this.at ?? 0.5) + d)); this.draw(); } });
  }
  draw() {
    const chart = this.chart, ratio = window.devicePixelRatio || 1, width = this.width = this.canvas.clientWidth || 480, height = 240, top = 10, bottom = height - 34;
    this.canvas.style.height = height + "px"; this.canvas.width = width * ratio; this.canvas.height = height * ratio;
    const g = this.canvas.getContext("2d"); g.scale(ratio, ratio); g.font = "11px system-ui, sans-serif";
    const up = y => chart.logarithmic ? Math.log10(y) : y, all = chart.curves.flatMap(c => c.points); if (!all.length) { this.caption.textContent = "no finite values"; return; }
    let [x0, x1] = all.reduce(([a, b], p) => [Math.min(a, p[0]), Math.max(b, p[0])], [Infinity, -Infinity]);
    let [y0, y1] = [...all.map(p => up(p[1])), ...chart.limits.map(l => up(l[1]))].reduce(([a, b], y) => [Math.min(a, y), Math.max(b, y)], [Infinity, -Infinity]);
    if (x1 <= x0) x1 = x0 + 1; const room = (y1 - y0) * 0.05 || Math.abs(y0) * 0.05 || 1; y0 -= room; y1 += room;
    const marks = ticks(y0, y1, 5), name = y => chart.logarithmic ? (Number.isInteger(+y.toFixed(6)) ? "1e" + Math.round(y) : "") : number(+y.toPrecision(12));
    const left = this.left = 12 + Math.max(...marks.map(y => g.measureText(name(y)).width)) + 14, right = width - 10;
    const X = x => left + (x - x0) / (x1 - x0) * (right - left), Y = y => bottom - (y - y0) / (y1 - y0) * (bottom - top);
    g.lineWidth = 1; g.fillStyle = ink("--faint"); g.strokeStyle = ink("--line"); g.textAlign = "right"; g.textBaseline = "middle";
    for (const y of marks) { g.beginPath(); g.moveTo(left, Y(y)); g.lineTo(right, Y(y)); g.stroke(); g.fillText(name(y), left - 5, Y(y)); }
    g.textAlign = "center"; g.textBaseline = "top"; for (const x of ticks(x0, x1, Math.max(2, width / 90)).filter(x => chart.across !== "iteration" || Number.isInteger(x))) { g.beginPath(); g.moveTo(X(x), bottom); g.lineTo(X(x), bottom + 4); g.stroke(); g.fillText(number(+x.toPrecision(12)), X(x), bottom + 6); }
    g.fillText(chart.across, (left + right) / 2, height - 12); g.save(); g.translate(9, (top + bottom) / 2); g.rotate(-Math.PI / 2); g.fillText(chart.up, 0, -7); g.restore();
    g.setLineDash([5, 4]); g.strokeStyle = ink("--bad"); for (const [label, value] of chart.limits) { const y = Y(up(value)); g.beginPath(); g.moveTo(left, y); g.lineTo(right, y); g.stroke(); g.textAlign = "right"; g.textBaseline = "bottom"; g.fillText(label, right, y - 1); } g.setLineDash([]);
    chart.curves.forEach((c, i) => { g.strokeStyle = COLOURS[i % COLOURS.length]; g.lineWidth = 1.6; g.beginPath(); c.points.forEach((p, k) => k ? g.lineTo(X(p[0]), Y(up(p[1]))) : g.moveTo(X(p[0]), Y(up(p[1])))); g.stroke(); });
    if (this.at === null) { this.caption.textContent = ""; return; }
    const x = x0 + this.at * (x1 - x0), near = c => c.points.reduce((b, p) => Math.abs(p[0] - x) < Math.abs(b[0] - x) ? p : b, c.points[0]);
    g.strokeStyle = ink("--faint"); g.beginPath(); g.moveTo(X(x), top); g.lineTo(X(x), bottom); g.stroke();
    this.caption.textContent = chart.across + " " + number(+x.toPrecision(4)) + ": " + chart.curves.filter(c => c.points.length).map(c => `${c.name} ${number(near(c)[1])}`).join(", ");
  }
}
