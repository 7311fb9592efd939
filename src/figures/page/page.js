// The page: one clock and one camera for all machines, tables, curves.
const data = JSON.parse(document.getElementById("data").textContent), main = document.getElementById("page");
main.replaceChildren(element("h1", data.name)); if (data.description) main.append(element("p", data.description, "faint"));
const [verdict, change, ...tables] = data.optimum ? optimumTables(data.optimum) : []; if (verdict) main.append(verdict, change);
if (data.optimum?.status === "converged") main.append(element("p", "A local optimum: the best in the valley of the start. --starts 4 seeks better ones from other starts.", "faint"));
if (!data.optimum && !data.stages.length) main.append(element("p", `${data.summary} The page is read again every two seconds; this state is of ${document.lastModified}.`));
const scenes = data.stages.map((stage, i) => new Scene(stage, i)), charts = data.charts.map((chart, i) => new LineChart(chart, i));
// The limits of constraints over the iterations.
for (const { chart } of charts) if (chart.title === "Constraints") for (const { name } of chart.curves) {
  const c = data.optimum?.constraints[name] ?? {}; for (const limit of new Set([c.lower, c.upper])) if (limit !== undefined && !chart.limits.some(l => l[1] === limit)) chart.limits.push([name, limit]);
}
// Designs beside each other have one scale: the box of all that mean the same, with or without flights.
function frame(box) {
  for (const s of scenes) {
    const alike = scenes.filter(o => o.stage.swings === s.stage.swings && o.stage.clock === s.stage.clock && JSON.stringify(o.stage.view) === JSON.stringify(s.stage.view));
    s.low = [0, 1, 2].map(i => Math.min(...alike.map(o => o[box][0][i]))); s.high = [0, 1, 2].map(i => Math.max(...alike.map(o => o[box][1][i])));
  }
}
frame("near");
const player = { share: 0, speed: 1, playing: false, last: 0 };
const moving = scenes.filter(s => s.stage.times.length > 1), length = s => s.stage.swings ? 1 : s.stage.times[s.stage.times.length - 1];
const longest = Math.max(0, ...moving.map(length)), real = moving.some(s => s.stage.clock === "t [s]");
const cameras = new Map(); for (const s of scenes) { const key = JSON.stringify(s.stage.view); if (!cameras.has(key)) cameras.set(key, new Camera(s.stage.view)); s.camera = cameras.get(key); }
const slider = element("input"), output = element("output"), play = element("button", "Play"), speed = element("select"), reset = element("button", "Reset view");
function show() {
  for (const s of scenes) s.draw(player.share * longest > length(s) && !s.stage.swings ? length(s) : player.share * longest, s.camera);
  slider.value = player.share; output.textContent = real ? `t = ${(player.share * longest).toPrecision(4)} s` : `${(100 * player.share).toFixed(0)} %`; slider.setAttribute("aria-valuetext", output.textContent);
}
function at(share) { player.share = Math.min(1, Math.max(0, share)); show(); }
function run(on) { player.playing = on; play.textContent = on ? "Pause" : "Play"; if (on) { if (player.share >= 1) player.share = 0; player.last = performance.now(); requestAnimationFrame(tick); } }
function tick(now) {
  if (!player.playing) return; const whole = real ? Math.max(longest, 0.2) : 2, share = player.share + (now - player.last) / 1000 * player.speed / whole; player.last = now;
  at(share >= 1 ? (real ? 1 : share % 1) : share); if (share >= 1 && real) run(false); else requestAnimationFrame(tick);
}
if (scenes.length) {
  main.append(element("h2", real ? "Motion" : "Structure"));
  if (moving.length) {
    slider.type = "range"; slider.min = 0; slider.max = 1; slider.step = "any"; slider.id = "time"; slider.setAttribute("aria-label", "time"); play.id = "play";
    for (const x of [0.01, 0.1, 0.25, 0.5, 1, 2, 5]) { const o = element("option", `× ${x}`); o.value = x; o.selected = x === 1; speed.append(o); } speed.setAttribute("aria-label", "speed");
    if (real && longest > 0 && longest < 2) { player.speed = speed.value = 0.25; }
    play.onclick = () => run(!player.playing); slider.oninput = () => { run(false); at(+slider.value); }; speed.onchange = () => player.speed = +speed.value;
    reset.onclick = () => { cameras.forEach(c => c.reset()); show(); };
    const controls = element("div", undefined, "controls"); controls.append(play, slider, output, speed, reset); main.append(controls);
  }
  const settings = element("div", undefined, "controls"), drawn = scenes.filter(s => s.stage.arrows.length), coloured = scenes.filter(s => s.stage.range && s.stage.label !== "h [mm]");
  if (drawn.length) {
    const most = Math.max(...drawn.flatMap(s => s.stage.arrows.flatMap(a => a.forces.map(e => Math.hypot(...e.slice(3)))))) || 1, box = element("input"), label = element("label", real ? " forces of joints (blue) and loads (red)" : " resultants of supports (blue) and loads (red)");
    box.type = "checkbox"; box.id = "forces"; label.prepend(box); box.onchange = () => { for (const s of drawn) { s.forces = box.checked; s.most = most; } show(); }; settings.append(label);
  }
  if (scenes.some(s => s.stage.flight.length)) {
    const box = element("input"), label = element("label", " the whole flight"); box.type = "checkbox"; box.id = "flight"; label.prepend(box);
    box.onchange = () => { cameras.forEach(c => c.reset()); frame(box.checked ? "far" : "near"); show(); }; settings.append(label);
  }
  if (coloured.length) {
    const own = coloured.map(s => s.stage.range), limit = (name, side) => {
      const field = element("input"), label = element("label", name + " "); field.type = "number"; field.step = "any"; field.id = "colour" + side; field.placeholder = number(own[0][side]); label.append(field);
      field.onchange = () => { coloured.forEach((s, i) => { s.stage.range = [...s.stage.range]; s.stage.range[side] = field.value === "" ? own[i][side] : +field.value; }); show(); }; settings.append(label);
    };
    limit("colours from", 0); limit("to", 1);
  }
  if (settings.childNodes.length) main.append(settings);
  const row = element("div", undefined, "scenes"); row.append(...scenes.map(s => s.figure)); main.append(row);
  // Bodies in their own colours; those in the colours of stress have a scale.
  const plain = s => s.bodies.filter(b => !(s.range && b.shape.values?.length)).map(b => b.name), names = [...new Set(data.stages.flatMap(s => s.bodies.map(b => b.name)))].filter(n => n && data.stages.some(s => plain(s).includes(n))), legend = element("div", undefined, "legend");
  const index = n => data.stages[0].bodies.findIndex(b => b.name === n);
  names.slice(0, 30).forEach(n => { const e = element("span", n); e.style.setProperty("--c", COLOURS[Math.max(0, index(n)) % COLOURS.length]); legend.append(e); });
  if (names.length > 30) legend.append(` and ${names.length - 30} more`);
  main.append(legend);
  main.append(element("p", "Drag turns, shift and drag moves, the wheel or two fingers zoom, a double click resets the view; keys: arrows turn, + and − zoom, 0 resets, the space bar plays. #t=0.4 in the address opens at 0.4 s.", "faint"));
  data.notes.forEach(n => main.append(element("p", n, "faint")));
}
for (const s of scenes) {
  const pointers = new Map(), c = s.canvas;
  c.addEventListener("pointerdown", e => { pointers.set(e.pointerId, [e.clientX, e.clientY]); c.setPointerCapture(e.pointerId); });
  const gone = e => pointers.delete(e.pointerId); c.addEventListener("pointerup", gone); c.addEventListener("pointercancel", gone);
  c.addEventListener("pointermove", e => {
    const before = pointers.get(e.pointerId); if (!before) return; const now = [e.clientX, e.clientY], d = [now[0] - before[0], now[1] - before[1]];
    if (pointers.size === 2) { const other = [...pointers].find(([id]) => id !== e.pointerId)[1], span = p => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1; s.camera.zoom *= span(now) / span(before); }
    else if (e.shiftKey) { s.camera.shift[0] += d[0] / s.scale; s.camera.shift[1] -= d[1] / s.scale; } else s.camera.turn(d[0] * 0.008, d[1] * 0.008);
    pointers.set(e.pointerId, now); show();
  });
  c.addEventListener("wheel", e => { e.preventDefault(); s.camera.zoom *= Math.exp(-e.deltaY * 0.0012); show(); }, { passive: false });
  c.addEventListener("dblclick", () => { s.camera.reset(); show(); });
  c.addEventListener("keydown", e => {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
    if (turns) s.camera.turn(turns[0] * 0.1, turns[1] * 0.1); else if (e.key === "+") s.camera.zoom *= 1.1; else if (e.key === "-") s.camera.zoom /= 1.1; else if (e.key === "0") s.camera.reset(); else if (e.key === " ") run(!player.playing); else return;
    e.preventDefault(); show();
  });
}
main.append(...tables);
if (data.functions?.length) main.append(element("h2", "Functions"), functionTable(data.functions));
if (charts.length) { main.append(element("h2", "Curves")); const row = element("div", undefined, "row"); row.append(...charts.map(c => c.figure)); main.append(row); }
if (data.optimum) {
  const file = element("details"); file.append(element("summary", "The problem as it was solved, with everything that was set on the command line"), element("pre", JSON.stringify(data.optimum.problem.document, null, 1)));
  main.append(element("h2", "Record"), recordTables(data.optimum), file);
}
if (data.document) { const file = element("details"); file.append(element("summary", "The problem as it was simulated"), element("pre", JSON.stringify(data.document, null, 1))); main.append(element("h2", "Problem"), file); }
if (data.summary && (data.optimum || data.stages.length)) { const pre = element("pre", data.summary); main.append(element("h2", "As the terminal shows it"), pre); }
main.append(element("p", `flexbody ${data.version}${data.made ? "; made by " + data.made : ""}`, "faint"));
// `#t=0.4` shows an instant [s].
const asked = /[#&]t=([-+.0-9e]+)/i.exec(location.hash); if (!real) player.share = 1;
if (asked && longest > 0) player.share = Math.min(1, Math.max(0, +asked[1] / longest));
const redraw = () => { show(); charts.forEach(c => c.draw()); }; redraw(); window.addEventListener("resize", redraw);
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
main.dataset.ready = "true";
