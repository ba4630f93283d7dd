// The picture: the bodies of the chosen step, drawn with three.js. Everything else of the page works without it.
"use strict";

// page: what viewer.js knows. Gives { update, fly, setUp, pixel, all }; throws where there is no WebGL.
function makePicture(page) {
  const { data, meshes, poses, state, KINDS, NONE, listed, place, radius, name, kindOf, bodyKinds, choose, toDrawn } =
    page;
  const $ = (id) => document.getElementById(id);
  const view = $("view"),
    root = new THREE.Group(),
    scene = new THREE.Scene();
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  renderer.domElement.setAttribute("aria-label", "The bodies in 3D; what is in it is listed beside it");
  renderer.domElement.setAttribute("role", "img");
  view.prepend(renderer.domElement);
  const camera = new THREE.PerspectiveCamera(42, 1, 0.01, 1000);
  const lamp = new THREE.DirectionalLight(0xffffff, 0.55);
  lamp.position.set(-0.6, 1, 0.8);
  camera.add(lamp); // light from behind the eye's left shoulder, wherever it looks from
  scene.add(camera, root, new THREE.HemisphereLight(0xffffff, 0x9aa3ad, 0.62));
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.enableKeys = false;
  controls.screenSpacePanning = true;

  // Meshes once each; bodies share them, and the materials by kind and manner.
  const shapes = meshes.map((mesh) => {
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.BufferAttribute(mesh.vertices, 3));
    shape.setIndex(new THREE.BufferAttribute(mesh.index, 1));
    shape.computeBoundingSphere();
    return shape;
  });
  const materials = new Map();
  function material(color, manner) {
    const wanted = color + manner;
    if (!materials.has(wanted)) {
      const opacity = { solid: 1, faded: 0.1, through: 0.09, shell: 0.3, pair: 0.62 }[manner];
      materials.set(
        wanted,
        new THREE.MeshPhongMaterial({
          color,
          opacity,
          transparent: opacity < 1,
          depthWrite: opacity === 1,
          flatShading: true,
          shininess: 12,
          specular: 0x222222,
          side: manner === "faded" ? THREE.FrontSide : THREE.DoubleSide,
          polygonOffset: true,
          polygonOffsetFactor: 1,
          polygonOffsetUnits: 1,
        }),
      );
    }
    return materials.get(wanted);
  }
  const edgeShapes = [[], []]; // of all triangles; of sharp edges only
  function edges(mesh, sharp) {
    const made = edgeShapes[Number(sharp)];
    return (made[mesh] =
      made[mesh] || (sharp ? new THREE.EdgesGeometry(shapes[mesh], 20) : new THREE.WireframeGeometry(shapes[mesh])));
  }
  const thin = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.3 });
  const strong = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.6 });
  const lace = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.16 }); // over both sides
  const css = (property) => new THREE.Color(getComputedStyle(document.body).getPropertyValue(property).trim());
  let ink = css("--ink");

  const things = data.bodies.map((body, b) => {
    const thing = new THREE.Mesh(shapes[body.mesh], material(NONE, "solid"));
    thing.userData.body = b;
    root.add(thing);
    return thing;
  });
  function wire(thing, wanted) {
    const { mesh } = data.bodies[thing.userData.body];
    if (thing.children.length && thing.userData.wire === wanted) return;
    thing.remove(...thing.children);
    thing.userData.wire = wanted;
    if (wanted) thing.add(new THREE.LineSegments(edges(mesh, wanted === "sharp"), { thin, lace }[wanted] || strong));
  }

  // Square bars from point to point, drawn over everything: lines of WebGL are one pixel wide.
  function bars(segments, thickness, color, opacity = 0.9, hidden = false) {
    const position = [],
      index = [];
    const p = new THREE.Vector3(),
      q = new THREE.Vector3(),
      d = new THREE.Vector3(),
      u = new THREE.Vector3(),
      v = new THREE.Vector3();
    for (const [from, to] of segments) {
      d.subVectors(q.fromArray(to), p.fromArray(from));
      if (d.lengthSq() === 0) d.set(0, thickness, 0);
      u.set(Math.abs(d.x) < Math.abs(d.y) ? 1 : 0, Math.abs(d.x) < Math.abs(d.y) ? 0 : 1, 0)
        .cross(d)
        .setLength(thickness);
      v.crossVectors(d, u).setLength(thickness);
      const base = position.length / 3;
      for (const end of [p, q])
        for (const [s, t] of [
          [1, 1],
          [1, -1],
          [-1, -1],
          [-1, 1],
        ])
          position.push(end.x + s * u.x + t * v.x, end.y + s * u.y + t * v.y, end.z + s * u.z + t * v.z);
      for (let i = 0; i < 4; ++i) {
        const j = (i + 1) % 4;
        index.push(base + i, base + j, base + 4 + j, base + i, base + 4 + j, base + 4 + i);
      }
      for (const e of [0, 4]) index.push(base + e, base + e + 1, base + e + 2, base + e, base + e + 2, base + e + 3);
    }
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.BufferAttribute(new Float32Array(position), 3));
    shape.setIndex(index);
    const over = new THREE.MeshBasicMaterial({
      color,
      depthTest: hidden, // by what is before them
      transparent: true,
      opacity,
      side: THREE.DoubleSide,
    });
    const made = new THREE.Mesh(shape, over);
    made.renderOrder = 10;
    return made;
  }
  const marks = new THREE.Group();
  root.add(marks);
  function clearMarks() {
    for (const mark of marks.children) {
      mark.geometry.dispose();
      mark.material.dispose();
    }
    marks.remove(...marks.children);
  }

  // What the algorithm compares of a body: lines as bars while they are few, else as lines of one pixel; faces and balls
  // see-through; points as dots of a few pixels.
  const MOST_BARS = 400;
  function showSeen({ lines = [], faces = [], points = [], balls = [] }, color, thickness, opacity) {
    const drawn = (list) => list.map((corners) => corners.map(toDrawn));
    const shaped = (list) => {
      const shape = new THREE.BufferGeometry();
      shape.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(list.flat(2)), 3));
      return shape;
    };
    const sheer = (strength) =>
      new THREE.MeshBasicMaterial({
        color,
        opacity: strength,
        transparent: true,
        depthWrite: false,
        side: THREE.DoubleSide,
      });
    if (lines.length && lines.length <= MOST_BARS)
      marks.add(bars(drawn(lines), lines.length > 20 ? thickness / 2 : thickness, color, opacity, true));
    else if (lines.length) {
      const look = new THREE.LineBasicMaterial({ color, transparent: true, opacity });
      marks.add(new THREE.LineSegments(shaped(drawn(lines)), look));
    }
    if (faces.length) marks.add(new THREE.Mesh(shaped(drawn(faces)), sheer(0.12 * opacity)));
    if (points.length) {
      const look = new THREE.PointsMaterial({ color, size: 5 * renderer.getPixelRatio(), sizeAttenuation: false });
      marks.add(new THREE.Points(shaped([points.map(toDrawn)]), look));
    }
    for (const [centre, metres] of balls) {
      const ball = new THREE.Mesh(new THREE.SphereBufferGeometry(metres / data.unit, 48, 32), sheer(0.13 * opacity));
      ball.position.fromArray(toDrawn(centre));
      marks.add(ball);
      const circle = Array.from({ length: 65 }, (_, i) => [Math.cos((i * Math.PI) / 32), Math.sin((i * Math.PI) / 32)]);
      const rings = [0, 1, 2].flatMap((c) =>
        circle
          .slice(1)
          .map((_, i) =>
            [circle[i], circle[i + 1]].map((uv) =>
              centre.map((x, k) => x + metres * (k === c ? 0 : uv[k === (c + 1) % 3 ? 0 : 1])),
            ),
          ),
      );
      marks.add(bars(drawn(rings), thickness, color, opacity, true));
    }
    for (const made of marks.children) made.renderOrder = made.renderOrder || 5;
  }

  // From middle to middle; none to a see-through plate or wall, whose middle is far from the pair.
  function links(kind) {
    const thickness = (p) => 0.05 * Math.min(radius(p[0]), radius(p[1]));
    const pairs = page.now()[kind].filter((p) => p.every((b) => place(b) && !data.bodies[b].big));
    if (!pairs.length) return;
    const segments = pairs.flatMap(([a, b]) => {
      const p = place(a),
        q = place(b),
        mix = (t) => p.map((x, c) => x + t * (q[c] - x));
      return kind === "fn" ? [[p, q]] : [0, 0.4, 0.8].map((t) => [mix(t), mix(t + 0.2)]); // false positives dashed
    });
    marks.add(bars(segments, Math.min(...pairs.map(thickness)), KINDS[kind].color));
  }

  function update() {
    ink = css("--ink");
    renderer.setClearColor(css("--ground"));
    for (const material of [thin, strong, lace]) material.color = ink;
    const measured = page.measured();
    const shells = new Set(page.contained().map(([a, b]) => (radius(a) > radius(b) ? a : b))); // hold a body inside
    const kinds = bodyKinds(),
      chosen = state.chosen || [],
      pair = chosen.length === 2;
    const partners = new Set(
      chosen.length === 1
        ? listed.flatMap((kind) =>
            page
              .now()
              [kind].filter((p) => p.includes(chosen[0]))
              .flat(),
          )
        : chosen,
    );
    things.forEach((thing, b) => {
      const at = place(b),
        i = 7 * (state.k * data.bodies.length + b);
      thing.visible = at !== null;
      if (!at) return;
      thing.position.fromArray(at);
      thing.quaternion.set(poses[i + 1], poses[i + 2], poses[i + 3], poses[i]);
      const mine = chosen.includes(b),
        kind = pair ? mine && kindOf(chosen) : kinds.get(b);
      let manner = state.through[b] ? "through" : shells.has(b) ? "shell" : "solid";
      if (pair) manner = mine ? (data.bodies[b].big ? "through" : "pair") : "faded";
      else if (chosen.length && !partners.has(b) && b !== chosen[0]) manner = state.through[b] ? "through" : "faded";
      else if (state.quiet && !kind) manner = "faded";
      if (manner === "faded" && data.bodies[b].big) manner = "through";
      let color = kind && !(data.bodies[b].big && !mine) ? KINDS[kind].color : NONE;
      if (pair && mine && b === chosen[1])
        color = new THREE.Color(color).lerp(new THREE.Color(0xffffff), 0.45).getHex();
      thing.material = material(color, manner);
      wire(
        thing,
        mine
          ? pair
            ? "lace"
            : "strong"
          : state.edges && manner !== "faded"
            ? "thin"
            : manner === "through"
              ? "sharp"
              : null,
      );
    });
    clearMarks();
    if (!pair && !chosen.length) ["fp", "fn"].forEach(links);
    const size = 0.012 * Math.min(...chosen.map(radius));
    const shown = page.seen();
    if (shown) {
      const colors = ["--first", "--second"].map(css);
      shown.bodies.forEach(([view, filter], i) => {
        showSeen(view, colors[i], size / 2, 0.9);
        showSeen({ lines: filter.lines, balls: filter.balls }, colors[i], size / 5, 0.7);
      });
      const { lines = [], faces = [], points = [] } = shown.marks;
      const red = css("--decides");
      if (lines.length)
        marks.add(
          bars(
            lines.map((line) => line.map(toDrawn)),
            0.8 * size,
            red,
          ),
        );
      showSeen({ faces, points }, red, size, 3);
    }
    if (measured && measured.pairs) marks.add(bars(measured.segments, size, ink));
    else if (measured && measured.gap && measured.gap.from)
      marks.add(bars([[measured.gap.from, measured.gap.to]], size, ink));
    draw();
  }

  const seen = (p) => root.localToWorld(new THREE.Vector3().fromArray(p));
  function tag(id, body) {
    const label = $(id),
      at = body === undefined ? null : place(body);
    label.hidden = !at || data.bodies[body].big;
    if (label.hidden) return;
    const { mesh } = data.bodies[body],
      { vertices } = meshes[mesh],
      stride = 3 * Math.ceil(vertices.length / 3 / 500), // of a fine mesh some vertices tell where its top is
      matrix = things[body].matrixWorld;
    let top = null;
    for (let i = 0; i < vertices.length; i += stride) {
      const p = new THREE.Vector3(vertices[i], vertices[i + 1], vertices[i + 2]).applyMatrix4(matrix).project(camera);
      if (Math.abs(p.z) <= 1 && (!top || p.y > top.y)) top = p;
    }
    label.hidden = !top;
    if (!top) return;
    label.textContent = name(body);
    const wide = label.offsetWidth / 2 + 4,
      within = (x, low, high) => Math.min(Math.max(x, low), Math.max(low, high));
    label.style.left = within(((top.x + 1) / 2) * view.clientWidth, wide, view.clientWidth - wide) + "px";
    label.style.top = within(((1 - top.y) / 2) * view.clientHeight, 72, view.clientHeight) + "px";
  }

  // A bar of 1, 2 or 5 times a power of ten metres, as long as that is at the point that the camera turns about.
  function showScale(away) {
    const metres = ((2 * away * Math.tan((camera.fov / 2) * (Math.PI / 180))) / view.clientHeight) * data.unit, // a pixel
      most = 130 * metres;
    if (!(most > 0 && isFinite(most))) return;
    const power = 10 ** Math.floor(Math.log10(most)),
      long = [5, 2, 1].map((k) => k * power).find((x) => x <= most) || power;
    const [unit, name] = [
      [1e3, "km"],
      [1, "m"],
      [1e-2, "cm"],
      [1e-3, "mm"],
      [1e-6, "µm"],
      [1e-9, "nm"],
    ].find(([size]) => long >= size * (1 - 1e-9)) || [1, "m"];
    const bar = $("scale");
    bar.hidden = false;
    bar.dataset.metres = long;
    bar.firstElementChild.textContent =
      long < 1e-10 || long >= 1e7 ? long.toExponential(0) + " m" : Number((long / unit).toPrecision(3)) + " " + name;
    bar.lastElementChild.style.width = long / metres + "px";
  }

  // The world's axes as the camera sees them.
  function showAxes() {
    const turn = camera.quaternion.clone().inverse();
    const lines = ["x", "y", "z"].map((axis, c) => {
      const p = new THREE.Vector3(...[0, 1, 2].map((k) => (k === c ? 1 : 0)))
        .applyQuaternion(root.quaternion)
        .applyQuaternion(turn);
      const at = (r) => [r * p.x, -r * p.y].map((x) => x.toFixed(1));
      const [x, y] = at(19),
        [u, v] = at(26);
      return `<line x1="0" y1="0" x2="${x}" y2="${y}"/><text x="${u}" y="${v}">${axis}</text>`;
    });
    $("axes").innerHTML = lines.join("");
    $("axes").removeAttribute("hidden");
  }

  let asked = false;
  function draw() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      const away = camera.position.distanceTo(controls.target);
      camera.near = away / 500;
      camera.far = away + 6 * reach;
      camera.updateProjectionMatrix();
      renderer.render(scene, camera);
      const [a, b] = state.chosen || [];
      tag("tag", a);
      tag("tag2", b);
      showScale(away);
      showAxes();
    });
  }
  controls.addEventListener("change", draw);

  // A ball about bodies, the outermost 2 of 100 along each axis left out: one lost far away does not shrink all.
  function ball(bodies) {
    const there = bodies.filter((b) => place(b)),
      low = [0, 0, 0],
      high = [0, 0, 0];
    if (!there.length) return { middle: [0, 0, 0], radius: 1 };
    const cut = there.length > 50 ? Math.floor(there.length / 50) : 0;
    for (let c = 0; c < 3; ++c) {
      const ends = there.map((b) => [place(b)[c] - radius(b), place(b)[c] + radius(b)]);
      low[c] = ends.map((e) => e[0]).sort((x, y) => x - y)[cut];
      high[c] = ends.map((e) => e[1]).sort((x, y) => y - x)[cut];
    }
    const half = low.map((x, c) => (high[c] - x) / 2);
    return {
      middle: low.map((x, c) => x + half[c]),
      radius: there.length === 1 ? radius(there[0]) : Math.hypot(...half),
    };
  }

  const all = data.bodies.map((_, b) => b);
  let reach = 1;
  function goal(bodies) {
    let wanted = bodies.filter((b) => !data.bodies[b].big);
    if (!wanted.some((b) => place(b))) wanted = bodies;
    const { middle, radius } = near(bodies) || ball(wanted);
    const narrow = Math.min(1, camera.aspect),
      distance = radius / Math.sin((camera.fov / 2) * (Math.PI / 180)) / narrow;
    const target = seen(middle),
      direction = camera.position.clone().sub(controls.target).normalize();
    if (bodies.length === 2) across(direction, bodies);
    return { target, position: target.clone().addScaledVector(direction, distance * (bodies.length > 2 ? 0.8 : 1)) };
  }

  // The ball about what is measured of a pair, the crossing or the gap: { middle, radius }; null when nothing is.
  function contact() {
    const measured = page.measured();
    if (!measured || !(measured.pairs || measured.gap.from)) return null;
    const points = measured.pairs ? measured.segments.flat() : [measured.gap.from, measured.gap.to];
    const middle = [0, 1, 2].map((c) => {
      const [low, high] = points.reduce(([x, y], p) => [Math.min(x, p[c]), Math.max(y, p[c])], [Infinity, -Infinity]);
      return (low + high) / 2;
    });
    return {
      middle,
      radius: points.reduce((most, p) => Math.max(most, Math.hypot(...p.map((x, c) => x - middle[c]))), 0),
    };
  }

  // As near to a pair as its crossing or gap and the smaller body allow: a small body on a plate is not lost.
  function near(bodies) {
    const met = bodies.length === 2 ? contact() : null;
    if (!met) return null;
    const least = Math.min(...bodies.map(radius));
    return { middle: met.middle, radius: Math.min(ball(bodies).radius, Math.max(1.2 * met.radius, 2.3 * least)) };
  }

  // Turns a direction of view so that a pair is seen from its side, a little from above that: two bodies behind one
  // another show nothing.
  function across(direction, [a, b]) {
    const measured = page.measured(),
      small = radius(a) < radius(b) ? a : b;
    let ends = [place(a), place(b)];
    if (measured && measured.gap && measured.gap.from) ends = [measured.gap.from, measured.gap.to];
    else if (measured && measured.pairs && Math.max(radius(a), radius(b)) > 3 * radius(small))
      ends = [contact().middle, place(small)];
    if (!ends[0] || !ends[1]) return;
    const axis = seen(ends[1]).sub(seen(ends[0])).normalize(),
      part = direction.dot(axis),
      aside = direction.clone().addScaledVector(axis, -part);
    if (aside.length() < 0.3)
      aside
        .set(0, 1, 0)
        .cross(axis)
        .addScaledVector(direction, 0.3)
        .addScaledVector(axis, -0.3 * part);
    if (aside.length() > 1e-3)
      direction.copy(
        aside
          .normalize()
          .addScaledVector(axis, part < 0 ? -0.2 : 0.2)
          .normalize(),
      );
  }

  let flight = 0;
  function fly(bodies, at_once = matchMedia("(prefers-reduced-motion: reduce)").matches) {
    const to = goal(bodies),
      from = { target: controls.target.clone(), position: camera.position.clone() };
    const start = performance.now();
    cancelAnimationFrame(flight);
    const tick = (time) => {
      const t = at_once ? 1 : Math.min(1, Math.max(0, time - start) / 350),
        s = t * t * (3 - 2 * t);
      controls.target.lerpVectors(from.target, to.target, s);
      camera.position.lerpVectors(from.position, to.position, s);
      controls.update();
      draw();
      flight = t < 1 ? requestAnimationFrame(tick) : 0;
    };
    tick(start);
  }

  function resize() {
    const width = view.clientWidth || 1,
      height = view.clientHeight || 1;
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    draw();
  }

  const ray = new THREE.Raycaster();
  function bodyAt(x, y) {
    const box = renderer.domElement.getBoundingClientRect();
    ray.setFromCamera(
      new THREE.Vector2(((x - box.left) / box.width) * 2 - 1, 1 - ((y - box.top) / box.height) * 2),
      camera,
    );
    const hits = ray.intersectObjects(
      things.filter((t) => t.visible),
      false,
    );
    const hit = hits.find((h) => !state.through[h.object.userData.body]) || hits[0]; // what is see-through comes last
    return hit ? hit.object.userData.body : null;
  }
  let down = null;
  renderer.domElement.addEventListener("pointerdown", (e) => {
    down = e.isPrimary && e.button === 0 ? [e.clientX, e.clientY] : null;
    cancelAnimationFrame(flight);
    flight = 0;
  });
  renderer.domElement.addEventListener("pointerup", (e) => {
    if (!down || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 5) return;
    const body = bodyAt(e.clientX, e.clientY);
    choose(body === null ? null : [body]);
  });
  renderer.domElement.addEventListener("dblclick", (e) => {
    const body = bodyAt(e.clientX, e.clientY);
    if (body !== null) fly([body]);
  });
  renderer.domElement.addEventListener("webglcontextlost", (e) => {
    e.preventDefault();
    $("message").textContent = "The graphics card gave up drawing; reload the page to try again. The lists still work.";
    $("message").hidden = false;
  });

  // Pixels of the window at which a body's middle is drawn; for tests.
  function pixel(body) {
    const p = seen(place(body)).project(camera),
      box = renderer.domElement.getBoundingClientRect();
    return [box.left + ((p.x + 1) / 2) * box.width, box.top + ((1 - p.y) / 2) * box.height];
  }

  function setUp(axis) {
    root.rotation.x = axis === "z" ? -Math.PI / 2 : 0;
    root.updateMatrixWorld(true);
  }

  camera.position.set(0.75, 0.55, 1);
  new ResizeObserver(resize).observe(view);
  resize();
  reach = ball(all).radius;
  fly(all, true);
  return { update, fly, setUp, pixel, still: () => !flight && !asked, all: () => fly(all) };
}
