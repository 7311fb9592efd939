// The optimum as tables and sentences.
function element(kind, text, name) { const e = document.createElement(kind); if (text !== undefined) e.textContent = text; if (name) e.className = name; return e; }
function table(head, rows) {
  const t = element("table"), first = element("tr"); head.forEach(([text, name]) => first.append(element("th", text, name))); t.append(first);
  for (const row of rows) { const r = element("tr"); row.forEach(([content, name], k) => { const cell = element("td", undefined, name); cell.dataset.head = head[k]?.[0] ?? ""; content instanceof Node ? cell.append(content) : cell.textContent = content; r.append(cell); }); t.append(r); }
  const box = element("div", undefined, "scroll"); box.append(t); return box;
}
const withUnit = (x, unit) => number(x) + (unit && unit !== "1" ? " " + unit : "");
function bar(v) {
  const b = element("div", undefined, "bar"), place = x => `calc(${(100 * Math.min(1, Math.max(0, (x - v.lower) / (v.upper - v.lower)))).toFixed(2)}% - 2px)`;
  const start = element("i", undefined, "start"), end = element("i"); start.style.left = place(v.start); end.style.left = place(v.value); b.append(start, end);
  b.title = `from ${number(v.lower)} to ${number(v.upper)}; grey: start ${number(v.start)}, coloured: optimum ${number(v.value)}`; return b;
}
function optimumTables(o) {
  const all = [], sense = o.objective.sense === "maximise" ? "Maximised" : "Minimised", unit = o.objective.unit;
  const verdict = element("p", `${o.message[0].toUpperCase()}${o.message.slice(1)}.`, o.status === "converged" ? "good" : "bad"); verdict.id = "verdict"; all.push(verdict);
  const percent = 100 * (o.objective.value / o.start_objective - 1) * Math.sign(o.start_objective), change = o.start_objective ? ` (${percent > 0 ? "+" : ""}${percent.toFixed(1)} %)` : "";
  all.push(element("p", `${sense} ${o.objective.function}: ${o.start_objective === undefined ? "not known at the start" : number(o.start_objective)} → ${withUnit(o.objective.value, unit)}${change}` + (o.objective.estimated_error ? `, accurate to about ${withUnit(o.objective.estimated_error, unit)}.` : ".")));
  // What moving an active limit by about one per cent of it does, so that the first order holds; `slope` is d objective / d limit.
  const words = (slope, which, limit, ofLimit) => {
    const better = (slope > 0) === (o.objective.sense === "maximise"), step = limit ? Number(`1e${Math.round(Math.log10(Math.abs(limit) / 100))}`) : 1;
    return `raising the ${which} by ${withUnit(step, ofLimit)} ${slope > 0 ? "raises" : "lowers"} ${o.objective.function} by ${withUnit(step * Math.abs(slope), unit)}: ${better ? "a gain" : "a loss"} (to first order)`;
  };
  const ofBound = (name, v) => {
    const side = o.active_bounds[name], z = side && o.multipliers[side + "_bounds"]?.[name]; if (!z || v.lower === v.upper) return "";
    return words((side === "lower" ? 1 : -1) * (o.objective.sense === "maximise" ? -z : z), side + " bound", v[side], v.unit);
  };
  const variables = Object.entries(o.design);
  all.push(element("h2", "Design variables"), table([["variable"], ["start", "number"], ["optimum", "number"], ["unit"], ["between its bounds"], ["active"], ["what its bound costs"]], variables.slice(0, 200).map(([name, v]) => [[name], [number(v.start), "number"], [number(v.value), "number"], [v.unit ?? ""],
    [v.lower !== undefined && v.upper !== undefined && v.upper > v.lower ? bar(v) : `${v.lower === undefined ? "" : "≥ " + number(v.lower)} ${v.upper === undefined ? "" : "≤ " + number(v.upper)}`], [o.active_bounds[name] ? `${o.active_bounds[name]} bound` : ""], [ofBound(name, v), "wide"]])));
  if (variables.length > 200) all.push(element("p", `200 of ${variables.length} variables are shown.`, "faint"));
  const constraints = Object.entries(o.constraints);
  if (constraints.length) {
    const cost = c => {
      if (c.active === "inactive" || !c.multiplier) return "";
      const side = c.active.includes("upper") ? "upper" : "lower", both = c.lower !== undefined && c.upper !== undefined && c.lower !== c.upper;
      return words(c.multiplier, both ? side + " limit" : "limit", c[side], c.unit);
    };
    const sides = (c, x) => [[c.lower, x - c.lower], [c.upper, c.upper - x]].filter(([limit]) => limit !== undefined);
    const closest = (c, x) => sides(c, x).reduce((a, b) => b[1] < a[1] ? b : a, [0, Infinity]);
    const margin = c => {
      const [limit, room] = closest(c, c.value), text = withUnit(Math.abs(room), c.unit);
      return room < -1e-6 * Math.max(1, Math.abs(limit)) ? element("span", `violated by ${text}`, "bad") : c.active === "inactive" ? text : "active";
    };
    // Where the largest value is, and what an aggregate stands for, which may lie beyond a limit that the aggregate keeps.
    const where = c => {
      const a = c.aggregate, truth = a ? a.true_maximum : c.true_value, all = element("span", a ? [a.place, a.time === undefined ? "" : `t = ${number(a.time)} s`, ""].filter((x, i) => x || i === 2).join(", ") : "");
      if (truth === undefined) return all; const [, room] = closest(c, truth), beyond = room < -Math.max(a?.error ?? 0, 1e-9 * Math.abs(truth));
      all.append(`true value ${withUnit(truth, c.unit)}`); if (beyond) all.append(element("span", ` beyond the limit by ${withUnit(-room, c.unit)}`, "bad")); return all;
    };
    all.push(element("h2", "Constraints"), table([["constraint"], ["value", "number"], ["limits"], ["margin", "number"], ["est. error", "number"], ["worst at"], ["what it costs"]], constraints.slice(0, 200).map(([name, c]) => [[name], [withUnit(c.value, c.unit), "number"],
      [[c.lower === undefined ? "" : "≥ " + withUnit(c.lower, c.unit), c.upper === undefined ? "" : "≤ " + withUnit(c.upper, c.unit)].filter(x => x).join(", ")], [margin(c), "number"], [c.estimated_error === undefined ? "" : c.estimated_error.toExponential(1), "number"], [where(c), "wide"], [cost(c), "wide"]])));
    if (constraints.length > 200) all.push(element("p", `200 of ${constraints.length} constraints are shown.`, "faint"));
  }
  if (o.warnings?.length) { all.push(element("h2", "Warnings")); o.warnings.forEach(w => all.push(element("p", w, "bad"))); }
  return all;
}
function functionTable(functions) {
  return table([["function"], ["value", "number"], ["true extreme", "number"]], functions.slice(0, 200).map(f => [[f.name], [withUnit(f.value, f.unit), "number"], [f.true_maximum === undefined ? "" : withUnit(f.true_maximum, f.unit), "number"]]));
}
function recordTables(o) {
  const k = o.kkt.scaled, c = o.gradient_certificate, rows = [["stationarity: how far the gradient is from being balanced by multipliers", number(k.stationarity)], ["feasibility: how far a constraint is violated", number(k.feasibility)], ["complementarity: multipliers of constraints that are not active", number(k.complementarity)],
    ["certificate: largest difference of a gradient from the complex step, of itself", c === undefined ? "not made" : [c.start, c.optimum].map((own, i) => number(Math.max(0, ...Object.values(own.functions).map(f => f.difference ?? 0))) + [" at the start", " at the end"][i]).join(", ") + (c.passed ? "" : ": they differ")], ...Object.entries(o.counts).filter(([, n]) => n).map(([name, n]) => [name.replaceAll("_", " "), String(n)]), ...(o.integration ? [["method", `${o.integration.method}, ${o.integration.steps} steps (${o.integration.reason})`]] : []),
    ["problem file", `${o.problem.file}${o.problem.sha256 ? ", SHA-256 " + o.problem.sha256 : ""}`], ["version", o.version]];
  return table([["accuracy, work and origin"], [""]], rows.map(([a, b]) => [[a, "wide"], [b, "wide"]]));
}
