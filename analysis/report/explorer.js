// The figures that answer to the pointer, drawn by Vega: one of the labels of a scene, whose axes are chosen.
const MEASURES = {
  error: ["error, share of wrong answers", 1], false_negative: ["false negatives (missed pairs)", 1],
  false_positive: ["false positives", 1], recall: ["recall, share of meeting pairs found", 1],
  precision: ["precision, share of hits that are right", 1], matthews: ["Matthews' coefficient", 1],
  time_mean_ns: ["mean time per step (\u00b5s)", 1e-3], time_median_ns: ["median time per step (\u00b5s)", 1e-3],
  time_p95_ns: ["95th percentile of the time per step (\u00b5s)", 1e-3], setup_ns: ["set-up (\u00b5s)", 1e-3],
  memory_bytes: ["memory after set-up (KiB)", 1 / 1024],
  operations: ["elementary tests per step, each of its own kind", 1] };
const UPWARDS = new Set(["recall", "precision", "matthews"]); // more is better
const MARKS = { o: "circle", s: "square", "^": "triangle-up", v: "triangle-down", "<": "triangle-left", ">": "triangle-right",
  D: "diamond", d: "M0,-1L.6,0L0,1L-.6,0Z", X: "M-1,-.5L-.5,-1L0,-.5L.5,-1L1,-.5L.5,0L1,.5L.5,1L0,.5L-.5,1L-1,.5L-.5,0Z",
  P: "cross", "*": "M0,-1.2L.28,-.39L1.14,-.37L.46,.15L.71,.97L0,.48L-.71,.97L-.46,.15L-1.14,-.37L-.28,-.39Z",
  h: "M0,-1L.87,-.5L.87,.5L0,1L-.87,.5L-.87,-.5Z", H: "M-.5,-.87L.5,-.87L1,0L.5,.87L-.5,.87L-1,0Z",
  p: "M0,-1L.95,-.31L.59,.81L-.59,.81L-.95,-.31Z", 8: "M-.4,-1L.4,-1L1,-.4L1,.4L.4,1L-.4,1L-1,.4L-1,-.4Z" };
const shown = n => n === null || n === undefined ? "\u2013" : n !== 0 && (Math.abs(n) < 1e-3 || Math.abs(n) >= 1e6)
  ? n.toExponential(2) : Math.abs(n) >= 1000 ? Math.round(n).toLocaleString("en").replace(/,/g, "\u202f") : +n.toPrecision(3) + "";
// A colour that is seen on black too: dark ones are mixed with white there.
const seen = colour => { if (!root.classList.contains("dark")) return colour;
  const parts = [1, 3, 5].map(i => parseInt(colour.slice(i, i + 2), 16)), light = (.3 * parts[0] + .59 * parts[1] + .11 * parts[2]) / 255;
  return light > .4 ? colour : "#" + parts.map(p => Math.round(p + (255 - p) * (light < .1 ? .9 : .45)).toString(16).padStart(2, "0")).join(""); };
const element = (name, more = {}, ...inside) => { const made = Object.assign(document.createElement(name), more);
  made.append(...inside); return made; };

