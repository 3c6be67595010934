/* The search of the manual's site: sections that have all the words.
   SPDX-License-Identifier: GPL-3.0-or-later */
"use strict";

const field = document.getElementById("search");
const list = document.getElementById("found");
const MOST = 20, AROUND = 70;
const plain = (html) => new DOMParser().parseFromString(html, "text/html")
  .documentElement.textContent;

/* The order of the sections that are found: words in the title count more. */
function weigh(words, [, title, text]) {
  const head = title.toLowerCase(), body = text.toLowerCase();
  let sum = 0;
  for (const word of words) {
    const times = body.split(word).length - 1;
    if (!head.includes(word) && times === 0) {
      return 0;
    }
    sum += (head.includes(word) ? 100 : 0) + Math.min(times, 10);
  }
  return sum;
}

function excerpt(word, text) {
  const at = Math.max(0, text.toLowerCase().indexOf(word));
  return plain(text.slice(Math.max(0, at - AROUND), at + word.length + AROUND));
}

function show() {
  const words = field.value.toLowerCase().split(/\s+/).filter((word) => word);
  list.hidden = words.length === 0;
  list.replaceChildren();
  if (words.length === 0) {
    return;
  }
  const found = siteEntries.map((entry) => [weigh(words, entry), entry])
    .filter(([weight]) => weight > 0).sort((a, b) => b[0] - a[0]);
  for (const [, [page, title, text]] of found.slice(0, MOST)) {
    const item = document.createElement("li"), link = document.createElement("a");
    link.href = page;
    link.textContent = plain(title);
    item.append(link, " ", excerpt(words[0], text));
    list.append(item);
  }
  if (found.length === 0) {
    list.textContent = "No section has all these words.";
  }
}

field.addEventListener("input", show);
field.form.addEventListener("submit", (event) => {
  event.preventDefault();
  const first = list.querySelector("a");
  if (first) {
    location.href = first.href;
  }
});
