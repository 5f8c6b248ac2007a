// Images from the bytes in the page.
//
//   mean      v = 2^e · h, h a half float                  relative error ≤ 2⁻¹¹
//   positive  v = 2^(l + s (code − 1)), code = 1, …, 253    relative error ≤ 2^(s/2) − 1
//
// `report/page/codes.rs` writes them; the order of the bytes is described there.

/**
 * The bytes of an element: base64 of a zlib stream.
 * @param {string} id
 * @returns {Promise<Uint8Array>}
 */
export async function bytes(id) {
  const text = document.getElementById(id)?.textContent;
  if (!text) throw new Error(`the page has no element ${id}`);
  return inflate(fromBase64(text));
}

/** @param {string} text @returns {Uint8Array<ArrayBuffer>} */
function fromBase64(text) {
  // browsers since 2025 do it themselves, ten times as fast
  const own = /** @type {{fromBase64?: (text: string) => Uint8Array<ArrayBuffer>}} */ (/** @type {unknown} */ (Uint8Array)).fromBase64;
  if (own) return own.call(Uint8Array, text);
  const characters = atob(text);
  const out = new Uint8Array(characters.length);
  for (let i = 0; i < out.length; i += 1) out[i] = characters.charCodeAt(i);
  return out;
}

/**
 * @param {Uint8Array<ArrayBuffer>} packed a zlib stream
 * @returns {Promise<Uint8Array>}
 */
export async function inflate(packed) {
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The value of every half float. @type {Float32Array | undefined} */
let halves;

/** @returns {Float32Array} */
export function halfFloats() {
  if (halves) return halves;
  halves = new Float32Array(1 << 16);
  for (let bits = 0; bits < halves.length; bits += 1) {
    const [sign, e, m] = [bits & 0x8000 ? -1 : 1, (bits >> 10) & 31, bits & 1023];
    const special = m ? NaN : Infinity;
    halves[bits] = sign * (e === 31 ? special : e === 0 ? m * 2 ** -24 : (1 + m / 1024) * 2 ** (e - 15));
  }
  return halves;
}

/**
 * Half floats, three for each of n pixels, from planes of high and low bytes.
 * @param {Uint8Array} from
 * @param {number} n
 * @param {number} exponent
 */
export function means(from, n, exponent) {
  const [table, scale, out] = [halfFloats(), 2 ** exponent, new Float32Array(3 * n)];
  for (let c = 0; c < 3; c += 1) {
    const [high, low] = [c * n, (3 + c) * n];
    for (let i = 0; i < n; i += 1) out[3 * i + c] = scale * table[(from[high + i] << 8) | from[low + i]];
  }
  return out;
}

/**
 * Logarithmic codes, three for each of n pixels.
 * @param {Uint8Array} from
 * @param {number} n
 * @param {[number, number]} codes lowest logarithm and step
 */
export function logarithms(from, n, [lowest, step]) {
  const table = new Float32Array(256);
  for (let code = 1; code < 254; code += 1) table[code] = 2 ** (lowest + step * (code - 1));
  [table[254], table[255]] = [Infinity, NaN];
  const out = new Float32Array(3 * n);
  for (let i = 0; i < n; i += 1) {
    const red = from[i];
    out[3 * i] = table[red];
    out[3 * i + 1] = table[(red + from[n + i]) & 255];
    out[3 * i + 2] = table[(red + from[2 * n + i]) & 255];
  }
  return out;
}
