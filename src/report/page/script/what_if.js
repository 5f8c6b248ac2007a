// The sliders of s, one for all channels and one for each, and the switches of the terms.

import { byId, inputById } from '#page/controls.js';
import { percent, plusMinus, significant, symbol } from '#page/format.js';
import { escaped, meanOf } from '#page/reading.js';
import { cut, largest, physical, restFactor, untouched } from '#page/scale.js';

/** @import { App } from '#page/main.js' */
/** @import { State, Subject, World } from '#page/types.js' */

const CHANNELS = ['red', 'green', 'blue'];
/** Shares of the extrapolated rest above this are said to rule the picture. */
const MUCH = 0.1;

/** @param {App} app */
export function whatIf(app) {
  const { store, run } = app;
  const [most, limit] = [largest(run.data), physical(run.data)];
  // one range for all, so that equal values are at equal places
  const range = Math.max(...most);
  const sliders = ['all', ...CHANNELS].map((name, i) => {
    const [max, at] = i === 0 ? [Math.min(...most), Math.min(...limit)] : [most[i - 1], limit[i - 1]];
    const row = document.createElement('div');
    const tick = (/** @type {string} */ kind, /** @type {number} */ s, /** @type {string} */ says) =>
      s < range ? `<i class="${kind}" style="left:calc(8px + (100% - 16px) * ${s / range})" title="${says}"></i>` : '';
    row.innerHTML = `<label for="s-${name}">s, ${name === 'all' ? 'all channels' : name}</label>
      <span class="range">${tick('one', 1, 's = 1: the scene as it is')}${tick('limit', at, `no real surface reflects more: s = ${significant(at, 3)}`)}${tick('end', max, 'just below the s at which the series diverges')}
      <input id="s-${name}" type="range" min="0" max="${range.toFixed(3)}" step="0.005"></span>
      <output id="s-${name}-value"></output>`;
    const input = /** @type {HTMLInputElement} */ (row.querySelector('input'));
    input.addEventListener('input', () => {
      const s = Math.min(snapped(Number(input.value)), max);
      input.value = String(s);
      const scale = [...store.state.scale];
      if (i === 0) scale.fill(s);
      else scale[i - 1] = s;
      // only a world with terms can be scaled
      const subject = run.hasTerms(store.state.subject.world) ? store.state.subject : summed(app, store.state);
      store.set({ scale, subject, spp: null });
    });
    return row;
  });
  byId('sliders').replaceChildren(...sliders);
  const last = run.data.max_bounces;
  const fields = Array.from({ length: last + 2 }, (_, j) => {
    const label = document.createElement('label');
    const name = j > last ? 'rest' : symbol({ world: 'terms', kind: 'term', k: j });
    label.innerHTML = `<input type="checkbox" id="on-${j}" checked> ${name}`;
    label.firstElementChild?.addEventListener('change', (e) => {
      const on = [...store.state.on];
      on[j] = /** @type {HTMLInputElement} */ (e.target).checked;
      // a changed sum is seen in the whole image only
      store.set({ on, spp: null, subject: summed(app, store.state) });
    });
    return label;
  });
  byId('terms-on').append(...fields);
  byId('what-if-reset').addEventListener('click', () => store.set({ scale: [1, 1, 1], on: store.state.on.map(() => true) }));
  byId('what-if').hidden = !run.data.worlds.some((a) => run.hasTerms(a.world));
  store.drawnBy((state) => show(app, state));
  show(app, store.state);
}

/** Close to 1 the slider is at 1. @param {number} s */
const snapped = (s) => (Math.abs(s - 1) < 0.004 ? 1 : s);

/** The whole of a world with terms. @param {App} app @param {State} state @returns {Subject} */
export function summed(app, { subject }) {
  const world = termsOf(app, subject.world);
  return subject.kind === 'sum' && world === subject.world ? subject : { world, kind: 'whole', k: 0 };
}

/** The world itself if it has terms, otherwise the first one that has. @param {App} app @param {World} world */
export const termsOf = (app, world) => (app.run.hasTerms(world) ? world : worldWithTerms(app));

/** @param {App} app @returns {World} */
export const worldWithTerms = (app) => app.run.data.worlds.find((a) => app.run.hasTerms(a.world))?.world ?? 'terms';

/** @param {App} app @param {State} state */
function show(app, state) {
  const { scale, on } = state;
  const alike = scale.every((s) => s === scale[0]);
  [scale[0], ...scale].forEach((s, i) => {
    const name = ['all', ...CHANNELS][i];
    inputById(`s-${name}`).value = String(s);
    byId(`s-${name}-value`).textContent = i === 0 && !alike ? 'mixed' : s.toFixed(2);
  });
  on.forEach((o, j) => (inputById(`on-${j}`).checked = o));
  byId('what-if-text').innerHTML = told(app, state);
  byId('residual').innerHTML = residual(app, state);
}

