// The page without its explorers: views, dark, sorting, highlights, files, printing.
const all = (selector, from = document) => [...from.querySelectorAll(selector)];
const root = document.documentElement;
root.classList.add("js");

// ---- Tables are sorted by a column when its head is pressed.
const value = cell => { const text = cell.textContent.replace(/[\u202f\s]/g, ""), n = parseFloat(text);
  return text === "\u2013" ? Infinity : isNaN(n) ? text : n; };
for (const button of all("th button")) button.addEventListener("click", () => {
  const head = button.parentElement, column = head.cellIndex, body = head.closest("table").tBodies[0];
  const up = head.getAttribute("aria-sort") !== "ascending", rows = [...body.rows];
  const keys = new Map(rows.map(row => [row, value(row.cells[column])]));
  const order = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === "number" ? -1 : 1;
  rows.sort((a, b) => (up ? 1 : -1) * order(keys.get(a), keys.get(b)));
  for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", up ? "ascending" : "descending");
  body.append(...rows);
});

// ---- One view at a time: the overview, a scene, what is read last. A link to what is in another view shows that.
const views = all(".view"), entries = all(".side nav > div");
let every = false;
function show(view) {
  views.forEach((each, i) => {
    each.classList.toggle("away", !every && each !== view);
    entries[i].classList.toggle("here", each === view);
    entries[i].querySelector("b a").toggleAttribute("aria-current", each === view && !every);
  });
  document.querySelector(".main").classList.toggle("within", !every && view !== views[0]);
  dispatchEvent(new Event("viewed"));
}
function follow() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  const view = target && target.closest(".view");
  const fold = target && target.querySelector(":scope > details");
  if (fold && target.matches(".verdict")) fold.open = true;
  if (view) { show(view); target.scrollIntoView(); } else if (!target) show(views[0]);
}
const everything = document.getElementById("everything");
everything.hidden = views.length < 2;
everything.addEventListener("click", () => {
  every = !every;
  everything.setAttribute("aria-pressed", every);
  show(views.find(view => !view.classList.contains("away")) || views[0]);
});
addEventListener("hashchange", follow);
// A second press on the same link is no change of the address.
addEventListener("click", event => {
  const link = event.target.closest && event.target.closest("a[href^='#']");
  if (link && link.getAttribute("href") === location.hash) follow();
});

// ---- Dark, as the system has it until the button is pressed.
const dark = document.getElementById("dark"), wish = matchMedia("(prefers-color-scheme: dark)");
function paint(on) {
  root.classList.toggle("dark", on);
  dark.textContent = on ? "light" : "dark";
  dispatchEvent(new Event("painted"));
}
dark.hidden = false;
dark.addEventListener("click", () => paint(!root.classList.contains("dark")));
wish.addEventListener("change", () => paint(wish.matches));

// ---- One label over all figures and tables: under the pointer for a moment, pressed until it is pressed again.
const lit = { pinned: null, now: null };
function highlight(label) {
  if (label === lit.now) return;
  lit.now = label;
  document.body.classList.toggle("lit", !!label);
  for (const each of all("[data-of]")) each.classList.toggle("on", each.dataset.of === label);
  dispatchEvent(new CustomEvent("lit", { detail: label }));
}
function pin(label) {
  lit.pinned = lit.pinned === label ? null : label;
  highlight(lit.pinned);
  dispatchEvent(new CustomEvent("pinned", { detail: lit.pinned }));
}
const labels = new Set(all("[data-of]").map(each => each.dataset.of));
for (const each of all(".explorer")) for (const point of JSON.parse(each.dataset.points).points) labels.add(point.label);
for (const head of all("tbody th")) if (labels.has(head.textContent)) head.parentElement.dataset.of = head.textContent;
const tip = document.createElement("div");
tip.className = "tip"; tip.hidden = true;
document.body.append(tip);
function tell(text, event) {
  tip.hidden = !text;
  if (!text) return;
  tip.textContent = text;
  const box = tip.getBoundingClientRect();
  tip.style.left = Math.max(4, Math.min(event.clientX + 14, innerWidth - box.width - 8)) + "px";
  tip.style.top = (event.clientY + 18 + box.height > innerHeight ? event.clientY - box.height - 10 : event.clientY + 18) + "px";
}
const words = new WeakMap(); // the titles of marks: shown at once, not by the browser after a while
for (const title of all(".picture svg title")) {
  words.set(title.parentNode, title.textContent);
  title.parentNode.setAttribute("aria-label", title.textContent);
  title.remove();
}
addEventListener("pointerover", event => {
  const mark = event.target.closest && event.target.closest(".picture [data-of], tr[data-of]");
  if (mark) { highlight(mark.dataset.of); if (mark.tagName !== "TR") tell(words.get(mark) || mark.dataset.of, event); }
});
addEventListener("pointerout", event => {
  if (event.target.closest && event.target.closest(".picture [data-of], tr[data-of]")) { tell(null); highlight(lit.pinned); }
});
addEventListener("click", event => {
  const mark = event.target.closest && event.target.closest(".picture [data-of], tr[data-of] > th");
  if (mark) pin((mark.dataset.of ? mark : mark.parentElement).dataset.of);
});
addEventListener("keydown", event => { if (event.key === "Escape" && lit.pinned) pin(lit.pinned); });

