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
  const change = o.start_objective ? ` (${(100 * (o.objective.value / o.start_objective - 1) * Math.sign(o.start_objective)).toFixed(1)} %)` : "";
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
    const margin = c => [c.lower === undefined ? Infinity : c.value - c.lower, c.upper === undefined ? Infinity : c.upper - c.value].reduce((a, b) => Math.min(a, b));
    const where = c => c.aggregate ? [c.aggregate.place, c.aggregate.time === undefined ? "" : `t = ${number(c.aggregate.time)} s`].filter(x => x).join(", ") + `, true extreme ${number(c.aggregate.true_maximum)}` : "";
    all.push(element("h2", "Constraints"), table([["constraint"], ["value", "number"], ["limits"], ["margin", "number"], ["worst at"], ["what it costs"]], constraints.slice(0, 200).map(([name, c]) => [[name], [withUnit(c.value, c.unit), "number"],
      [[c.lower === undefined ? "" : "≥ " + number(c.lower), c.upper === undefined ? "" : "≤ " + number(c.upper)].filter(x => x).join(", ")], [c.active === "inactive" ? number(margin(c)) : "active", "number"], [where(c), "wide"], [cost(c), "wide"]])));
    if (constraints.length > 200) all.push(element("p", `200 of ${constraints.length} constraints are shown.`, "faint"));
  }
  if (o.warnings?.length) { all.push(element("h2", "Warnings")); o.warnings.forEach(w => all.push(element("p", w, "bad"))); }
  return all;
}
function recordTables(o) {
  const k = o.kkt.scaled, c = o.gradient_certificate, rows = [["stationarity: how far the gradient is from being balanced by multipliers", number(k.stationarity)], ["feasibility: how far a constraint is violated", number(k.feasibility)], ["complementarity: multipliers of constraints that are not active", number(k.complementarity)],
    ["certificate: gradients beside the complex step", c === undefined ? "not made" : c.passed ? "they agree" : "they differ"], ...Object.entries(o.counts).filter(([, n]) => n).map(([name, n]) => [name.replaceAll("_", " "), String(n)]), ...(o.integration ? [["method", `${o.integration.method}, ${o.integration.steps} steps (${o.integration.reason})`]] : []),
    ["problem file", `${o.problem.file}${o.problem.sha256 ? ", SHA-256 " + o.problem.sha256 : ""}`], ["version", o.version]];
  return table([["accuracy, work and origin"], [""]], rows.map(([a, b]) => [[a, "wide"], [b, "wide"]]));
}