/** What L(s) is, and how well it is known. @param {App} app @param {State} state */
function told(app, state) {
  const { run } = app;
  const { bounds, max_bounces: last } = run.data;
  const subject = /** @type {Subject} */ ({ world: summed(app, state).world, kind: 'whole', k: 0 });
  const [now, before] = [meanOf(app, subject, state), meanOf(app, subject, { ...state, scale: [1, 1, 1], on: state.on.map(() => true) })];
  if (!now || !before) return '';
  if (untouched(state)) {
    return `Mean radiance of the picture: ${plusMinus(...before.all)}. The terms give any other s at once: L(s) = Σ sᵏTᵏE, for
      reflection and transmission alike.`;
  }
  const { scale } = state;
  const lines = [];
  if (!Number.isFinite(now.all[0])) return 'Beyond this s the series diverges: the light would never stop growing.';
  const share = now.all[0] / before.all[0];
  const known = meanOf(app, subject, { ...state, on: state.on.map((o, j) => o && j <= last) });
  const rest = now.all[0] - (known?.all[0] ?? NaN);
  if (cut(run, subject.world)) {
    lines.push(`The first ${last + 1} terms have the mean ${plusMinus(...now.all)}; paths were cut there, so what lies beyond is not known.`);
  } else if (scale.every((s) => s <= 1)) {
    lines.push(`Mean radiance of the whole sum ${plusMinus(...now.all)} (95 %).`);
    if (hasRest(state, last) && scale.some((s) => s < 1)) {
      lines.push(`It may be up to <span id="slack">${significant(rest, 2)}</span> too high, because the rest is known exactly only at s = 1.`);
    }
  } else if (!hasRest(state, last)) {
    lines.push(`Mean radiance of the whole sum ${plusMinus(...now.all)} (95 %), without what lies beyond k = ${last}.`);
  } else {
    lines.push(`Mean radiance of the whole sum ${plusMinus(...now.all)}, of which ${percent(rest / now.all[0])} is extrapolated:
      beyond k = ${last} the terms are assumed to fall by the factor s r, where r = ${bounds.rate.map((r) => significant(r, 3)).join(', ')}
      in red, green, blue is the ${escaped(bounds.rate_is)}. The interval does not include the error of this assumption.`);
    if (rest / now.all[0] > MUCH) lines.push('<span class="flag">⚑ A tenth or more of this picture is extrapolated.</span>');
  }
  lines.push(`That is <b id="share">${percent(share)}</b> of the picture at s = 1${scattered(app, state, subject)}.`);
  const limit = physical(run.data);
  if (scale.some((s, c) => s > limit[c] * (1 + 1e-9))) {
    lines.push(`<span class="flag">⚑ Not physical: some surface would reflect more than it receives (s > ${significant(Math.min(...limit), 3)}).</span>`);
  }
  const factor = scale.map((s, c) => restFactor(s, last, bounds.rate[c]));
  if (factor.some((f) => Number.isNaN(f))) lines.push('The series diverges in a channel; nothing is shown there.');
  return lines.join(' ');
}

/** The share of the scattered light, without what the lamps send to the camera. @param {App} app @param {State} state @param {Subject} subject */
function scattered(app, state, subject) {
  const without = (/** @type {State} */ s) => meanOf(app, subject, { ...s, on: s.on.map((o, j) => o && j > 0) })?.all[0] ?? NaN;
  const share = without(state) / without({ ...state, scale: [1, 1, 1], on: state.on.map(() => true) });
  return Number.isFinite(share) && state.on[0] ? `; of the light that surfaces scatter, <b id="scattered">${percent(share)}</b>` : '';
}

/** True if the rest is part of the sum. @param {State} state @param {number} last K */
const hasRest = ({ on }, last) => on[last + 1];

/** What the sum lacks of the path tracer's image. @param {App} app @param {State} state */
function residual(app, state) {
  const path = app.run.answer('path');
  const subject = summed(app, state);
  const sum = meanOf(app, subject, state);
  const whole = path && meanOf(app, { world: 'path', kind: 'whole', k: 0 }, state);
  if (!whole || !sum || state.scale.some((s) => s !== 1)) return path ? '' : 'This run has no path tracer to compare with.';
  const [difference, half] = [whole.all[0] - sum.all[0], Math.hypot(whole.all[1], sum.all[1])];
  const name = subject.kind === 'sum' ? symbol(subject) : 'this sum';
  return `Path tracer − ${name} = ${plusMinus(difference, half)} (${percent(difference / whole.all[0])} of the image).`;
}
