// nevh: a live page.  The scripts below are compressed; they are in nevh's
// sources, in web/.  SPDX-License-Identifier: GPL-3.0-or-later
"use strict";
// "LENGTH LETTERS", as kit.sh writes them, as bytes.
const nevhBytes = (packed) => {
  const [length, text] = packed.split(" ");
  const bytes = new Uint8Array(+length + 2);
  const value = (i) => text.charCodeAt(i) - 35 - (text.charCodeAt(i) > 60);
  for (let i = 0, n = 0, bits = 0, left = 0; i < text.length; i += 2) {
    bits |= value(i) + 91 * value(i + 1) << left;
    for (left += 13; left > 7; left -= 8) {
      bytes[n++] = bits;
      bits >>= 8;
    }
  }
  return bytes.subarray(0, +length);
};
const nevhUnpack = (id) => {
  const bytes = nevhBytes(document.getElementById(id).textContent);
  const stream = new Blob([bytes]).stream()
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
