// silt - BSD-3-Clause, see LICENSE
// Search, copy buttons and the menu of narrow screens. SILT_INDEX (search_index.js) has [page, heading, address, text].
(function () {
  "use strict";
  const root = document.documentElement.dataset.root;
  const plain = (text) => text.toLowerCase();
  const escaped = (text) => text.replace(/[&<>"]/g, (c) => ({"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;"})[c]);

  function words(query) {
    return plain(query).split(/[^\p{L}\p{N}_:.+-]+/u).filter((w) => w.length > 0);
  }

  // Lower case, with the parts of CamelCase names as words too.
  const spread = (text) => plain(text.replace(/([a-z0-9])([A-Z])/g, "$1 $2") + " " + text);
  let entries = null;
  function all() {
    entries = entries || SILT_INDEX.map(([page, heading, address, text, kind]) => ({
      page, heading, address, text, kind, low: {page: spread(page), heading: spread(heading), text: spread(text)}}));
    return entries;
  }
  const start = "(?<![\\p{L}\\p{N}])";
  const escape = (w) => w.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");

  // All words must occur at the beginning of a word; whole words and those in headings count most, then how often they occur.
  function look(query) {
    const wanted = words(query);
    if (!wanted.length) return [];
    const at_start = wanted.map((w) => new RegExp(start + escape(w), "gu"));
    const whole = wanted.map((w) => new RegExp(start + escape(w) + "s?(?![\\p{L}\\p{N}])", "u"));
    const phrase = wanted.length > 1 ? new RegExp(start + wanted.map(escape).join("[^\\p{L}\\p{N}]+"), "u") : null;
    const hits = [];
    for (const entry of all()) {
      const {low, kind} = entry;
      let score = kind === "policy" ? 4 : kind === "log" ? -12 : 0, missing = false;
      wanted.forEach((w, k) => {
        let own = 0;
        if (low.heading.split(" ")[0] === w && plain(entry.heading) === w) own += 60;
        else if (whole[k].test(low.heading)) own += 30;
        else if (low.heading.match(at_start[k])) own += 18;
        if (low.page.match(at_start[k])) own += 12;
        const times = (low.text.match(at_start[k]) || []).length;
        own += 2 * Math.min(times, 6) + (whole[k].test(low.text) ? 6 : 0);
        if (own === 0) missing = true;
        score += own;
      });
      if (missing) continue;
      if (phrase && phrase.test(low.heading)) score += 40;
      if (phrase && phrase.test(low.text)) score += 15;
      hits.push({...entry, score});
    }
    return hits.sort((a, b) => b.score - a.score);
  }

  function marked(text, wanted) {
    const alternatives = wanted.map(escape).join("|");
    return text.split(new RegExp("((?<![\\p{L}\\p{N}])(?:" + alternatives + "))", "giu"))
        .map((part, k) => (k % 2 ? "<mark>" + escaped(part) + "</mark>" : escaped(part))).join("");
  }

  function shown(hit, wanted) {
    let at = Math.min(...wanted.map((w) => hit.text.search(new RegExp(start + escape(w), "iu"))).filter((k) => k >= 0), 1e9);
    at = at === 1e9 ? 0 : Math.max(0, at - 70);
    if (at > 0) at = hit.text.indexOf(" ", at) + 1;
    const piece = (at > 0 ? "... " : "") + hit.text.slice(at, at + 210) + (hit.text.length > at + 210 ? " ..." : "");
    const title = hit.heading && hit.heading !== hit.page ? "<b>" + marked(hit.heading, wanted) + "</b> <small>in " + escaped(hit.page) + "</small>"
                                                          : "<b>" + marked(hit.page, wanted) + "</b>";
    return '<a class="hit" href="' + root + hit.address + '">' + title + "<p>" + marked(piece, wanted) + "</p></a>";
  }

  function show(box, query, most) {
    const hits = look(query), wanted = words(query);
    box.innerHTML = hits.length ? hits.slice(0, most).map((h) => shown(h, wanted)).join("")
                                : '<div class="none">Nothing has all of these words.</div>';
    return hits.length;
  }

  const input = document.querySelector("#search"), found = document.querySelector("#found");
  let chosen = -1;
  function choose(step) {
    const hits = [...found.querySelectorAll(".hit")];
    if (!hits.length) return;
    chosen = (chosen + step + hits.length) % hits.length;
    hits.forEach((h, k) => h.classList.toggle("chosen", k === chosen));
    hits[chosen].scrollIntoView({block: "nearest"});
  }
  input.addEventListener("input", () => {
    chosen = -1;
    found.style.display = input.value.trim() ? "block" : "none";
    if (input.value.trim()) show(found, input.value, 12);
  });
  input.addEventListener("focus", () => { if (input.value.trim()) found.style.display = "block"; });
  input.addEventListener("keydown", (event) => {
    if (event.key === "ArrowDown") choose(1), event.preventDefault();
    else if (event.key === "ArrowUp") choose(-1), event.preventDefault();
    else if (event.key === "Escape") found.style.display = "none";
    else if (event.key === "Enter") {
      const hit = found.querySelector(".chosen");
      location.href = hit ? hit.href : root + "find.html?q=" + encodeURIComponent(input.value);
    }
  });
  document.addEventListener("click", (event) => {
    if (!event.target.closest(".search")) found.style.display = "none";
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "/" && !/INPUT|TEXTAREA/.test(document.activeElement.tagName)) input.focus(), event.preventDefault();
  });

  const page = document.querySelector("#page-search");
  if (page) {
    const results = document.querySelector("#results"), number = document.querySelector("#number");
    const update = () => {
      const q = page.value.trim();
      const n = q ? show(results, q, 60) : (results.innerHTML = "", 0);
      number.textContent = q ? n + (n === 1 ? " section" : " sections") : "";
    };
    page.value = new URLSearchParams(location.search).get("q") || "";
    page.addEventListener("input", update);
    update();
    page.focus();
  }

  document.querySelectorAll(".block:not(.formula)").forEach((block) => {
    const button = document.createElement("button");
    button.className = "copy";
    button.textContent = "Copy";
    button.addEventListener("click", () => {
      const text = block.querySelector("pre").innerText;
      const done = () => { button.textContent = "Copied"; setTimeout(() => (button.textContent = "Copy"), 1200); };
      const by_selection = () => {  // where pages from files may not use the clipboard
        const area = document.createElement("textarea");
        area.value = text;
        document.body.append(area);
        area.select();
        document.execCommand("copy");
        area.remove();
        done();
      };
      if (navigator.clipboard) navigator.clipboard.writeText(text).then(done, by_selection);
      else by_selection();
    });
    block.append(button);
  });

  document.querySelector("#menu").addEventListener("click", () => document.body.classList.toggle("open"));
  const here = document.querySelector("nav.pages .here");
  if (here) {
    const group = here.closest("details");
    if (group) group.open = true;
    const nav = document.querySelector("nav.pages"), top = here.offsetTop - nav.clientHeight / 2;
    if (top > 0) nav.scrollTop = top;
  }
})();
