// nevh: a live page.  The scripts below are compressed; they are in nevh's
// sources, in web/.  SPDX-License-Identifier: GPL-3.0-or-later
"use strict";
const nevhUnpack = (id) => {
  const letters = "!#$%*+,-./0123456789:;=?@ABCDEFGHIJKLMNOPQRSTUVWXYZ" +
    "[]^_abcdefghijklmnopqrstuvwxyz{|}~", value = [];
  for (let i = 0; i < 85; i++) value[letters.charCodeAt(i)] = i;
  const [length, text] = document.getElementById(id).textContent.split(" ");
  const bytes = new DataView(new ArrayBuffer(text.length / 5 * 4));
  for (let i = 0; i < text.length / 5; i++) {
    let four = 0;
    for (let j = 0; j < 5; j++) four = 85 * four + value[text.charCodeAt(5 * i + j)];
    bytes.setUint32(4 * i, four);
  }
  const stream = new Blob([bytes.buffer.slice(0, length)]).stream()
    .pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream);
};
nevhUnpack("scripts").text().then((text) => {
  const script = document.createElement("script");
  script.textContent = text;
  document.body.append(script);
}).catch((error) => {
  document.body.textContent = "This browser cannot unpack the page: " + error.message;
});