// ---- Names of a map's rows stay in sight when it scrolls within itself.
for (const place of all(".picture")) {
  const svg = place.querySelector("svg"), names = all("svg .row", place);
  if (!names.length) continue;
  const make = name => document.createElementNS(svg.namespaceURI, name), stay = make("g"), behind = make("rect");
  stay.append(behind, ...names);
  svg.append(stay);
  behind.setAttribute("fill", "#fff");
  place.addEventListener("scroll", () => {
    const moved = place.scrollLeft * svg.viewBox.baseVal.width / svg.getBoundingClientRect().width;
    stay.setAttribute("transform", `translate(${moved})`);
    behind.setAttribute("width", 0);
    const { x, y, width, height } = stay.getBBox();
    for (const [name, length] of Object.entries({ y: y - 12, height: height + 24, width: moved && x + width + 3 })) behind.setAttribute(name, length);
  });
}

// ---- Files of figures.
function save(name, content, type) {
  const link = document.createElement("a");
  link.href = content instanceof Blob || type ? URL.createObjectURL(new Blob([content], { type })) : content;
  link.download = name;
  link.click();
}
function csv(rows) {
  return rows.map(row => row.map(cell => /[",\n]/.test(cell) ? `"${cell.replace(/"/g, '""')}"` : cell).join(",")).join("\n") + "\n";
}
function standing(svg) {
  const copy = svg.cloneNode(true), box = svg.viewBox.baseVal;
  copy.setAttribute("xmlns", "http:" + "//www.w3.org/2000/svg");
  copy.setAttribute("font-family", "DejaVu Sans, sans-serif");
  if (box.width) { copy.setAttribute("width", box.width); copy.setAttribute("height", box.height); }
  return new XMLSerializer().serializeToString(copy);
}
function png(svg, name) {
  const image = new Image(), canvas = document.createElement("canvas"), box = svg.viewBox.baseVal;
  image.onload = () => {
    canvas.width = 2.5 * (box.width || image.width); canvas.height = 2.5 * (box.height || image.height);
    const pen = canvas.getContext("2d");
    pen.fillStyle = "#fff"; pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob(blob => save(name + ".png", blob, "image/png"));
  };
  image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(standing(svg));
}
for (const button of all("figure [data-save]")) button.addEventListener("click", () => {
  const figure = button.closest("figure"), svg = figure.querySelector("svg"), kind = button.dataset.save;
  if (kind === "png") png(svg, figure.id);
  if (kind === "svg") save(figure.id + ".svg", standing(svg), "image/svg+xml");
  if (kind === "csv") save(figure.id + ".csv", csv(all("details tr", figure).map(row => [...row.cells].map(cell =>
    cell.textContent.trim().replace(/\u202f/g, "").replace(/^\u2013$/, "")))), "text/csv");
});

// ---- Verdicts of one kind.
for (const group of all(".filters")) {
  group.hidden = false;
  const unfold = group.querySelector(".unfold"), kinds = all("button[data-word]", group);
  unfold.addEventListener("click", () => {
    const open = unfold.getAttribute("aria-pressed") !== "true";
    unfold.setAttribute("aria-pressed", open);
    for (const fold of all(".verdict > details", group.parentElement)) fold.open = open;
  });
  for (const button of kinds) button.addEventListener("click", () => {
    for (const other of kinds) other.setAttribute("aria-pressed", other === button);
    for (const verdict of all(".verdict", group.parentElement))
      verdict.hidden = !!button.dataset.word && !verdict.classList.contains(button.dataset.word);
  });
}

// ---- Printing opens folded numbers and shows all views.
let folded = [];
addEventListener("beforeprint", () => {
  folded = all("details:not([open], .text)");
  folded.forEach(d => d.open = true);
});
addEventListener("afterprint", () => folded.forEach(d => d.open = false));
