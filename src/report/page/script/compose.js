// The images that the page shows: weighted sums of slots, and their difference from a reference.
//
//   a = Σ_j w_j X_j        difference a − b        relative (a − b)/b        z = Σ_c (a − b) / √((Σ_c se_a)² + (Σ_c se_b)²)
//
// The channels of a pixel come from the same paths, so their errors are added without a root in z.

import { cut, untouched, weights } from '#page/scale.js';
import { nameOf } from '#page/state.js';

/** @import { Slot, State, Subject, World } from '#page/types.js' */
/** @import { Run } from '#page/run.js' */

/**
 * Errors of pixels; `most` if they are upper bounds.
 * @typedef {{values: Float32Array, most: boolean}} Errors
 */

export class Composer {
  /** Images that stay: those without a changed series. @type {Map<string, Float32Array>} */
  #kept = new Map();
  /** Memory of the images that change while a slider moves. @type {Map<string, Float32Array>} */
  #scratch = new Map();

  /** @param {Run} run */
  constructor(run) {
    this.run = run;
    /** The picture of the reader, and its errors if they are known. @type {{pixels: Float32Array, errors: Float32Array | null, eightBit: boolean} | null} */
    this.own = null;
  }

  /** @param {string} name */
  #buffer(name) {
    const found = this.#scratch.get(name) ?? new Float32Array(3 * this.run.pixels);
    this.#scratch.set(name, found);
    return found;
  }

  /**
   * The pixels of an image: red, green and blue of each.
   * @param {Subject} subject
   * @param {State} state
   * @param {string} [place] images of different places exist at the same time
   * @returns {Float32Array}
   */
  pixels(subject, state, place = 'shown') {
    const { run } = this;
    if (subject.world === 'own') return this.own?.pixels ?? this.#buffer('none');
    const first = this.#first(subject, state);
    if (first) return first;
    const parts = run.parts(subject.world);
    const all = weights(run, subject, state);
    const still = untouched(state) || (subject.kind === 'term' && state.scale.every((s) => s === 1));
    if (!still) return added(parts, all, this.#buffer(place));
    const used = all.flatMap((w, j) => (w[0] ? [j] : []));
    if (used.length === 1 && parts[used[0]]) return parts[used[0]];
    const name = nameOf(subject);
    const kept = this.#kept.get(name) ?? added(parts, all, new Float32Array(3 * run.pixels));
    this.#kept.set(name, kept);
    return kept;
  }

  /** The image of the first samples, if they are to be shown. @param {Subject} subject @param {State} state */
  #first({ world, kind, k }, { spp }) {
    if (spp === null || world !== 'terms') return undefined;
    const slot = kind === 'term' ? k : kind === 'whole' ? 'whole' : undefined;
    return slot === undefined ? undefined : this.run.first(slot, spp);
  }

  /** True if the first samples of this image were kept. @param {Subject} subject @param {State} state */
  isFirst(subject, state) {
    return this.#first(subject, state) !== undefined;
  }

  /**
   * Standard errors of the pixels: those of a slot or of the whole as measured, those of any other sum at most Σ_j w_j se_j.
   * @param {Subject} subject
   * @param {State} state
   * @returns {Errors | null}
   */
  errors(subject, state) {
    const { run } = this;
    const { world, kind } = subject;
    if (world === 'own') return this.own?.errors ? { values: this.own.errors, most: false } : null;
    if (this.isFirst(subject, state)) return null;
    if (!run.hasTerms(world) || (kind === 'whole' && untouched(state))) {
      const values = run.error(world, 'whole');
      return values ? { values, most: false } : null;
    }
    const all = weights(run, subject, state);
    const slots = all.map((_, j) => /** @type {Slot} */ (j > run.data.max_bounces ? 'rest' : j));
    const used = slots.filter((_, j) => all[j].some((w) => w !== 0));
    const parts = used.map((slot) => run.error(world, slot));
    if (parts.some((p) => p === undefined)) return null;
    const values = added(/** @type {Float32Array[]} */ (parts), used.map((slot) => all[slots.indexOf(slot)]), this.#buffer(`se ${world}`));
    return { values, most: used.length > 1 };
  }

  /**
   * One pixel of an image and its standard errors, without making the image.
   * @param {Subject} subject
   * @param {State} state
   * @param {number} i index of its red value
   * @returns {{rgb: number[], errors: number[]}}
   */
  at(subject, state, i) {
    const { run } = this;
    const { world, kind } = subject;
    const three = (/** @type {Float32Array | null | undefined} */ v) => [0, 1, 2].map((c) => (v ? v[i + c] : NaN));
    if (world === 'own') return { rgb: three(this.own?.pixels), errors: three(this.own?.errors) };
    const all = weights(run, subject, state);
    const sum = (/** @type {(Float32Array | undefined)[]} */ parts) =>
      [0, 1, 2].map((c) => parts.reduce((a, part, j) => (all[j][c] === 0 ? a : a + all[j][c] * (part ? part[i + c] : NaN)), 0));
    const rgb = sum(run.parts(world));
    if (!run.hasTerms(world) || (kind === 'whole' && untouched(state))) return { rgb, errors: three(run.error(world, 'whole')) };
    return { rgb, errors: sum(all.map((_, j) => run.error(world, j > run.data.max_bounces ? 'rest' : j))) };
  }

  /**
   * What the canvas shows: the image, or its difference from the reference. Nothing if the errors that it needs are not known.
   * @param {State} state
   * @param {Subject} [subject]
   * @returns {Float32Array | null}
   */
  shown(state, subject = state.subject) {
    const a = this.pixels(subject, state);
    if (state.metric === 'value') return a;
    const b = this.pixels(state.reference, state, 'reference');
    const out = this.#buffer('difference');
    if (state.metric === 'z') return this.#z(a, b, subject, state, out);
    const { metric } = state;
    for (let i = 0; i < out.length; i += 1) {
      const d = a[i] - b[i];
      out[i] = metric === 'difference' ? d : metric === 'absolute' ? Math.abs(d) : d / b[i];
    }
    return out;
  }

  /**
   * @param {Float32Array} a @param {Float32Array} b
   * @param {Subject} subject @param {State} state @param {Float32Array} out
   */
  #z(a, b, subject, state, out) {
    // the same paths made both, so their noise is the same
    if (subject.world === state.reference.world) return null;
    const [ea, eb] = [this.errors(subject, state)?.values, this.errors(state.reference, state)?.values];
    if (!ea || !eb) return null;
    for (let i = 0; i < out.length; i += 3) {
      const sum = (/** @type {Float32Array} */ v) => v[i] + v[i + 1] + v[i + 2];
      const [sa, sb] = [sum(ea), sum(eb)];
      // an error of 0 means that no light has reached the pixel yet, so its error is not known
      const z = sa > 0 && sb > 0 ? (sum(a) - sum(b)) / Math.hypot(sa, sb) : 0;
      out.fill(z, i, i + 3);
    }
    return out;
  }

  /** Pixels in which a lamp is seen. @param {World} world */
  lamps(world) {
    const from = this.run.hasTerms(world) ? world : this.run.data.worlds.find((a) => this.run.hasTerms(a.world))?.world;
    return from && this.run.means.get(this.run.layer(from, 0)?.id ?? '');
  }

  /** True if the whole of a world lacks the rest. @param {World} world */
  lacksRest(world) {
    return this.run.hasTerms(world) && cut(this.run, world);
  }
}

/**
 * Σ_j w_j X_j.
 * @param {Float32Array[]} images
 * @param {number[][]} all weights by image and channel
 * @param {Float32Array} out
 */
function added(images, all, out) {
  out.fill(0);
  images.forEach((image, j) => {
    const [r, g, b] = all[j];
    if (r === 0 && g === 0 && b === 0) return;
    for (let i = 0; i < out.length; i += 3) {
      out[i] += r * image[i];
      out[i + 1] += g * image[i + 1];
      out[i + 2] += b * image[i + 2];
    }
  });
  return out;
}
