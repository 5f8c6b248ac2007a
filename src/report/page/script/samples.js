// A scrubber over the first samples of an image. It looks darker with few samples, because bright pixels are clipped by the
// screen while dark ones are not; its mean is the same. The numbers beside it show both.

import { byId } from '#page/controls.js';
import { percent, plusMinus, same, significant, symbol } from '#page/format.js';
import { varianceOfOne } from '#page/plots.js';
import { meanOf, meanOfPixels } from '#page/reading.js';

/** @import { App } from '#page/main.js' */
/** @import { State, Subject } from '#page/types.js' */

/** @param {App} app */
export function samples(app) {
  const { early, spp } = app.run.data;
  const counts = [...new Set(early.map((l) => l.spp))].sort((a, b) => a - b);
  const card = byId('samples-card');
  card.hidden = counts.length === 0;
  if (card.hidden) return;
  const all = [...counts, spp];
  byId('samples').innerHTML = `<label for="spp">Samples per pixel</label>
    <span class="range"><input id="spp" type="range" min="0" max="${all.length - 1}" step="1" list="spp-list"></span><output id="spp-value"></output>
    <p>Available for ${kept(app).map((s) => `<button type="button" data-k="${s.kind === 'whole' ? 'whole' : s.k}">${symbol(s)}</button>`).join(' ')}</p>
    <p id="samples-text"></p>`;
  const slider = /** @type {HTMLInputElement} */ (byId('spp'));
  slider.addEventListener('input', () => {
    const n = all[Number(slider.value)];
    app.store.set({
      spp: n === spp ? null : n,
      subject: keptOr(app, app.store.state.subject),
      metric: 'value',
      scale: app.start.scale,
      on: app.start.on,
    });
  });
  byId('samples').addEventListener('click', (e) => {
    const { k } = /** @type {HTMLElement} */ (e.target).dataset;
    const subject = kept(app).find((s) => (s.kind === 'whole' ? 'whole' : String(s.k)) === k);
    if (subject) app.store.set({ subject });
  });
  const show = (/** @type {State} */ state) => {
    const shown = app.composer.isFirst(state.subject, state) ? state.spp : null;
    slider.value = String(shown === null ? all.length - 1 : all.indexOf(shown));
    byId('spp-value').textContent = String(shown ?? spp);
    byId('samples-text').innerHTML = told(app, state);
  };
  // the number of clipped pixels is known after the drawing
  app.drawn.push(() => show(app.store.state));
}

/** The images whose first samples were kept. @param {App} app @returns {Subject[]} */
function kept(app) {
  const slots = [...new Set(app.run.data.early.map((l) => l.slot))];
  return slots.map((slot) => (typeof slot === 'number' ? { world: 'terms', kind: 'term', k: slot } : { world: 'terms', kind: 'whole', k: 0 }));
}

/** @param {App} app @param {Subject} subject */
function keptOr(app, subject) {
  const found = kept(app).find((s) => same(s, subject));
  return found ?? /** @type {Subject} */ ({ world: 'terms', kind: 'whole', k: 0 });
}

/** @param {App} app @param {State} state */
function told(app, state) {
  const subject = keptOr(app, state.subject);
  const mean = meanOf(app, subject, { ...state, scale: [1, 1, 1], on: state.on.map(() => true) });
  const lines = [];
  if (app.composer.isFirst(state.subject, state)) {
    const now = meanOfPixels(app, state.subject, state);
    const clipped = percent((app.counts?.clipped ?? 0) / app.run.pixels);
    lines.push(`${symbol(subject)} with ${state.spp} samples: mean ${significant(now)} before clipping, ${clipped} of the pixels clipped.`);
    lines.push(`With all ${app.run.data.spp} samples: mean ${plusMinus(...(mean?.all ?? [NaN, NaN]))}.`);
    lines.push('A noisy image may look darker: the screen clips its bright pixels. Its mean is the same but for noise.');
  } else {
    lines.push('Move the slider to see the noise of fewer samples. The expected mean does not change.');
  }
  const noise = [1, 2].map((k) => {
    const m = meanOf(app, { world: 'terms', kind: 'term', k }, { ...state, scale: [1, 1, 1] });
    return Math.sqrt(varianceOfOne(app, k) ?? NaN) / (m?.all[0] ?? NaN);
  });
  if (noise.every(Number.isFinite)) {
    lines.push(`The noise of one sample in a pixel, relative to the mean of the term: ${significant(noise[0], 2)} for TE, ${significant(noise[1], 2)} for T²E.
      A sample of TE depends mostly on one random point on a lamp; a sample of T²E depends on a random direction and then on a
      random point on a lamp. More random choices usually mean more variance.`);
  }
  return lines.join(' ');
}
