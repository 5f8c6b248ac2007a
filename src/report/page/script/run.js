// The results of a run: images of all slots with their errors, means with their replicates.

import { bytes, logarithms, means } from '#page/decode.js';

/** @import { Answer, Data, Layer, Slot, World } from '#page/types.js' */

/** Sums over the tiles of a 16 × 16 grid, by tile, slot and channel, with the deviations of the replicates. */
export const TILES = 16;

export class Run {
  /** @param {Data} data */
  constructor(data) {
    this.data = data;
    this.pixels = data.width * data.height;
    /** Images by layer. @type {Map<string, Float32Array>} */
    this.means = new Map();
    /** Standard errors by layer. @type {Map<string, Float32Array>} */
    this.errors = new Map();
    /** @type {Map<World, Float32Array>} */
    this.tiles = new Map();
    /** @type {Map<string, Float32Array>} */
    this.early = new Map();
  }

  /** Unpacks all images. */
  async load() {
    const { layers, early, worlds } = this.data;
    await Promise.all([
      ...layers.map((layer) => this.#layer(layer)),
      ...early.map(async (layer) => {
        this.early.set(layer.id, logarithms(await bytes(`px-${layer.id}`), this.pixels, layer.codes));
      }),
      ...worlds.map(async (answer) => {
        const sums = (1 + answer.deviation.length) * answer.mean.length * TILES * TILES;
        this.tiles.set(answer.world, means(await bytes(`tiles-${answer.world}`), sums, answer.tiles));
      }),
    ]);
  }

  /** @param {Layer} layer */
  async #layer(layer) {
    const [all, n] = [await bytes(`px-${layer.id}`), this.pixels];
    let errors = all;
    if (layer.exponent !== null) {
      this.means.set(layer.id, means(all, n, layer.exponent));
      errors = all.subarray(6 * n);
    }
    this.errors.set(layer.id, logarithms(errors, n, layer.codes));
  }

  /**
   * The results by rays or by the matrix; nothing for the picture of the reader.
   * @param {World} world
   * @returns {Answer | undefined}
   */
  answer(world) {
    return this.data.worlds.find((a) => a.world === world);
  }

  /** @param {World} world @param {Slot} slot */
  layer(world, slot) {
    return this.data.layers.find((l) => l.world === world && l.slot === slot);
  }

  /** True if the world has an image of each term. @param {World} world */
  hasTerms(world) {
    return this.layer(world, 0) !== undefined;
  }

  /**
   * The images that make up the whole, in the order of the slots: the terms and, if it is known, the rest.
   * @param {World} world
   * @returns {Float32Array[]}
   */
  parts(world) {
    /** @type {Slot[]} */
    const terms = Array.from({ length: this.data.max_bounces + 1 }, (_, k) => k);
    /** @type {Slot[]} */
    const slots = this.hasTerms(world) ? [...terms, 'rest'] : ['whole'];
    return slots.flatMap((slot) => this.means.get(this.layer(world, slot)?.id ?? '') ?? []);
  }

  /**
   * Standard errors of these images; the error of the whole is its own layer.
   * @param {World} world @param {Slot} slot
   */
  error(world, slot) {
    return this.errors.get(this.layer(world, slot)?.id ?? '');
  }

  /**
   * The image after the first samples, if it was kept.
   * @param {Slot} slot @param {number} spp
   */
  first(slot, spp) {
    const layer = this.data.early.find((l) => l.slot === slot && l.spp === spp);
    return layer && this.early.get(layer.id);
  }
}
