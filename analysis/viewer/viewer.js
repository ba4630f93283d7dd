// The page of a step: its state, its lists of right and wrong answers, and what buttons and keys do.
// Without WebGL the lists, the time line and the figures work all the same.
"use strict";

(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const $ = (id) => document.getElementById(id);

  // Okabe and Ito's colours, told apart by colour-blind readers; the letters and the dashes say the same.
  const KINDS = {
    fn: { sign: "FN", name: "false negative", many: "False negatives", color: 0xd55e00, about: "meet, but are missed" },
    fp: {
      sign: "FP",
      name: "false positive",
      many: "False positives",
      color: 0x0072b2,
      about: "reported, but do not meet",
    },
    inside: {
      sign: "in",
      name: "contained",
      many: "Contained",
      color: 0xb0588c,
      about: "one wholly inside the other; not scored",
    },
    tp: { sign: "TP", name: "true positive", many: "True positives", color: 0x009e73, about: "meet, and are reported" },
  };
  const NONE = 0xb9c0c9;
  const MOST_ROWS = 300;

  const { key, keys, truth, contained, algorithms, poses, meshes, turned, body, toDrawn, answers } = decoded(data);
  const radius = (body) => meshes[data.bodies[body].mesh].radius;
  const name = (body) => data.bodies[body].name;
  const listed = data.containment === "record" ? ["fn", "fp", "inside", "tp"] : ["fn", "fp", "tp"];

  // x y z of the middle of the body's mesh, in drawn coordinates (data.unit metres about data.centre); null when it is
  // not there.
  function place(body, k = state.k) {
    const i = 7 * (k * data.bodies.length + body);
    return isFinite(poses[i + 4]) && isFinite(poses[i]) ? [poses[i + 4], poses[i + 5], poses[i + 6]] : null;
  }

  function turn(body, v, k = state.k) {
    const i = 7 * (k * data.bodies.length + body);
    return turned(poses.subarray(i, i + 4), v);
  }

  // The body as measure() takes it.
  function solid(body) {
    const { vertices, index } = meshes[data.bodies[body].mesh],
      p = place(body),
      seen = new Map();
    const vertex = (i) => {
      if (!seen.has(i))
        seen.set(
          i,
          turn(body, vertices.subarray(3 * i, 3 * i + 3)).map((x, c) => x + p[c]),
        );
      return seen.get(i);
    };
    return { index, vertex };
  }

  // ---- state

  const state = {
    k: data.step - data.first,
    algorithm: Math.max(
      0,
      data.algorithms.findIndex((a) => a.label === data.chosen),
    ),
    chosen: null, // null, [body] or [a, b]
    through: data.bodies.map((body) => body.big), // drawn see-through
    edges: false,
    quiet: false,
    sees: true,
    playing: false,
  };
  let now = answers(state.k, algorithms[state.algorithm]);
  let measured = null; // of the chosen pair at this step
  let seen = null; // what the algorithm compares of it, as sees.compare() tells it

  const step = () => data.first + state.k;
  const algorithm = () => algorithms[state.algorithm];

  // body -> its gravest kind
  function bodyKinds() {
    const kind = new Map();
    for (const k of ["tp", "inside", "fp", "fn"]) for (const pair of now[k]) for (const body of pair) kind.set(body, k);
    return kind;
  }

  function kindOf(pair) {
    const wanted = key(pair);
    return listed.find((kind) => now[kind].some((p) => key(p) === wanted)) || null;
  }

  // ---- elements

  function element(tag, attributes = {}, ...children) {
    const made = document.createElement(tag);
    for (const [k, v] of Object.entries(attributes))
      k.startsWith("on") ? made.addEventListener(k.slice(2), v) : made.setAttribute(k, v);
    made.append(...children);
    return made;
  }
  const sign = (kind) => element("span", { class: "sign " + (kind || "none") }, kind ? KINDS[kind].sign : "");
  const number = (x) => sees.digits(x, 6);

  function row(pair, kind, text) {
    const attributes = { "data-pair": key(pair), onclick: () => choose(pair, true) };
    if (state.chosen && state.chosen.length === 2 && key(state.chosen) === key(pair))
      attributes["aria-current"] = "true";
    return element("li", {}, element("button", attributes, sign(kind), text));
  }

  const open = { fn: true, fp: true, inside: true, tp: false };
  function showLists() {
    const focused = document.activeElement && document.activeElement.getAttribute("data-pair");
    const inside = keys(contained.at(state.k));
    $("lists").replaceChildren(
      ...listed.map((kind) => {
        const pairs = now[kind],
          details = element("details", open[kind] ? { open: "" } : {});
        details.addEventListener("toggle", () => {
          if (open[kind] === details.open) return;
          open[kind] = details.open; // the rows of a closed list are not made: they cost most of a step
          showLists();
        });
        details.append(element("summary", {}, sign(kind), `${KINDS[kind].many}: ${pairs.length}`));
        if (!open[kind]) return details;
        if (!pairs.length)
          details.append(
            element(
              "div",
              { class: "soft" },
              `no pairs that ${kind === "fp" || kind === "inside" ? "are " : ""}${KINDS[kind].about}`,
            ),
          );
        const reported = kind === "inside" && algorithm() ? keys(algorithm().inside.at(state.k)) : null;
        const note = (p) =>
          reported
            ? reported.has(key(p))
              ? " (reported)"
              : " (not reported)"
            : inside.has(key(p))
              ? " (one inside the other)"
              : "";
        details.append(
          element(
            "ul",
            {},
            ...pairs.slice(0, MOST_ROWS).map((p) => row(p, kind, `${name(p[0])} – ${name(p[1])}${note(p)}`)),
          ),
        );
        if (pairs.length > MOST_ROWS)
          details.append(element("div", { class: "soft" }, `and ${pairs.length - MOST_ROWS} more`));
        return details;
      }),
    );
    if (focused) {
      const again = $("lists").querySelector(`[data-pair="${focused}"]`);
      if (again) again.focus({ preventScroll: true });
    }
  }

  function table(rows) {
    return element(
      "table",
      {},
      ...rows.map(([what, value]) => element("tr", {}, element("td", {}, what), element("td", {}, value))),
    );
  }

  function showChosen() {
    const box = $("chosen");
    if (!state.chosen) return box.replaceChildren();
    if (state.chosen.length === 1) return box.replaceChildren(...aboutBody(state.chosen[0]));
    box.replaceChildren(...aboutPair(state.chosen));
  }

  function aboutBody(body) {
    const { mesh, fixed, born } = data.bodies[body],
      at = place(body);
    const rows = [
      ["mesh", `${meshes[mesh].name}, ${meshes[mesh].index.length / 3} triangles`],
      ["body", `number ${body}${fixed ? ", fixed" : ""}`],
    ];
    if (at) {
      const off = turn(body, meshes[mesh].centre); // the pose's position is that of the mesh's origin
      rows.push(["position", at.map((x, c) => number(x * data.unit + data.centre[c] - off[c])).join("  ") + " m"]);
    } else rows.push(["position", born < 0 || step() < born ? "not born yet" : "lost: the motion failed"]);
    if (born > 0) rows.push(["born", `at step ${born}`]);
    if (at && algorithm() && state.sees && sees.what(algorithm().name))
      rows.push(["drawn", sees.what(algorithm().name)]);
    const partners = listed.flatMap((kind) => now[kind].filter((p) => p.includes(body)).map((p) => [p, kind]));
    return [
      element("strong", {}, name(body)),
      table(rows),
      element(
        "div",
        { class: "soft" },
        partners.length
          ? `In ${partners.length} pair${partners.length > 1 ? "s" : ""} at this step, with:`
          : "In no pair at this step.",
      ),
      element(
        "ul",
        {},
        ...partners.slice(0, MOST_ROWS).map(([p, kind]) => row(p, kind, name(p[0] === body ? p[1] : p[0]))),
      ),
      element(
        "div",
        { class: "row" },
        element("button", { onclick: () => fly([body]) }, "Come near"),
        throughButton(body),
        letGo(),
      ),
    ];
  }

  const letGo = () => element("button", { onclick: () => choose(null) }, "Let go");
  function throughButton(body) {
    return element(
      "button",
      { "aria-pressed": String(state.through[body]), onclick: () => seeThrough(body) },
      "See through",
    );
  }

  function aboutPair(pair) {
    const kind = kindOf(pair),
      [a, b] = pair,
      rows = [];
    const here = place(a) && place(b),
      asked = isAsked(pair);
    const head = element(
      "div",
      { style: "display:flex;gap:7px;align-items:center" },
      sign(kind),
      element("strong", {}, `${name(a)} – ${name(b)}`),
    );
    const met = keys(truth.at(state.k)).has(key(pair)),
      within = keys(contained.at(state.k)).has(key(pair));
    rows.push([
      "truth",
      !here
        ? "not both are there at this step"
        : !asked
          ? "not asked about: " +
            (pair.every((b) => data.bodies[b].fixed) ? "two fixed bodies are no pair" : "neither body was chosen")
          : within
            ? "one lies inside the other"
            : met
              ? "they meet"
              : "they do not meet",
    ]);
    if (measured && measured.pairs) {
      const crossing = measured.pairs === 1 ? "1 pair of triangles crosses" : `${measured.pairs} pairs of triangles cross`;
      rows.push(["surfaces", `${crossing}, drawn bold`]);
      const { out } = measured;
      if (out)
        rows.push([
          "depth",
          `at most ${sees.digits(out.distance * data.unit, 3)} m: ${name(a)} moved so far along ` +
            `(${out.direction.map((x) => +x.toFixed(3) + 0).join(", ")}) is out`,
        ]);
    } else if (measured && measured.gap)
      rows.push([
        "surfaces",
        `${number(measured.gap.distance * data.unit)} m apart${within ? " (inside)" : ""}, drawn bold`,
      ]);
    return [
      head,
      table(rows),
      ...(here && asked ? [...why(pair, met), everyone(pair, met)] : []),
      element(
        "div",
        { class: "row" },
        element("button", { onclick: () => fly(pair) }, "Come near"),
        element("button", { onclick: () => choose([a]) }, name(a)),
        element("button", { onclick: () => choose([b]) }, name(b)),
        letGo(),
      ),
    ];
  }

  const isAsked = ([a, b]) =>
    !(data.bodies[a].fixed && data.bodies[b].fixed) && (data.bodies[a].asked || data.bodies[b].asked);

  // What an algorithm of the file says of a pair at this step, and of what kind that is when it is wrong.
  function says(one, pair, met) {
    const has = (list) => keys(list.at(state.k)).has(key(pair));
    const invented = has(one.fp),
      missed = has(one.fn);
    return { hit: invented || has(one.inside) || (met && !missed), wrong: invented ? "fp" : missed ? "fn" : null };
  }

  const verb = (hit) => (hit ? "reports it" : "is silent");

  // Why the chosen algorithm says so.
  function why(pair, met) {
    const one = algorithm();
    if (!one || !seen) return [];
    const { hit, wrong } = says(one, pair, met);
    const filter = seen.filter;
    let because = seen.because;
    if (seen.stopped) because = `because its prefilter ${filter.name} is: ${filter.answer.because}`;
    const made = element(
      "div",
      { class: "why" },
      element("strong", {}, one.label, " ", verb(hit), " ", wrong ? sign(wrong) : ""),
    );
    made.append(element("div", {}, because));
    if (seen.hit !== null && seen.hit !== hit)
      made.append(
        element(
          "div",
          { class: "soft" },
          `Computed again here it ${seen.hit ? "would report it" : "would be silent"}: the comparison is decided by the ` +
            "last bits of its numbers, or by what this page does not have.",
        ),
      );
    if (state.sees && (sees.what(one.name) || meshes.some((mesh) => mesh.proxies[one.label])))
      made.append(
        element(
          "div",
          { class: "soft drawn" },
          `Drawn: ${sees.what(one.name) || "what stands for the meshes"}, `,
          element("span", { class: "key first" }),
          ` of ${name(pair[0])}, `,
          element("span", { class: "key second" }),
          ` of ${name(pair[1])}${seen.stopped ? `, thin what ${filter.name} compares` : ""}; `,
          element("span", { class: "key decides" }),
          " what decides.",
        ),
      );
    if (filter)
      made.append(
        table([
          [`${filter.name} first`, `${verb(filter.answer.hit !== false)}: ${filter.answer.because}`],
          ...(seen.stopped ? filter.answer.rows : []),
        ]),
      );
    const own = seen.stopped
      ? [
          [
            `${one.label} alone`,
            seen.own === null ? seen.because : `would ${seen.own ? "report it" : "be silent"}: ${seen.because}`,
          ],
        ]
      : [];
    if (own.length || seen.rows.length) made.append(table([...own, ...seen.rows]));
    return [made];
  }

  // What every algorithm says, in two lines however many there are; a click goes to it.
  function everyone(pair, met) {
    const said = algorithms.map((one, i) => ({ one, i, ...says(one, pair, met) }));
    const chips = (hit) =>
      element(
        "span",
        { class: "chips" },
        ...said
          .filter((each) => each.hit === hit)
          .map(({ one, i, wrong }) =>
            element(
              "button",
              {
                class: "chip",
                "data-says": hit ? "reports" : "silent",
                "aria-pressed": String(i === state.algorithm),
                onclick: () => setAlgorithm(i),
              },
              one.label,
              wrong ? sign(wrong) : "",
            ),
          ),
      );
    const count = said.filter((each) => each.hit).length;
    return table([
      [`report it: ${count}`, chips(true)],
      [`are silent: ${said.length - count}`, chips(false)],
    ]);
  }

  // ---- time

  function go(k) {
    state.k = Math.min(data.count - 1, Math.max(0, Math.round(k)));
    say();
    update();
  }

  const WORDS = { fn: "false negative", fp: "false positive" };

  // To the next step (direction 1) or the last one (-1) with a wrong answer of the kinds; beyond the page it says where.
  function goWrong(direction, kinds = ["fn", "fp"]) {
    if (!algorithm()) return;
    for (let k = state.k + direction; k >= 0 && k < data.count; k += direction)
      if (kinds.some((kind) => algorithm()[kind].count(k))) return go(k);
    const whole = data.whole[algorithm().label];
    const beyond = kinds
      .map((kind) => (whole ? whole[kind][direction > 0 ? "behind" : "before"] : null))
      .filter((step) => step !== null);
    const which = `${direction > 0 ? "next" : "previous"} ${kinds.length > 1 ? "wrong answer" : WORDS[kinds[0]]}`;
    if (beyond.length) elsewhere(`The ${which}`, direction > 0 ? Math.min(...beyond) : Math.max(...beyond));
    else say(`There is no ${which} of ${algorithm().label}.`);
  }

  const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replace(/'/g, `'"'"'`)}'`);
  const command = (step) =>
    `${data.command} --step ${step}` + (algorithm() ? ` --algorithm ${quoted(algorithm().label)}` : "");
  const held = (step) => step >= data.first && step < data.first + data.count;

  function elsewhere(what, step) {
    say(`${what} is at step ${step}, which this page does not hold: `, element("code", {}, command(step)));
  }

  function say(...words) {
    $("beyond").replaceChildren(...words);
  }

  let timer = 0;
  function play(on) {
    state.playing = on;
    $("play").textContent = on ? "❚❚ Pause" : "▶ Play";
    cancelAnimationFrame(timer);
    if (!on) return;
    if (state.k === data.count - 1) go(0);
    const from = state.k,
      start = performance.now(),
      pace = (Number($("speed").value) * data.rate) / 1000;
    const tick = (time) => {
      const k = Math.min(data.count - 1, from + Math.floor(Math.max(0, time - start) * pace));
      if (k !== state.k) go(k);
      if (k === data.count - 1) return play(false);
      timer = requestAnimationFrame(tick);
    };
    timer = requestAnimationFrame(tick);
  }

  // False negatives upwards, false positives downwards, one column a step.
  function showStrip() {
    const canvas = $("strip"),
      ratio = window.devicePixelRatio || 1,
      width = canvas.clientWidth,
      height = canvas.clientHeight;
    canvas.width = Math.max(1, width * ratio);
    canvas.height = Math.max(1, height * ratio);
    const draw = canvas.getContext("2d");
    draw.scale(ratio, ratio);
    const style = getComputedStyle(document.body),
      color = (property) => style.getPropertyValue(property).trim();
    draw.fillStyle = color("--ground");
    draw.fillRect(0, 0, width, height);
    const column = width / data.count,
      middle = height / 2;
    draw.fillStyle = color("--mark");
    draw.fillRect(state.k * column, 0, Math.max(column, 2), height);
    for (const [kind, direction] of [
      ["fn", -1],
      ["fp", 1],
    ]) {
      if (!algorithm()) break;
      let most = 0;
      for (let k = 0; k < data.count; ++k) most = Math.max(most, algorithm()[kind].count(k));
      draw.fillStyle = "#" + KINDS[kind].color.toString(16).padStart(6, "0");
      for (let k = 0; k < data.count; ++k) {
        const count = algorithm()[kind].count(k);
        if (!count) continue;
        const tall = Math.max(1.5, (count / most) * (middle - 2));
        draw.fillRect(
          k * column,
          direction < 0 ? middle - tall : middle,
          Math.max(column - (column > 4 ? 1 : 0), 1),
          tall,
        );
      }
      const text = `${KINDS[kind].sign}, at most ${most}`,
        y = direction < 0 ? 0 : height - 14;
      draw.font = "11px sans-serif";
      draw.fillStyle = color("--paper");
      draw.fillRect(0, y, draw.measureText(text).width + 8, 14);
      draw.fillStyle = color("--ink");
      draw.fillText(text, 4, y + 11);
    }
    draw.fillStyle = color("--ink");
    draw.fillRect(0, middle - 0.25, width, 0.5);
    draw.fillRect(state.k * column + column / 2 - 0.75, 0, 1.5, height);
  }

  // ---- all that follows from the state

  function update() {
    now = answers(state.k, algorithm());
    measured = seen = null;
    if (state.chosen && state.chosen.length === 2 && state.chosen.every((b) => place(b))) {
      measured = measure(...state.chosen.map(solid));
      if (algorithm()) seen = compared(algorithm(), state.chosen);
    }
    $("slider").value = step();
    $("slider").setAttribute(
      "aria-valuetext",
      `step ${step()}, ${now.fn.length} false negatives, ${now.fp.length} false positives`,
    );
    $("now").textContent = `step ${step()} of ${data.steps - 1} · ${(step() / data.rate).toFixed(3)} s`;
    showLists();
    showChosen();
    showStrip();
    if (picture) picture.update();
    const parts = [
      `step=${step()}`,
      ...(algorithm() ? [`algorithm=${encodeURIComponent(algorithm().label)}`] : []),
      ...(state.chosen ? [`chosen=${state.chosen.join("-")}`] : []),
    ];
    try {
      history.replaceState(null, "", "#" + parts.join("&"));
    } catch (refused) {} // a browser may refuse it to local files, or to fast playing; the page does not need it
  }

  const there = (k = state.k) => data.bodies.map((_, b) => body(b, k) || undefined);

  function compared(one, [a, b], all = there(), short = false) {
    return sees.compare(one.name, one.given, all[a], all[b], { all, label: one.label, short });
  }

  // What the algorithm sees of a body, as sees.view() tells it; and what its prefilter sees, where that stopped the pair.
  function viewed(b) {
    const one = algorithm(),
      here = body(b, state.k);
    if (!one || !here) return [{}, {}];
    const stopped = seen && seen.stopped;
    return [sees.view(one.name, one.given, here, one.label), stopped ? sees.view(seen.filter.name, {}, here) : {}];
  }

  function choose(bodies, near = false) {
    state.chosen = bodies;
    update();
    if (near && bodies) fly(bodies);
  }

  function fly(bodies) {
    if (picture) picture.fly(bodies);
  }

  function seeThrough(body) {
    state.through[body] = !state.through[body];
    update();
  }

  function pressed(id, on) {
    $(id).setAttribute("aria-pressed", String(on));
  }

  function showAlgorithm() {
    const one = algorithm(),
      whole = one && data.whole[one.label];
    const box = $("whole");
    box.replaceChildren();
    if (!one) return box.append("The file has no algorithms: all pairs shown are the truth.");
    const knobs =
      one.knobs && one.knobs !== "{}" ? one.knobs.replace(/[{}"]/g, "").replace(/,/g, ", ").replace(/:/g, " ") : "";
    box.append(
      [
        one.name !== one.label ? one.name : "",
        knobs,
        one.promise && one.promise !== "none" ? `promises: ${one.promise}` : "",
      ]
        .filter(Boolean)
        .join("; "),
    );
    if (!whole) return;
    const far = new Set();
    const link = (kind, step, text) => {
      if (!held(step)) far.add(step);
      const act = () => (play(false), held(step) ? showFirst(kind, step) : elsewhere(`That ${WORDS[kind]}`, step));
      return element("button", { class: "small", "data-step": step, onclick: act }, text);
    };
    for (const kind of ["fn", "fp"]) {
      const { total, first, most, many } = whole[kind];
      const line = element("div", { class: "row" }, sign(kind), `${total.toLocaleString("en")} in the whole run`);
      if (first !== null)
        line.append(
          link(kind, first, first === most ? `first and most, ${many}: step ${first}` : `first: step ${first}`),
        );
      if (first !== most) line.append(link(kind, most, `most, ${many}: step ${most}`));
      box.append(line);
    }
    if (!far.size) return;
    const lines = [...far].sort((p, q) => p - q).map((step) => element("code", {}, command(step)));
    box.append(
      element(
        "details",
        {},
        element(
          "summary",
          {},
          `Not in this page: step${far.size > 1 ? "s" : ""} ${[...far].sort((p, q) => p - q).join(", ")}`,
        ),
        ...lines,
      ),
    );
  }

  // Goes to a step and to its first pair of the kind.
  function showFirst(kind, step) {
    go(step - data.first);
    if (now[kind].length) choose(now[kind][0], true);
  }

  // ---- the page

  let picture = null;
  try {
    picture = makePicture({
      data,
      meshes,
      poses,
      state,
      KINDS,
      NONE,
      listed,
      place,
      radius,
      name,
      kindOf,
      bodyKinds,
      choose,
      now: () => now,
      measured: () => measured,
      seen: () =>
        state.sees && state.chosen ? { bodies: state.chosen.map(viewed), marks: seen ? seen.marks : {} } : null,
      toDrawn,
      contained: () => contained.at(state.k),
    });
    $("message").hidden = true;
    $("legend").hidden = $("tools").hidden = false;
  } catch (failed) {
    console.info("no picture: " + failed.message);
    $("message").textContent =
      "This browser or machine offers no WebGL, which the picture needs. The lists and the time line work without.";
  }

  let up = "y";
  const actions = {
    frame: () => picture && picture.all(),
    edges: () => (pressed("edges", (state.edges = !state.edges)), update()),
    sees: () => (pressed("sees", (state.sees = !state.sees)), update()),
    quiet: () => (pressed("quiet", (state.quiet = !state.quiet)), update()),
    up: () => {
      up = up === "y" ? "z" : "y";
      $("up").textContent = up + " up";
      if (picture) (picture.setUp(up), picture.all());
    },
    back: () => go(state.k - 1),
    forth: () => go(state.k + 1),
    play: () => play(!state.playing),
    previous_fn: () => goWrong(-1, ["fn"]),
    next_fn: () => goWrong(1, ["fn"]),
    previous_fp: () => goWrong(-1, ["fp"]),
    next_fp: () => goWrong(1, ["fp"]),
  };
  for (const [id, act] of Object.entries(actions)) $(id).addEventListener("click", act);
  for (const id of ["back", "forth", "previous_fn", "next_fn", "previous_fp", "next_fp"])
    $(id).addEventListener("click", () => play(false));
  $("speed").addEventListener("change", () => state.playing && play(true));

  function setAlgorithm(index) {
    if (!algorithms.length) return;
    state.algorithm = (index + algorithms.length) % algorithms.length;
    $("algorithm").value = state.algorithm;
    showAlgorithm();
    update();
  }

  function nextPair(direction) {
    const pairs = listed.flatMap((kind) => (open[kind] ? now[kind] : []));
    if (!pairs.length) return;
    const at =
      state.chosen && state.chosen.length === 2
        ? pairs.findIndex((p) => key(p) === key(state.chosen))
        : direction > 0
          ? -1
          : 0;
    choose(pairs[(at + direction + pairs.length) % pairs.length], true);
    const shown = $("lists").querySelector("[aria-current]");
    if (shown) shown.scrollIntoView({ block: "nearest" });
  }

  document.addEventListener("keydown", (e) => {
    const inField = /^(SELECT|INPUT)$/.test(e.target.tagName);
    if (e.ctrlKey || e.metaKey || e.altKey || (inField && e.key !== "Escape")) return;
    const jump = e.shiftKey ? 10 : 1;
    const act = {
      ArrowLeft: () => (play(false), go(state.k - jump)),
      ArrowRight: () => (play(false), go(state.k + jump)),
      Home: () => go(0),
      End: () => go(data.count - 1),
      " ": e.target.tagName === "BUTTON" || e.target.tagName === "SUMMARY" ? null : actions.play,
      Escape: () => choose(null),
      p: () => goWrong(-1),
      n: () => goWrong(1),
      m: () => goWrong(e.shiftKey ? -1 : 1, ["fn"]),
      i: () => goWrong(e.shiftKey ? -1 : 1, ["fp"]),
      w: actions.sees,
      j: () => nextPair(1),
      k: () => nextPair(-1),
      a: () => setAlgorithm(state.algorithm + jump),
      f: actions.frame,
      e: actions.edges,
      q: actions.quiet,
      u: actions.up,
      h: () => state.chosen && state.chosen.forEach(seeThrough),
    }[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (!act) return;
    e.preventDefault();
    act();
  });

  $("slider").min = data.first;
  $("slider").max = data.first + data.count - 1;
  $("slider").addEventListener("input", () => (play(false), go(Number($("slider").value) - data.first)));
  const seek = (e) => e.buttons && (play(false), go(Math.floor((e.offsetX / $("strip").clientWidth) * data.count)));
  $("strip").addEventListener("pointerdown", seek);
  $("strip").addEventListener("pointermove", seek);
  window.addEventListener("resize", showStrip);

  $("title").textContent = data.title || data.file;
  $("about").textContent =
    `${data.file}: ${data.bodies.length} bodies, steps ${data.first} to ${data.first + data.count - 1} of 0 to ` +
    `${data.steps - 1}, ${data.rate} a second; digest ${data.digest.slice(0, 12)}…`;
  algorithms.forEach((a, i) => $("algorithm").append(element("option", { value: i }, a.label)));
  $("algorithm").disabled = !algorithms.length;
  $("algorithm").addEventListener("change", () => setAlgorithm(Number($("algorithm").value)));
  $("legend").append(
    ...listed.map((kind) =>
      element(
        "div",
        {},
        sign(kind),
        element("span", {}, KINDS[kind].name, element("span", { class: "more" }, `: ${KINDS[kind].about}`)),
      ),
    ),
    element("div", {}, sign(null), "in no pair"),
  );

  // A link to a moment: #step=420&algorithm=obb_sat&chosen=3-17. Read when the page opens and when its address changes.
  function follow() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const known = algorithms.findIndex((a) => a.label === wanted.get("algorithm"));
    if (known >= 0) state.algorithm = known;
    if (algorithms.length) $("algorithm").value = state.algorithm;
    const asked = wanted.get("step") ? Number(wanted.get("step")) : NaN;
    if (held(asked)) state.k = Math.floor(asked) - data.first;
    const picked = (wanted.get("chosen") || "").split("-").filter(Boolean).map(Number);
    const right = (picked.length === 1 || picked.length === 2) && picked.every((b) => data.bodies[b]);
    state.chosen = right ? picked.sort((p, q) => p - q) : null;
    say();
    if (asked >= 0 && asked < data.steps && !held(asked)) elsewhere("What the address asks for", Math.floor(asked));
    showAlgorithm();
    update();
    if (state.chosen) fly(state.chosen);
  }
  window.addEventListener("hashchange", follow);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", update);
  follow();

  // For tests: every pair that is asked about at a step, for every algorithm that sees.js knows: how many were compared,
  // and those for which it says otherwise than the file.
  function recount(step) {
    const k = step - data.first,
      all = there(k),
      met = keys(truth.at(k)),
      wrong = [];
    let count = 0;
    for (const one of algorithms) {
      if (!sees.what(one.name) && !meshes.some((mesh) => mesh.proxies[one.label])) continue;
      const [fp, fn, inside] = [one.fp, one.fn, one.inside].map((list) => keys(list.at(k)));
      for (let a = 0; a < all.length; ++a)
        for (let b = a + 1; b < all.length; ++b) {
          if (!all[a] || !all[b] || !isAsked([a, b])) continue;
          const pair = [a, b],
            id = key(pair),
            said = fp.has(id) || inside.has(id) || (met.has(id) && !fn.has(id)),
            { hit, tie } = compared(one, pair, all, true);
          if (hit === null) continue;
          ++count;
          if (hit !== said) wrong.push({ label: one.label, step, pair, said, hit, tie });
        }
    }
    return { count, wrong };
  }

  window.viewer = {
    step,
    go: (s) => go(s - data.first),
    choose,
    fly,
    setAlgorithm,
    state,
    now: () => now,
    measured: () => measured,
    seen: () => seen,
    viewed,
    body: (b) => body(b, state.k),
    solid,
    recount,
    rest: () =>
      new Promise((done) => {
        const look = () => requestAnimationFrame(picture && !picture.still() ? look : done);
        look();
      }),
    drawn: (b) => Array.from({ length: meshes[data.bodies[b].mesh].vertices.length / 3 }, (_, i) => solid(b).vertex(i)),
    name,
    pixel: (b) => picture.pixel(b),
  };
})();
