// The series with every scattering scaled by s: T becomes s T, and the light becomes
//
//   L(s) = Σ_k sᵏ TᵏE
//
// The terms up to K are known. The rest Σ_{k>K} TᵏE is known only as a whole:
//
//   0 ≤ Σ_{k>K} sᵏ TᵏE ≤ s^{K+1} · rest                     for s ≤ 1, since no term is negative
//   Σ_{k>K} sᵏ TᵏE ≈ s^{K+1} (1 − r)/(1 − s r) · rest       for s > 1, if the terms fall by the factor r
//
// The first is a bound, and it is exact at s = 1. The second is an extrapolation; it becomes infinite at s = 1/r, where the series
// diverges. No real surface reflects more than it receives, so s > 1/(largest albedo) is not physical.

/** @import { Data, State, Subject, World } from '#page/types.js' */
/** @import { Run } from '#page/run.js' */

/** The slider ends this close to the point where the series diverges. */
const NEARLY = 0.99;

/**
 * Factor of the rest: an upper bound for s ≤ 1, extrapolated for s > 1.
 * @param {number} s @param {number} last K
 * @param {number | null} rate
 */
export function restFactor(s, last, rate) {
  const power = s ** (last + 1);
  if (s <= 1) return power;
  if (rate === null || s * rate >= 1) return NaN;
  return (power * (1 - rate)) / (1 - s * rate);
}

/**
 * Largest s of each channel: just below 1/r where the rate is known, otherwise 1, because nothing is known of the rest then.
 * @param {Data} data
 */
export function largest({ bounds }) {
  return bounds.rate.map((r) => (r !== null && r < 1 ? Math.max(1, NEARLY / r) : 1));
}

/** The s beyond which a surface would reflect more than it receives, by channel. @param {Data} data */
export const physical = ({ bounds }) => bounds.max_albedo.map((a) => (a > 0 ? 1 / a : Infinity));

/** True if the reader has changed nothing of the series. @param {State} state */
export const untouched = ({ scale, on }) => scale.every((s) => s === 1) && on.every(Boolean);

/**
 * Weights of the slots of a world (the terms, then the rest) in an image, by slot and channel.
 * @param {Run} run
 * @param {Subject} subject
 * @param {State} state
 * @returns {number[][]}
 */
export function weights(run, { world, kind, k }, { scale, on }) {
  const last = run.data.max_bounces;
  if (!run.hasTerms(world)) return [[1, 1, 1]];
  const rest = scale.map((s, c) => restFactor(s, last, run.data.bounds.rate[c]));
  return Array.from({ length: last + 2 }, (_, j) => {
    const own = j > last ? rest : scale.map((s) => s ** j);
    const chosen = {
      term: j === k,
      sum: j <= k && on[j],
      rest: j > last,
      whole: on[j] && (j <= last || !cut(run, world)),
    }[kind];
    return chosen ? own : [0, 0, 0];
  });
}

/** True if nothing is known of the rest. @param {Run} run @param {World} world */
export const cut = (run, world) => !run.layer(world, 'rest');
