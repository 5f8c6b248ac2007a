// What is known of the image on the canvas: its meaning, its mean with error, its gain, and the pixels that a screen cannot show.

import { lookOf } from '#page/gains.js';
import { gainText, meaning, percent, plusMinus, significant, symbol } from '#page/format.js';
import { untouched, weights } from '#page/scale.js';
import { average, blockMean, imageMean } from '#page/statistics.js';

/** @import { App } from '#page/main.js' */
/** @import { State, Subject, Slot } from '#page/types.js' */
/** @import { Counts } from '#page/tone.js' */

/**
 * Mean of a subject over the image or a block, per channel, with 95 % half widths (NaN where none is known).
 * @typedef {{mean: number[], half: number[], all: [number, number]}} Reading
 */

/**
 * @param {App} app @param {Subject} subject @param {State} state
 * @param {[number, number, number, number]} [block]
 * @returns {Reading | null}
 */
export function meanOf(app, subject, state, block) {
  const answer = app.run.answer(subject.world);
  if (!answer) return null;
  const w = weights(app.run, subject, state);
  const found = block ? blockMean(app.run, answer, block, w) : imageMean(answer, w);
  const rest = subject.kind === 'rest' || subject.kind === 'whole';
  // the tail of a path may have an infinite variance; its error bar would mean nothing
  const t = rest && answer.variance === 'infinite' ? Infinity : rest && answer.variance === 'unknown' ? NaN : answer.t95 ?? NaN;
  const [mean, error] = average(found);
  return { mean: found.mean, half: found.error.map((e) => t * e), all: [mean, t * error] };
}

/** The terms that are switched off in a sum, by their symbols. @param {App} app @param {Subject} subject @param {State} state */
export function leftOut(app, { world, kind }, { on }) {
  if (!app.run.hasTerms(world) || (kind !== 'whole' && kind !== 'sum')) return [];
  const last = app.run.data.max_bounces;
  return on.flatMap((on, j) => (on ? [] : [j > last ? 'the rest' : symbol({ world, kind: 'term', k: j })]));
}

/** `0.1234 ± 0.0012`, from a reading. @param {Reading} r */
export const words = (r) => plusMinus(r.all[0], r.all[1]);

/** The layer whose pixel errors a subject uses, if it says that they cannot be trusted. @param {App} app @param {Subject} s */
export function doubtOf(app, { world, kind, k }) {
  const slot = /** @type {Slot} */ (kind === 'term' ? k : kind === 'rest' ? 'rest' : 'whole');
  return app.run.layer(world, slot)?.doubt ?? '';
}

/**
 * @param {App} app @param {State} state @param {Subject} subject @param {Counts | null} counts @param {number} gain
 */
export function reading(app, state, subject, counts, gain) {
  const { data } = app.run;
  const lines = [];
  lines.push(`<strong>${symbol(subject)}</strong>: ${escaped(meaning(subject, data.max_bounces))}.`);
  const first = app.composer.isFirst(subject, state);
  const difference = differenceOf(app, subject, state);
  if (difference) lines.push(difference);
  const off = leftOut(app, subject, state);
  if (off.length) lines.push(`Left out: ${off.join(', ')}.`);
  const mean = first ? null : meanOf(app, subject, state);
  if (mean) {
    const channels = ['red', 'green', 'blue'].map((name, c) => `${name} ${plusMinus(mean.mean[c], mean.half[c])}`);
    lines.push(`Mean radiance <b id="mean">${words(mean)}</b> W sr⁻¹ m⁻² (95 %); ${channels.join(', ')}.`);
    const mesh = app.run.answer(subject.world)?.mesh.reduce((a, m) => a + m / 3, 0) ?? 0;
    if (mesh > 0) lines.push(`The error of the mesh is about ${significant(mesh, 2)}; it is not included in the interval.`);
  } else {
    const own = subject.world === 'own' && app.composer.own?.errors ? 'the errors of its pixels are known, that of the mean is not' : 'its error is not known';
    const what = subject.world === 'own' && app.composer.own?.eightBit ? 'Mean value (of unknown exposure)' : 'Mean radiance';
    lines.push(`${what} <b id="mean">${significant(meanOfPixels(app, subject, state))}</b>, from the pixels; ${own}.`);
  }
  if (!untouched(state) && !app.run.hasTerms(subject.world)) lines.push('It has no terms, so it is shown at s = 1, with all its light.');
  if (first) lines.push(`These are the first ${state.spp} samples of each pixel.`);
  if (counts) lines.push(`Shown ${gainText(gain)}. ${counted(counts, app.run.pixels, lookOf(state) === 'srgb')}`);
  const doubt = doubtOf(app, subject);
  if (doubt) lines.push(`<span class="flag">⚑ The errors of single pixels are unreliable here: ${escaped(doubt.replace('not trusted, because for single pixels: ', ''))}. An event is a sample that found light.</span>`);
  if (data.reduced > 1) {
    lines.push(`Every pixel is the mean of ${data.reduced} × ${data.reduced} pixels of the run; terms.exr has all of them.`);
  }
  return lines.map((l) => `<p>${l}</p>`).join('');
}

/** The mean of a difference, and for z how often it is large. @param {App} app @param {Subject} subject @param {State} state */
function differenceOf(app, subject, state) {
  const { metric, reference } = state;
  if (metric === 'z') return app.far === null ? '' : `|z| is above 2 in <b id="far">${percent(app.far)}</b> of the pixels; without a difference about 5 %. Rare bright paths skew z in single pixels; the real test is under “Do the answers agree?”.`;
  if (metric === 'value' || metric === 'relative' || subject.world === reference.world) return '';
  if (app.composer.isFirst(subject, state)) return `Mean difference from the reference: ${significant(meanOfPixels(app, subject, state) - meanOfPixels(app, reference, state))}, from the pixels. The image itself:`;
  const [a, b] = [subject, reference].map((s) => meanOf(app, s, state));
  if (!a || !b) return '';
  return `Mean difference from the reference: ${plusMinus(a.all[0] - b.all[0], Math.hypot(a.all[1], b.all[1]))} (95 %). The image itself:`;
}

/** @param {Counts} counts @param {number} pixels @param {boolean} seen true for the colours of the scene */
function counted({ clipped, negative, nonFinite }, pixels, seen) {
  const some = (/** @type {number} */ n, /** @type {string} */ what) => (n ? `${n === 1 ? '1 pixel is' : `${n} pixels (${percent(n / pixels)}) are`} ${what}.` : '');
  const words = [
    some(clipped, seen ? 'too bright for the screen' : 'above the range of the colours'),
    some(negative, seen ? 'negative' : 'below the range of the colours'),
    some(nonFinite, 'not finite (magenta)'),
  ];
  return words.filter(Boolean).join(' ') || 'No pixel is clipped.';
}

/** Mean of the pixels and channels. @param {App} app @param {Subject} subject @param {State} state */
export function meanOfPixels(app, subject, state) {
  const pixels = app.composer.pixels(subject, state);
  return pixels.reduce((a, v) => a + v, 0) / pixels.length;
}

/** @param {string} text */
export const escaped = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');
