"use strict";
(() => {
  // Tables: sort by a click on a heading or Enter on it; up, down, as it was.
  const LONG = 15;
  const value = (row, column) => {
    const cell = row.cells[column];
    return cell.dataset.v ?? cell.textContent;
  };
  const number = (text) => {
    const found = Number(text.trim().replace("inf", "Infinity"));
    return text.trim() === "" ? NaN : found;
  };
  const compare = (column, numeric, sign) => (a, b) => {
    const x = value(a, column), y = value(b, column);
    if (!numeric) return sign * x.localeCompare(y, "en", { numeric: true });
    const p = number(x), q = number(y);
    // What has no number stands last, whatever the order.
    if (Number.isNaN(p) || Number.isNaN(q)) return Number.isNaN(p) - Number.isNaN(q);
    return sign * (p < q ? -1 : p > q ? 1 : 0);
  };
  for (const table of document.querySelectorAll("figure.table table")) {
    const body = table.tBodies[0];
    const rows = Array.from(body.rows);
    const heads = Array.from(table.tHead.rows[0].cells);
    if (rows.length < 2) continue;
    heads.forEach((head, column) => {
      const button = document.createElement("button");
      button.type = "button";
      button.title = "Sort";
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener("click", () => {
        const next = { ascending: "descending", descending: null }[head.getAttribute("aria-sort")];
        const order = next === undefined ? "ascending" : next;
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        if (order) head.setAttribute("aria-sort", order);
        const numeric = head.classList.contains("n");
        const sign = order === "descending" ? -1 : 1;
        body.append(...(order ? rows.slice().sort(compare(column, numeric, sign)) : rows));
      });
    });
    if (rows.length <= LONG) continue;
    const box = document.createElement("div");
    const label = document.createElement("label");
    const input = document.createElement("input");
    const count = document.createElement("span");
    box.className = "filter";
    input.type = "search";
    input.placeholder = "words, all must occur";
    count.setAttribute("role", "status");
    const texts = rows.map((row) => Array.from(row.cells, (cell) => cell.textContent).join(" ").toLowerCase());
    const filter = () => {
      const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
      let shown = 0;
      rows.forEach((row, k) => {
        row.hidden = !words.every((word) => texts[k].includes(word));
        shown += row.hidden ? 0 : 1;
      });
      count.textContent = shown === rows.length ? `${rows.length} rows` : `${shown} of ${rows.length} rows`;
    };
    input.addEventListener("input", filter);
    filter();
    label.append("Filter ", input);
    box.append(label, count);
    table.closest(".scroll").before(box);
  }

  // Theme: that of the system until a choice is made. Storage may be forbidden, then the choice lasts as long as the page.
  const root = document.documentElement;
  const button = document.getElementById("theme");
  const names = ["auto", "light", "dark"];
  const apply = (name) => {
    if (name === "auto") root.removeAttribute("data-theme");
    else root.setAttribute("data-theme", name);
    button.textContent = `Theme: ${name}`;
  };
  let theme = "auto";
  try {
    const kept = localStorage.getItem("stickslip-theme");
    if (names.includes(kept)) theme = kept;
  } catch { /* no storage */ }
  apply(theme);
  button.hidden = false;
  button.addEventListener("click", () => {
    theme = names[(names.indexOf(theme) + 1) % names.length];
    apply(theme);
    try { localStorage.setItem("stickslip-theme", theme); } catch { /* no storage */ }
  });

  // On a narrow screen the contents are folded; on paper every figure is unfolded.
  if (matchMedia("(max-width: 60rem)").matches) document.querySelector("nav details").open = false;
  let folded = [];
  addEventListener("beforeprint", () => {
    folded = Array.from(document.querySelectorAll("main details:not([open])"));
    folded.forEach((details) => { details.open = true; });
  });
  addEventListener("afterprint", () => { folded.forEach((details) => { details.open = false; }); });
})();
