// Reads what packed.rs writes: base64, deflated; variable-length whole numbers; columns of predicted values.
'use strict';
const PinwheelPacked = (() => {
  // For browsers without DecompressionStream: RFC 1951, bit by bit.
  function inflate(bytes) {
    let [at, bit, hold] = [0, 0, 0];
    const bits = (n) => {
      while (bit < n) { hold |= bytes[at] << bit; at += 1; bit += 8; }
      const value = hold & ((1 << n) - 1);
      hold >>>= n;
      bit -= n;
      return value;
    };
    // Codes of a Huffman table by length: how many, and the symbols in order.
    const table = (lengths) => {
      const counts = new Uint16Array(16);
      lengths.forEach((n) => { if (n) counts[n] += 1; });
      const starts = new Uint16Array(17);
      for (let n = 1; n < 16; n += 1) starts[n + 1] = starts[n] + counts[n];
      const symbols = new Uint16Array(lengths.length);
      lengths.forEach((n, symbol) => { if (n) { symbols[starts[n]] = symbol; starts[n] += 1; } });
      return { counts, symbols };
    };
    const symbol = ({ counts, symbols }) => {
      let [code, first, index] = [0, 0, 0];
      for (let n = 1; n < 16; n += 1) {
        code |= bits(1);
        if (code - counts[n] < first) return symbols[index + code - first];
        index += counts[n];
        first = (first + counts[n]) << 1;
        code <<= 1;
      }
      throw new Error('damaged data');
    };
    const steps = (count, group, first) => {
      let value = first;
      return Array.from({ length: count }, (_, k) => {
        const extra = Math.max(0, Math.floor(k / group) - 1);
        const step = [value, extra];
        value += 1 << extra;
        return step;
      });
    };
    const LENGTHS = [...steps(28, 4, 3), [258, 0]];
    const DISTANCES = steps(30, 2, 1);
    const fill = (...parts) => parts.flatMap(([count, value]) => Array(count).fill(value));
    const FIXED = [table(fill([144, 8], [112, 9], [24, 7], [8, 8])), table(fill([30, 5]))];
    const ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
    function tables() {
      const [literals, distances, codes] = [bits(5) + 257, bits(5) + 1, bits(4) + 4];
      const small = new Array(19).fill(0);
      for (let k = 0; k < codes; k += 1) small[ORDER[k]] = bits(3);
      const code = table(small);
      const lengths = [];
      while (lengths.length < literals + distances) {
        const next = symbol(code);
        if (next < 16) lengths.push(next);
        else {
          const [value, base, extra] = [[lengths[lengths.length - 1], 3, 2], [0, 3, 3], [0, 11, 7]][next - 16];
          lengths.push(...fill([base + bits(extra), value]));
        }
      }
      return [table(lengths.slice(0, literals)), table(lengths.slice(literals))];
    }
    const out = [];
    for (let last = 0; !last;) {
      last = bits(1);
      const kind = bits(2);
      if (kind === 0) {
        [bit, hold] = [0, 0];
        const length = bytes[at] | (bytes[at + 1] << 8);
        at += 4;
        for (let k = 0; k < length; k += 1) out.push(bytes[at + k]);
        at += length;
      } else {
        const [literals, distances] = kind === 1 ? FIXED : tables();
        for (let next = symbol(literals); next !== 256; next = symbol(literals)) {
          if (next < 256) out.push(next);
          else {
            const [length, more] = LENGTHS[next - 257];
            const count = length + bits(more);
            const [distance, extra] = DISTANCES[symbol(distances)];
            const back = distance + bits(extra);
            for (let k = 0; k < count; k += 1) out.push(out[out.length - back]);
          }
        }
      }
    }
    return Uint8Array.from(out);
  }

  /** The bytes behind a packed text. */
  async function unpack(text) {
    const raw = atob(text);
    const packed = new Uint8Array(raw.length);
    for (let k = 0; k < raw.length; k += 1) packed[k] = raw.charCodeAt(k);
    let stream = null;
    try { stream = new DecompressionStream('deflate-raw'); } catch { return inflate(packed); }
    // Written by hand: a blob would travel through another process.
    const writer = stream.writable.getWriter();
    writer.write(packed);
    writer.close();
    return new Uint8Array(await new Response(stream.readable).arrayBuffer());
  }

  /** Values that share a quantum; as in packed.rs. */
  const BLOCK = 32;
  function reader(bytes) {
    let at = 0;
    // Numbers may have more than 32 bits.
    const number = () => {
      for (let [value, scale] = [0, 1]; ; scale *= 128) {
        const byte = bytes[at];
        at += 1;
        value += (byte & 127) * scale;
        if (byte < 128) return value;
      }
    };
    const signed = () => { const v = number(); return v % 2 === 0 ? v / 2 : -(v + 1) / 2; };
    const places = () => {
      let last = 0;
      return Array.from({ length: number() }, () => { last += number(); return last; });
    };
    const column = () => {
      const values = new Float64Array(number());
      const edges = [...places(), values.length];
      let kept = 0;
      edges.forEach((edge, k) => { if (k % 2 === 0) kept += edge - (k ? edges[k - 1] : 0); });
      const order = number();
      let exponent = 0;
      const quanta = Array.from({ length: Math.ceil(kept / BLOCK) }, () => { exponent += signed(); return 2 ** exponent; });
      let [one, two, k, edge] = [0, 0, 0, 0];
      for (let n = 0; n < values.length; n += 1) {
        while (edges[edge] === n) edge += 1;
        if (edge % 2 === 1) values[n] = NaN;
        else {
          const predicted = order === 0 ? 0 : order === 1 ? one : 2 * one - two;
          two = one;
          one = predicted + signed() * quanta[Math.floor(k / BLOCK)];
          values[n] = one;
          k += 1;
        }
      }
      return values;
    };
    return { places, column };
  }
  return { unpack, reader };
})();
