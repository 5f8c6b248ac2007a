// From radiance to the colours of the screen.
//
//   sRGB          code = round(255 · s(gain · L + offset))     s: transfer curve of IEC 61966-2-1 (1999), no tone mapping
//   false colour  log₂ of the luminance, from 2⁻⁸ to 2⁰ after the gain, in the colours of viridis (Smith and van der Walt, CC0)
//   signed        mean of the channels, −1 blue … 0 white … +1 orange after the gain
//
// A pixel that is not finite is magenta.

/** @import { Look } from '#page/types.js' */

/** @param {number} v linear, 0 to 1 */
export const srgb = (v) => (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
/** @param {number} v encoded, 0 to 1 */
export const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);

/** Smallest linear value of each code. */
const EDGES = Float64Array.from({ length: 257 }, (_, code) => (code === 0 ? 0 : code > 255 ? 2 : linear((code - 0.5) / 255)));
const BINS = 1 << 16;
/** The code at the start of each of 2¹⁶ intervals. At most one edge lies within an interval. */
const CODES = Uint8Array.from({ length: BINS + 1 }, (_, bin) => Math.round(255 * srgb(bin / BINS)));

/** The code of a linear value between 0 and 1. @param {number} v */
export function code(v) {
  const low = CODES[(v * BINS) | 0];
  return v >= EDGES[low + 1] ? low + 1 : v < EDGES[low] ? low - 1 : low;
}

const VIRIDIS = ['440154', '482878', '3e4a89', '31688e', '26828e', '1f9e89', '35b779', '6ece58', 'b5de2b', 'fde725'];
const SIGNED = ['08306b', '2171b5', '6baed6', 'c6dbef', 'f7f7f7', 'fdd0a2', 'fd8d3c', 'd94801', '7f2704'];

/** 256 colours between those given. @param {string[]} stops */
function ramp(stops) {
  const rgb = stops.map((s) => [0, 2, 4].map((i) => parseInt(s.slice(i, i + 2), 16)));
  return Array.from({ length: 256 }, (_, i) => {
    const at = (i / 255) * (stops.length - 1);
    const j = Math.min(Math.floor(at), stops.length - 2);
    return rgb[j].map((v, c) => Math.round(v + (at - j) * (rgb[j + 1][c] - v)));
  });
}
const RAMPS = { false: ramp(VIRIDIS), signed: ramp(SIGNED) };

/** Powers of two that false colours span, up to 1. */
export const OCTAVES = 8;

/** @param {number} r @param {number} g @param {number} b */
const luminance = (r, g, b) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

/**
 * Numbers of pixels with a component above 1, below 0, or not finite.
 * @typedef {{clipped: number, negative: number, nonFinite: number}} Counts
 */

/**
 * Writes the colours of an image.
 * @param {Float32Array} pixels
 * @param {{gain: number, offset: number, look: Look}} how
 * @param {Uint8ClampedArray} out four bytes per pixel
 * @returns {Counts}
 */
export function tone(pixels, { gain, offset, look }, out) {
  const counts = { clipped: 0, negative: 0, nonFinite: 0 };
  for (let i = 0, o = 0; i < pixels.length; i += 3, o += 4) {
    const [r, g, b] = [gain * pixels[i] + offset, gain * pixels[i + 1] + offset, gain * pixels[i + 2] + offset];
    out[o + 3] = 255;
    if (!Number.isFinite(r + g + b)) {
      counts.nonFinite += 1;
      out[o] = out[o + 2] = 255;
      out[o + 1] = 0;
    } else if (look === 'srgb') {
      if (r > 1 || g > 1 || b > 1) counts.clipped += 1;
      if (r < 0 || g < 0 || b < 0) counts.negative += 1;
      out[o] = code(r < 0 ? 0 : r > 1 ? 1 : r);
      out[o + 1] = code(g < 0 ? 0 : g > 1 ? 1 : g);
      out[o + 2] = code(b < 0 ? 0 : b > 1 ? 1 : b);
    } else {
      const t = look === 'false' ? 1 + Math.log2(Math.max(luminance(r, g, b), 1e-30)) / OCTAVES : 0.5 + (r + g + b) / 6;
      if (t > 1) counts.clipped += 1;
      if (t < 0) counts.negative += 1;
      const rgb = RAMPS[look][Math.max(0, Math.min(255, (t * 255 + 0.5) | 0))];
      [out[o], out[o + 1], out[o + 2]] = rgb;
    }
  }
  return counts;
}

/** The colours of a look from left to right, for a legend. @param {'false' | 'signed'} look */
export const gradient = (look) => RAMPS[look].filter((_, i) => i % 17 === 0).map((rgb) => `rgb(${rgb.join(' ')})`).join(', ');

/**
 * The gain out of …, 1/2, 1/1.5, 1, 1.5, 2, 3, 4, … that brings the 99th percentile of the luminance nearest to 0.8, as in the
 * PNG files. Pixels in which `lamps` is not black are left out, unless there are no others.
 * @param {Float32Array} pixels
 * @param {Float32Array} [lamps]
 */
export function autoGain(pixels, lamps) {
  const [all, walls] = [new Float32Array(pixels.length / 3), new Float32Array(pixels.length / 3)];
  let [n, m] = [0, 0];
  for (let i = 0; i < pixels.length; i += 3) {
    const y = luminance(pixels[i], pixels[i + 1], pixels[i + 2]);
    if (!Number.isFinite(y)) continue;
    all[n] = y;
    n += 1;
    if (lamps && luminance(lamps[i], lamps[i + 1], lamps[i + 2]) === 0) {
      walls[m] = y;
      m += 1;
    }
  }
  return gainFor(m > 0 ? walls.subarray(0, m) : all.subarray(0, n));
}

/** @param {Float32Array} values finite */
function gainFor(values) {
  let bright = percentile(values);
  if (bright <= 0) bright = percentile(values.filter((v) => v > 0));
  return bright > 0 ? nearest(0.8 / bright) : 1;
}

/**
 * The value that 99 % of all do not exceed; 0 if that is not positive. The bits of positive floats are in the order of their values, so
 * the upper half of the bits finds the place, and only the values there are sorted.
 * @param {Float32Array} values
 */
function percentile(values) {
  const [bits, counts] = [new Uint32Array(values.buffer, values.byteOffset, values.length), new Uint32Array(1 << 15)];
  let wanted = Math.max(Math.ceil(values.length * 0.99), 1);
  for (let i = 0; i < bits.length; i += 1) {
    if (values[i] > 0) counts[bits[i] >>> 16] += 1;
    else wanted -= 1;
  }
  if (wanted <= 0) return 0;
  let bin = 0;
  for (; bin < counts.length && counts[bin] < wanted; bin += 1) wanted -= counts[bin];
  return values.filter((v, i) => v > 0 && bits[i] >>> 16 === bin).sort()[wanted - 1] ?? 0;
}

/** @param {number} gain */
function nearest(gain) {
  const up = Math.max(gain, 1 / gain);
  const power = 2 ** Math.floor(Math.log2(up));
  const best = [power, 1.5 * power, 2 * power].reduce((a, b) => (Math.abs(Math.log(b / up)) < Math.abs(Math.log(a / up)) ? b : a));
  return gain >= 1 ? best : 1 / best;
}

/** The gain that brings the 99th percentile of |v| to 0.8: for differences. @param {Float32Array} pixels */
export function signedGain(pixels) {
  return gainFor(pixels.map(Math.abs).filter(Number.isFinite));
}
