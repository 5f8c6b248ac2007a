// Numbers and names as text, with the rules of the tables: significant digits, powers of ten outside 10⁻³ … 10⁵.

/** @import { Subject, World } from '#page/types.js' */

const SUPERSCRIPTS = '⁰¹²³⁴⁵⁶⁷⁸⁹';
const SUBSCRIPTS = '₀₁₂₃₄₅₆₇₈₉';

/** @param {number} k @param {string} digits */
const spelled = (k, digits) => [...String(k)].map((d) => (d === '-' ? '⁻' : digits[Number(d)])).join('');

/** @param {number} k */
export const superscript = (k) => spelled(k, SUPERSCRIPTS);
/** @param {number} k */
export const subscript = (k) => spelled(k, SUBSCRIPTS);

/**
 * @param {number | null | undefined} value
 * @param {number} [digits] significant digits
 */
export function significant(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  if (value === 0) return '0';
  const size = Math.abs(Number(value.toPrecision(digits)));
  const text = size >= 1e-3 && size < 1e5 ? plain(value, size, digits) : value.toExponential(digits - 1).replace('e+', 'e');
  return text.replaceAll('-', '−');
}

/** @param {number} value @param {number} size @param {number} digits */
function plain(value, size, digits) {
  return value.toFixed(Math.max(0, digits - 1 - Math.floor(Math.log10(size))));
}

/**
 * `0.1234 ± 0.0012`; without an error only the mean.
 * @param {number} mean @param {number} half
 */
export function plusMinus(mean, half) {
  if (half === Infinity) return `${significant(mean)} ± ∞`;
  if (!(half > 0)) return significant(mean);
  // both with the same decimals, of which the error has two that say something
  const decimals = 1 - Math.floor(Math.log10(Number(half.toPrecision(2))));
  if (decimals >= 0 && Math.abs(mean) >= 1e-3) return `${mean.toFixed(decimals).replace('-', '−')} ± ${half.toFixed(decimals)}`;
  const digits = Math.ceil(Math.log10(Math.abs(mean) / half)) + 2;
  return `${significant(mean, Math.min(Math.max(digits, 2), 6))} ± ${significant(half, 2)}`;
}

/** @param {number} fraction */
export const percent = (fraction) => `${significant(100 * fraction, 2)} %`;

/** @param {number} gain */
export const gainText = (gain) => (gain >= 1 ? `×${+gain.toPrecision(3)}` : `÷${+(1 / gain).toPrecision(3)}`);

/** @type {Record<World, string>} */
export const WORLD_NAMES = { terms: 'series', path: 'path tracer', radiosity: 'radiosity', own: 'your picture' };

/** True if two images are the same. @param {Subject} a @param {Subject} b */
export const same = (a, b) => a.world === b.world && a.kind === b.kind && a.k === b.k;

/** The symbol of what an image shows, such as T³E. @param {Subject} subject */
export function symbol({ world, kind, k }) {
  const t = world === 'radiosity' ? 'Tₕ' : 'T';
  switch (kind) {
    case 'term':
      return k === 0 ? 'E' : `${t}${k === 1 ? '' : superscript(k)}E`;
    case 'sum':
      return `S${subscript(k)}`;
    case 'rest':
      return 'rest';
    default:
      return 'L';
  }
}

/**
 * What an image shows, in words.
 * @param {Subject} subject @param {number} last K
 */
export function meaning({ world, kind, k }, last) {
  if (world === 'own') return 'your picture';
  const by = world === 'radiosity' ? 'by radiosity' : `by the ${WORLD_NAMES[world]}`;
  switch (kind) {
    case 'term':
      if (k === 0) return `light of the lamps, seen directly (${by})`;
      return `light scattered exactly ${k === 1 ? 'once' : k === 2 ? 'twice' : `${k} times`} (${by})`;
    case 'sum':
      return k === 0 ? `sum of the terms: only E (${by})` : `sum of the terms 0 to ${k} (${by})`;
    case 'rest':
      return `light scattered more than ${last} times (${by})`;
    default:
      return `the whole image ${by}`;
  }
}
