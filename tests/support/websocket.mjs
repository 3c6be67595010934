// The client's side of a WebSocket (RFC 6455), for tests of pages: messages of text,
// which Node before version 22 has no class for.
import { randomBytes } from "node:crypto";
import { request } from "node:http";

// Bytes of a frame of text, masked as a client's are.
function frame(text) {
  const bytes = Buffer.from(text), mask = randomBytes(4);
  const [code, more] = bytes.length < 126 ? [bytes.length, 0]
    : bytes.length < 65536 ? [126, 2] : [127, 8];
  const head = Buffer.alloc(2 + more);
  head.set([0x81, 0x80 | code]);
  if (more) head.writeUIntBE(bytes.length, 2 + more - Math.min(more, 6),
    Math.min(more, 6));
  return Buffer.concat([head, mask, bytes.map((byte, i) => byte ^ mask[i % 4])]);
}

// The first frame of what was received: [end, code, payload, last], if it is whole.
function first(bytes) {
  if (bytes.length < 2) return null;
  const short = bytes[1] & 127, from = short < 126 ? 2 : short === 126 ? 4 : 10;
  if (bytes.length < from) return null;
  const size = short < 126 ? short : short === 126 ? bytes.readUInt16BE(2)
    : Number(bytes.readBigUInt64BE(2));
  if (bytes.length < from + size) return null;
  return [from + size, bytes[0] & 15, bytes.subarray(from, from + size),
    bytes[0] & 128];
}

// Connects to ws://127.0.0.1:PORT/PATH; hear(text) takes messages; the result sends.
export function connect(port, path, hear) {
  const asked = request({ host: "127.0.0.1", port, path, headers: {
    Connection: "Upgrade", Upgrade: "websocket", "Sec-WebSocket-Version": 13,
    "Sec-WebSocket-Key": randomBytes(16).toString("base64") } });
  asked.end();
  return new Promise((resolve, reject) => {
    asked.once("error", reject);
    asked.once("response", (answer) =>
      reject(new Error("no WebSocket: status " + answer.statusCode)));
    asked.once("upgrade", (answer, socket, head) => {
      let rest = head, parts = [];
      const take = (bytes) => {
        rest = Buffer.concat([rest, bytes]);
        for (let one; (one = first(rest)); rest = rest.subarray(one[0])) {
          const [, code, payload, last] = one;
          if (code > 2) continue; // of control: a test neither pings nor closes
          parts.push(payload);
          if (!last) continue;
          hear(Buffer.concat(parts).toString("utf8"));
          parts = [];
        }
      };
      socket.on("data", take);
      socket.on("error", () => {});
      take(Buffer.alloc(0));
      resolve((text) => socket.write(frame(text)));
    });
  });
}