function explorer(place) {
  const { points, lines } = JSON.parse(place.dataset.points), hidden = new Set();
  const state = { x: "time_mean_ns", y: "error", xlog: true, ylog: true, only: "all", which: "", along: lines.length > 0, front: true };
  const known = name => points.some(point => point[name] !== null && point[name] !== undefined);
  const controls = place.querySelector(".controls"), drawn = place.querySelector(".drawn"), card = place.querySelector(".card");
  let view = null, zoomed = false;

  const choice = (text, name, options) => {
    const select = element("select", { name, ariaLabel: text }, ...options.map(([value, words]) =>
      element("option", { value, textContent: words, selected: state[name] === value })));
    select.addEventListener("change", () => { state[name] = select.value; hint(); draw(); });
    return element("label", {}, text, select);
  };
  const tick = (text, name) => {
    const box = element("input", { type: "checkbox", name, checked: state[name] });
    box.addEventListener("change", () => { state[name] = box.checked; draw(); });
    return element("label", {}, box, text);
  };
  const press = (text, act) => { const button = element("button", { type: "button", className: "chip", textContent: text });
    button.addEventListener("click", act); return button; };
  const measures = Object.keys(MEASURES).filter(known).map(name => [name, MEASURES[name][0]]);
  const distinct = name => [...new Set(points.map(point => point[name]))].filter(Boolean);
  const filters = [["all", "every label"]];
  if (points.some(p => p.nine) && !points.every(p => p.nine)) filters.push(["nine", "only the thesis's nine"]);
  if (distinct("promise").length > 1) for (const p of distinct("promise")) filters.push(["promise:" + p, "promise " + p]);
  if (distinct("language").length > 1) for (const p of distinct("language")) filters.push(["language:" + p, "in " + p]);
  if (points.some(p => p.false_negative === 0)) filters.push(["safe", "only what misses nothing"]);
  if (distinct("algorithm").length > 1) for (const p of distinct("algorithm")) filters.push(["algorithm:" + p, "only " + p]);
  const knobs = [...new Set(lines.map(line => line.knob))];
  for (const knob of knobs) filters.push(["knob:" + knob, "varies " + knob]);
  const swap = press("precision against recall", () => { Object.assign(state, { x: "recall", y: "precision", xlog: false, ylog: false }); sync(); draw(); });
  const back = press("error against time", () => { Object.assign(state, { x: "time_mean_ns", y: "error", xlog: true, ylog: true }); sync(); draw(); });
  controls.append(choice("up", "y", measures), choice("right", "x", measures), choice("show", "only", filters),
    tick("log up", "ylog"), tick("log right", "xlog"), tick("front", "front"), ...(lines.length ? [tick("lines along a knob", "along")] : []),
    press("+", () => zoom(.7)), press("\u2212", () => zoom(1.4)), press("whole", () => { zoomed = false; draw(); }), swap, back,
    press("PNG", () => view.toImageURL("png", 2).then(url => save(place.id + ".png", url))),
    press("SVG", () => view.toImageURL("svg").then(url => save(place.id + ".svg", url))),
    press("CSV", () => { const columns = Object.keys(points[0]);
      save(place.id + ".csv", csv([columns, ...filtered().map(p => columns.map(c => p[c] === null || p[c] === undefined ? "" : String(p[c])))]), "text/csv"); }));
  const all_marks = n => all(`[name=${n}]`, controls)[0];
  const sync = () => { for (const n of ["x", "y", "only"]) all_marks(n).value = state[n];
    for (const n of ["xlog", "ylog", "front", "along"]) if (all_marks(n)) all_marks(n).checked = state[n]; };
  const hint = () => { for (const [axis, log] of [["x", "xlog"], ["y", "ylog"]]) state[log] = !UPWARDS.has(state[axis]); sync(); };

  const passes = p => { const [kind, what] = [state.only.split(":")[0], state.only.slice(state.only.indexOf(":") + 1)];
    return kind === "all" || (kind === "nine" && p.nine) || (kind === "safe" && p.false_negative === 0) ||
      (kind === "knob" ? lines.some(l => l.knob === what && l.labels.includes(p.label)) : p[kind] === what); };
  const filtered = () => points.filter(passes);
  const at = (p, name) => p[name] === null || p[name] === undefined ? null : p[name] * MEASURES[name][1];

  function front(rows) {
    const sign = name => UPWARDS.has(name) ? -1 : 1, sx = sign(state.x), sy = sign(state.y);
    return rows.filter(a => !rows.some(b => sx * b.px <= sx * a.px && sy * b.py <= sy * a.py && (sx * b.px < sx * a.px || sy * b.py < sy * a.py)))
      .sort((a, b) => sx * (a.px - b.px) || sy * (a.py - b.py));
  }

  // A logarithmic axis has no 0: what is 0 stands on a strip of its own beyond a break, said in the axis' title.
  function axis(rows, name, log) {
    const values = rows.map(r => at(r, name)).filter(v => v !== null), over = values.filter(v => v > 0);
    if (!log || !over.length) return { type: "linear", zero: false, floor: null,
      domain: values.length ? [Math.min(0, ...values), Math.max(...values) || 1] : [0, 1] };
    const low = Math.min(...over), high = Math.max(...over), room = Math.max((high / low) ** .06, 1.06);
    const none = values.some(v => v <= 0), edge = low / room, floor = none ? edge / Math.max((high / low) ** .1, 1.05) : null;
    return { type: "log", floor, edge: none ? edge : null, domain: [floor ? floor / Math.max((high / low) ** .04, 1.02) : edge, high * room] };
  }

  function draw() {
    const rows = filtered().filter(p => !hidden.has(p.label)), dark = root.classList.contains("dark");
    const ink = dark ? "#ddd" : "#333", faint = dark ? "#3a3d42" : "#e3e3e3", width = Math.max(260, drawn.clientWidth || 600);
    const ax = axis(rows, state.x, state.xlog), ay = axis(rows, state.y, state.ylog);
    const put = (v, a) => v === null ? null : a.type === "log" && v <= 0 ? a.floor : v;
    const values = rows.map(p => ({ ...p, px: put(at(p, state.x), ax), py: put(at(p, state.y), ay) })).filter(p => p.px !== null && p.py !== null);
    const units = new Set(values.map(p => p.unit)), unlike = [state.x, state.y].includes("operations") && units.size > 1;
    const best = state.front && !unlike ? front(values) : [];
    for (const p of values) {
      p.text = describe(p); p.best = best.includes(p);
      p.fill = p.scope === "scene" ? (dark ? "#16181b" : "#fff") : seen(p.colour);
      p.stroke = seen(p.colour);
      p.shape = MARKS[p.mark] || "circle";
      const timed = state.x === "time_mean_ns" && p.time_mean_low_ns && p.time_mean_high_ns;
      p.low = timed ? p.time_mean_low_ns / 1e3 : p.px; p.high = timed ? p.time_mean_high_ns / 1e3 : p.px;
    }
    const place_of = new Map(values.map(p => [p.label, p]));
    const joined = state.along ? lines.flatMap((line, i) => line.labels.filter(l => place_of.has(l)).map(l =>
      ({ line: i, px: place_of.get(l).px, py: place_of.get(l).py, colour: place_of.get(l).stroke, label: l }))) : [];
    const broken = (a, words) => a.edge ? words + ", broken at //" : words;
    const title = (name, a, log) => broken(a, MEASURES[name][0] + (log && a.type === "log" ? ", log" : "")) + (unlike && name === "operations" ? " \u2014 kinds do not compare" : "");
    const ticks = a => a.type === "log" ? { values: steps(a.edge || a.domain[0], a.domain[1]) } : {};
    const rule = (a, across) => a.edge ? [{ type: "rule", clip: true, encode: { update: { ...(across
      ? { y: { scale: "y", value: a.edge }, x: { value: 0 }, x2: { signal: "width" } }
      : { x: { scale: "x", value: a.edge }, y: { value: 0 }, y2: { signal: "height" } }), stroke: { value: ink }, strokeDash: { value: [2, 5] } } } },
      { type: "text", encode: { update: { ...(across ? { y: { scale: "y", value: a.edge }, x: { value: -4 }, align: { value: "center" } }
        : { x: { scale: "x", value: a.edge }, y: { signal: "height + 4" }, align: { value: "center" } }), baseline: { value: "middle" }, text: { value: "//" }, fill: { value: ink }, fontWeight: { value: "bold" } } } },
      { type: "text", encode: { update: { ...(across ? { y: { scale: "y", value: a.floor }, x: { value: -7 }, align: { value: "right" }, baseline: { value: "middle" } }
        : { x: { scale: "x", value: a.floor }, y: { signal: "height + 15" }, align: { value: "center" } }), text: { value: "0" }, fill: { value: ink } } } }] : [];
    const zooming = (name, size, log) => ({ name: name + "dom", value: a0(name === "x" ? ax : ay), on: [
      { events: { signal: "zoom" }, update: `${log ? "zoomLog" : "zoomLinear"}(domain('${name}'), anchor ? anchor.${name} : null, zoom.by)` },
      { events: { signal: "moved" }, update: `${log ? "panLog" : "panLinear"}(moved.${name}dom, moved.${name} / ${size})` }] });
    const a0 = a => a.domain.slice();
    const spec = { width: width - 2, height: Math.min(460, Math.max(300, width * .62)), padding: 5, autosize: { type: "fit", contains: "padding" },
      background: dark ? "#16181b" : "#fff", description: MEASURES[state.y][0] + " against " + MEASURES[state.x][0],
      config: { axis: { labelColor: ink, titleColor: ink, gridColor: faint, domainColor: ink, tickColor: ink, labelFontSize: 12, titleFontSize: width < 460 ? 10 : 13, titleFontWeight: "normal" } },
      signals: [ { name: "focus", value: lit.now },
        { name: "anchor", value: null, on: [{ events: "wheel[event.ctrlKey || event.metaKey]", update: "{x: invert('x', x()), y: invert('y', y())}" }] },
        { name: "zoom", value: { by: 1 }, on: [{ events: "wheel![event.ctrlKey || event.metaKey]", force: true, update: "{by: pow(1.002, event.deltaY)}" }] },
        { name: "down", value: null, on: [{ events: "mousedown", update: "{x: x(), y: y(), xdom: domain('x'), ydom: domain('y')}" }] },
        { name: "moved", value: { x: 0, y: 0, xdom: ax.domain, ydom: ay.domain }, on: [{ events: "[mousedown, window:mouseup] > window:mousemove", update: "{x: down.x - x(), y: y() - down.y, xdom: down.xdom, ydom: down.ydom}" }] } ],
      data: [ { name: "points", values }, { name: "front", values: best }, { name: "joined", values: joined } ],
      scales: [ { name: "x", type: ax.type, range: "width", domain: ax.domain, domainRaw: { signal: "xdom" }, zero: false, nice: false, clamp: false },
        { name: "y", type: ay.type, range: "height", domain: ay.domain, domainRaw: { signal: "ydom" }, zero: false, nice: false } ],
      axes: [ { orient: "bottom", scale: "x", grid: true, title: title(state.x, ax, state.xlog), labelOverlap: true, tickCount: 6, ...ticks(ax), format: ax.type === "log" ? "~g" : "~g" },
        { orient: "left", scale: "y", grid: true, title: title(state.y, ay, state.ylog), labelOverlap: true, ...ticks(ay), format: "~g" } ],
      marks: [ ...rule(ay, true), ...rule(ax, false),
        { type: "group", clip: true, encode: { update: { width: { signal: "width" }, height: { signal: "height" } } }, marks: [
          { type: "line", from: { data: "front" }, aria: false, encode: { update: { x: { scale: "x", field: "px" }, y: { scale: "y", field: "py" }, interpolate: { value: UPWARDS.has(state.x) ? "step-before" : "step-after" },
            stroke: { value: ink }, strokeDash: { value: [5, 3] }, strokeWidth: { value: 1.2 } } } },
          { type: "group", from: { facet: { name: "one", data: "joined", groupby: "line" } }, marks: [ { type: "line", aria: false, from: { data: "one" },
            encode: { update: { x: { scale: "x", field: "px" }, y: { scale: "y", field: "py" }, stroke: { field: "colour" }, strokeOpacity: { value: .55 }, strokeWidth: { value: 1.5 } } } } ] },
          { type: "rule", from: { data: "points" }, aria: false, encode: { update: { x: { scale: "x", field: "low" }, x2: { scale: "x", field: "high" }, y: { scale: "y", field: "py" }, stroke: { field: "stroke" },
            strokeOpacity: { signal: "focus && focus !== datum.label ? .1 : .7" }, strokeWidth: { value: 1.4 } } } },
          { type: "symbol", name: "marks", from: { data: "points" }, encode: {
            enter: { shape: { field: "shape" }, description: { field: "text" }, cursor: { value: "pointer" } },
            update: { x: { scale: "x", field: "px" }, y: { scale: "y", field: "py" }, size: { signal: "focus === datum.label ? 230 : 95" }, fill: { field: "fill" }, stroke: { field: "stroke" }, strokeWidth: { value: 1.6 },
              opacity: { signal: "focus && focus !== datum.label ? .15 : 1" } } } },
          { type: "text", from: { data: "points" }, interactive: false, aria: false, encode: { update: { x: { scale: "x", field: "px" }, y: { scale: "y", field: "py", offset: -13 }, text: { field: "label" },
            align: { signal: "scale('x', datum.px) > width * .6 ? 'right' : 'left'" }, fill: { value: ink }, fontWeight: { value: "bold" }, fontSize: { value: 12 }, opacity: { signal: "focus === datum.label ? 1 : 0" } } } } ] } ] };
    spec.signals.push(zooming("x", "width", ax.type === "log"), zooming("y", "height", ay.type === "log"));
    if (view) view.finalize();
    drawn.replaceChildren();
    view = new vega.View(vega.parse(spec), { renderer: "svg", hover: true });
    view.initialize(drawn);
    view.addEventListener("mousemove", (event, item) => { const p = item && item.datum && item.datum.text ? item.datum : null;
      tell(p && p.text, event); highlight(p ? p.label : lit.pinned); });
    view.addEventListener("mouseout", () => { tell(null); highlight(lit.pinned); });
    view.addEventListener("click", (event, item) => { if (item && item.datum && item.datum.label && item.datum.text) pin(item.datum.label); });
    place.drawn = view.runAsync();
    place.view = view;
    legend();
  }
  const steps = (low, high) => { // the fewest round numbers that are three at least
    for (const set of [[1], [1, 3], [1, 2, 5], [1, 2, 3, 5, 7], [1, 2, 3, 4, 5, 6, 7, 8, 9], [...Array(90).keys()].map(n => 1 + n / 10)]) {
      const found = [];
      for (let d = Math.floor(Math.log10(low)); d <= Math.log10(high); d++) for (const s of set)
        if (s * 10 ** d >= low && s * 10 ** d <= high) found.push(+(s * 10 ** d).toPrecision(3));
      if (found.length > 2) return found;
    }
    return [low, high]; };
  const zoom = by => { view.signal("anchor", null).signal("zoom", { by }).runAsync(); };

  const describe = p => [`${p.label}${p.letter ? ` (${p.letter})` : ""}`,
    `error ${shown(p.error)}, recall ${shown(p.recall)}, precision ${shown(p.precision)}`,
    `${shown(p.false_negative)} missed, ${shown(p.false_positive)} false positives`,
    `mean ${shown(at(p, "time_mean_ns"))} \u00b5s${p.time_mean_low_ns ? ` (${shown(p.time_mean_low_ns / 1e3)} to ${shown(p.time_mean_high_ns / 1e3)})` : ""}, 95th percentile ${shown(at(p, "time_p95_ns"))} \u00b5s`,
    `${shown(p.operations)} ${p.unit} a step`, `promise ${p.promise}, ${p.language}${p.knobs ? "\n" + p.knobs : ""}`].join("\n");

  function legend() {
    const list = place.querySelector(".legend"), rows = filtered();
    list.replaceChildren(...rows.map(p => {
      const own = MARKS[p.mark] || "circle", path = document.createElementNS("http:" + "//www.w3.org/2000/svg", "svg");
      path.setAttribute("width", 14); path.setAttribute("height", 14); path.setAttribute("viewBox", "-1.4 -1.4 2.8 2.8"); path.setAttribute("aria-hidden", "true");
      const basic = { circle: "M-1,0A1,1,0,1,1,1,0A1,1,0,1,1,-1,0Z", square: "M-.9,-.9H.9V.9H-.9Z", "triangle-up": "M0,-1L1,.9H-1Z", "triangle-down": "M0,1L1,-.9H-1Z",
        "triangle-left": "M-1,0L.9,-1V1Z", "triangle-right": "M1,0L-.9,-1V1Z", diamond: "M0,-1L.8,0L0,1L-.8,0Z", cross: "M-.4,-1H.4V-.4H1V.4H.4V1H-.4V.4H-1V-.4H-.4Z" };
      const shape = document.createElementNS(path.namespaceURI, "path");
      shape.setAttribute("d", basic[own] || own);
      const colour = seen(p.colour);
      shape.setAttribute("fill", p.scope === "scene" ? "none" : colour); shape.setAttribute("stroke", colour); shape.setAttribute("stroke-width", .3);
      path.append(shape);
      const pick = element("button", { type: "button", className: "pick", title: "highlight" }, path, element("span", { textContent: p.label }));
      pick.setAttribute("aria-pressed", lit.pinned === p.label);
      pick.addEventListener("click", () => pin(p.label));
      pick.addEventListener("mouseenter", () => highlight(p.label));
      pick.addEventListener("mouseleave", () => highlight(lit.pinned));
      const off = hidden.has(p.label);
      const hide = element("button", { type: "button", className: "hide", textContent: off ? "show" : "hide", ariaLabel: `${off ? "show" : "hide"} ${p.label}` });
      hide.addEventListener("click", () => { if (off) hidden.delete(p.label); else hidden.add(p.label); draw(); });
      const item = element("li", { className: (off ? "hidden " : "") + (lit.now === p.label ? "on" : "") }, pick, hide);
      item.dataset.of = p.label;
      return item;
    }));
  }

  function about(label) {
    const p = points.find(each => each.label === label);
    card.hidden = !p;
    if (!p) return;
    card.replaceChildren(element("b", { textContent: p.label }), element("br"), ...describe(p).split("\n").slice(1).flatMap(line => [line, element("br")]));
    if (p.step !== null && p.step !== undefined) {
      const page = `${p.file}_step${p.step}.html#step=${p.step}&algorithm=${encodeURIComponent(p.name)}`;
      card.append(`Worst at `, element("a", { href: page, className: "worst", textContent: `step ${p.step}` }),
        `, ${shown(p.wrong)} wrong answers; the 3D page beside this one is made by `,
        element("code", { textContent: `scripts/analysis scene ${p.path} --step ${p.step} --algorithm ${p.name}` }), ".");
    }
  }

  place.hidden = false;
  about(null);
  addEventListener("lit", event => { if (view && place.clientWidth) view.signal("focus", event.detail).runAsync(); else if (view) view.signal("focus", event.detail);
    for (const item of all(".legend li", place)) item.classList.toggle("on", item.dataset.of === event.detail); });
  addEventListener("pinned", event => { about(event.detail);
    for (const item of all(".legend li", place)) item.querySelector(".pick").setAttribute("aria-pressed", item.dataset.of === event.detail); });
  let wide = 0;
  const resized = () => { if (place.clientWidth && drawn.clientWidth !== wide) { wide = drawn.clientWidth; draw(); } };
  for (const when of ["resize", "viewed"]) addEventListener(when, resized);
  addEventListener("painted", () => { if (place.clientWidth) draw(); else wide = 0; });
  resized();
}

if (typeof vega !== "undefined") all(".explorer").forEach(explorer);
paint(wish.matches);
follow();
