// Means of weighted sums of slots with their errors.
//
//   m = Σ_j w_j m_j          se² = Σ_jk w_j w_k cov_jk = R/(R−1) Σ_r (Σ_j w_j d_rj)²
//
// The slots of one path are correlated, so the errors do not follow from those of the slots. The replicates give them.

import { TILES } from '#page/run.js';

/** @import { Answer } from '#page/types.js' */
/** @import { Run } from '#page/run.js' */

/**
 * A mean with its standard error by channel; the error is NaN where none is known.
 * @typedef {{mean: number[], error: number[]}} Measured
 */

/** @param {number} replicates */
const factor = (replicates) => (replicates > 1 ? replicates / (replicates - 1) : NaN);

/**
 * The image mean of Σ_j w_j X_j.
 * @param {Answer} answer
 * @param {ArrayLike<number>[]} weights by slot and channel
 * @returns {Measured}
 */
export function imageMean(answer, weights) {
  return [0, 1, 2].reduce((out, c) => {
    const sum = (/** @type {number[][]} */ of) => weights.reduce((a, w, j) => (w[c] ? a + w[c] * of[j][c] : a), 0);
    const squares = answer.deviation.reduce((a, d) => a + sum(d) ** 2, 0);
    out.mean.push(sum(answer.mean));
    out.error.push(Math.sqrt(factor(answer.deviation.length) * squares));
    return out;
  }, /** @type {Measured} */ ({ mean: [], error: [] }));
}

/**
 * The mean of Σ_j w_j X_j over a block of tiles, with the error from the replicates.
 * @param {Run} run
 * @param {Answer} answer
 * @param {[number, number, number, number]} block left, top, right, bottom in tiles
 * @param {ArrayLike<number>[]} weights
 * @returns {Measured}
 */
export function blockMean(run, answer, [left, top, right, bottom], weights) {
  const sums = /** @type {Float32Array} */ (run.tiles.get(answer.world));
  const [slots, replicates] = [answer.mean.length, answer.deviation.length];
  const [total, pixels] = [Array.from({ length: 1 + replicates }, () => [0, 0, 0]), pixelsOf(run, left, top, right, bottom)];
  for (let y = top; y < bottom; y += 1) {
    for (let x = left; x < right; x += 1) {
      for (let s = 0; s < slots; s += 1) {
        const start = ((y * TILES + x) * slots + s) * (1 + replicates);
        for (let r = 0; r <= replicates; r += 1) {
          for (let c = 0; c < 3; c += 1) total[r][c] += (weights[s]?.[c] ?? 0) * sums[3 * (start + r) + c];
        }
      }
    }
  }
  const squares = [0, 1, 2].map((c) => total.slice(1).reduce((a, d) => a + (d[c] / pixels) ** 2, 0));
  return {
    mean: total[0].map((v) => v / pixels),
    error: squares.map((v) => Math.sqrt(factor(replicates) * v)),
  };
}

/**
 * Number of pixels of the run in a block of tiles. Pixel x of w is in tile ⌊16 x/w⌋.
 * @param {Run} run @param {number} left @param {number} top @param {number} right @param {number} bottom
 */
function pixelsOf(run, left, top, right, bottom) {
  const [width, height] = run.data.full;
  const edge = (/** @type {number} */ tile, /** @type {number} */ size) => Math.ceil((tile * size) / TILES);
  return (edge(right, width) - edge(left, width)) * (edge(bottom, height) - edge(top, height));
}

/**
 * Mean over the channels, and the mean of their errors: the noise of the channels is that of the same paths.
 * @param {Measured} m
 * @returns {[number, number]}
 */
export function average({ mean, error }) {
  const third = (/** @type {number[]} */ v) => (v[0] + v[1] + v[2]) / 3;
  return [third(mean), third(error)];
}
