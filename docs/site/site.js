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

  // All words must occur; those in headings count most, then whole words, then how often they occur.
  function look(query) {
    const wanted = words(query);
    if (!wanted.length) return [];
    const hits = [];
    for (const [page, heading, address, text, kind] of SILT_INDEX) {
      const low = {page: plain(page), heading: plain(heading), text: plain(text)};
      let score = kind === "policy" ? 4 : kind === "log" ? -12 : 0;
      for (const w of wanted) {
        let own = 0;
        if (low.heading === w) own += 60;
        else if (low.heading.split(/[^\p{L}\p{N}_]+/u).includes(w)) own += 30;
        else if (low.heading.includes(w)) own += 18;
        if (low.page.includes(w)) own += 12;
        let at = low.text.indexOf(w), times = 0;
        for (; at >= 0 && times < 6; at = low.text.indexOf(w, at + w.length)) ++times;
        own += 2 * times;
        if (own === 0) { score = -1e9; break; }
        score += own;
      }
      if (wanted.length > 1) {
        const phrase = wanted.join(" ");
        if (low.heading.includes(phrase)) score += 40;
        if (low.text.includes(phrase)) score += 15;
      }
      if (score > -1e8) hits.push({page, heading, address, text, score});
    }
    return hits.sort((a, b) => b.score - a.score);
  }

  function marked(text, wanted) {
    const alternatives = wanted.map((w) => w.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("|");
    return text.split(new RegExp("(" + alternatives + ")", "gi"))
        .map((part, k) => (k % 2 ? "<mark>" + escaped(part) + "</mark>" : escaped(part))).join("");
  }

  function shown(hit, wanted) {
    const low = plain(hit.text);
    let at = Math.min(...wanted.map((w) => low.indexOf(w)).filter((k) => k >= 0).concat([1e9]));
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
