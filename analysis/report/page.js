// Tables are sorted by a column when its head is pressed; folded numbers are opened for printing.
const value = cell => { const text = cell.textContent.replace(/[\u202f\s]/g, ""), n = parseFloat(text);
  return text === "\u2013" ? Infinity : isNaN(n) ? text : n; };
for (const button of document.querySelectorAll("th button")) button.addEventListener("click", () => {
  const head = button.parentElement, column = head.cellIndex, body = head.closest("table").tBodies[0];
  const up = head.getAttribute("aria-sort") !== "ascending", rows = [...body.rows];
  const keys = new Map(rows.map(row => [row, value(row.cells[column])]));
  const order = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === "number" ? -1 : 1;
  rows.sort((a, b) => (up ? 1 : -1) * order(keys.get(a), keys.get(b)));
  for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", up ? "ascending" : "descending");
  body.append(...rows);
});
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("details:not([open], .text)")];
  folded.forEach(d => d.open = true);
});
addEventListener("afterprint", () => folded.forEach(d => d.open = false));
