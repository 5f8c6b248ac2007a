// The series of one pixel, or of a block of tiles: every term with its interval, and the partial sums beside the other answers.

import { byId } from '#page/controls.js';
import { draw } from '#page/chart.js';
import { WORLD_NAMES, percent, plusMinus, same, significant, symbol } from '#page/format.js';
import { doubtOf, meanOf } from '#page/reading.js';
import { TILES } from '#page/run.js';
import { untouched } from '#page/scale.js';
import { summed } from '#page/what_if.js';

/** @import { App } from '#page/main.js' */
/** @import { State, Subject } from '#page/types.js' */

/** @param {App} app */
export function probe(app) {
  app.store.drawnBy((state, before) => {
    const unchanged = ['pixel', 'tiles', 'scale', 'on', 'subject'].every((k) => state[/** @type {keyof State} */ (k)] === before[/** @type {keyof State} */ (k)]);
    if (!unchanged) show(app, state);
  });
  show(app, app.store.state);
}

/**
 * Value of a subject at the chosen place: mean over the channels, half width of the 95 % interval (0 if none is known), channels.
 * @param {App} app @param {Subject} subject @param {State} state
 */
export function valueAt(app, subject, state) {
  if (state.pixel === null && state.tiles) {
    const found = meanOf(app, subject, state, state.tiles);
    return found && { value: found.all[0], half: found.all[1] || 0, rgb: found.mean, errors: found.half };
  }
  const [x, y] = state.pixel ?? [0, 0];
  const i = 3 * (y * app.run.data.width + x);
  const t = app.run.answer(subject.world)?.t95 ?? NaN;
  const third = (/** @type {ArrayLike<number>} */ v) => (v[0] + v[1] + v[2]) / 3;
  const { rgb, errors: single } = app.composer.at(subject, state, i);
  const errors = single.map((e) => t * e);
  return { value: third(rgb), half: third(errors) || 0, rgb, errors };
}

/** @param {App} app @param {State} state */
function show(app, state) {
  const into = byId('probe');
  if (!state.pixel && !state.tiles) {
    into.innerHTML = '<p>Click a pixel of the image to see its own series. For a block of pixels, hold Shift and drag, or tick “Drag to choose a block”.</p>';
    byId('probe-title').textContent = 'One pixel, or a block';
    return;
  }
  byId('probe-title').textContent = title(app, state);
  const { world } = summed(app, state);
  const last = app.run.data.max_bounces;
  const terms = app.run.hasTerms(world) ? Array.from({ length: last + 1 }, (_, k) => /** @type {Subject} */ ({ world, kind: 'term', k })) : [];
  if (app.run.layer(world, 'rest')) terms.push({ world, kind: 'rest', k: 0 });
  // what is switched off is no part of the sum
  const shown = terms.filter((s) => state.on[s.kind === 'rest' ? last + 1 : s.k]);
  terms.splice(0, terms.length, ...shown);
  const values = terms.map((s) => valueAt(app, s, state));
  const whole = values.reduce((a, v) => a + (v?.value ?? 0), 0);
  into.innerHTML = '<div id="probe-terms"></div><div id="probe-sums"></div><div id="probe-text"></div>';
  if (terms.length) {
    const names = terms.map((s) => symbol(s));
    draw(byId('probe-terms'), {
      title: 'The terms at this place, with 95 % intervals',
      x: 'term',
      y: 'radiance',
      names,
      series: [{
        label: '',
        color: 'var(--c1)',
        form: 'bar',
        marks: values.map((v, k) => ({
          x: k,
          y: v?.value ?? NaN,
          half: v?.half ?? 0,
          says: `${names[k]}: ${plusMinus(v?.value ?? NaN, v?.half ?? 0)}, ${percent((v?.value ?? NaN) / whole)} of the sum`,
          chosen: same(terms[k], state.subject),
          open: () => app.store.set({ subject: terms[k] }),
        })),
      }],
    });
    sums(app, state, terms);
  }
  byId('probe-text').innerHTML = table(app, state, terms, values, whole);
}

/** Partial sums as points; path tracer and matrix as bands. @param {App} app @param {State} state @param {Subject[]} terms */
function sums(app, state, terms) {
  const { world } = terms[0];
  const all = terms.filter((s) => s.kind === 'term').map(({ k }) => /** @type {Subject} */ ({ world, kind: 'sum', k }));
  if (app.run.layer(world, 'rest')) all.push({ world, kind: 'whole', k: 0 });
  const bands = /** @type {const} */ ([['path', 'var(--c3)'], ['radiosity', 'var(--c4)']]).flatMap(([other, color]) => {
    // the path tracer has no terms, so it is known at s = 1 only
    if (other === world || !app.run.answer(other) || (!app.run.hasTerms(other) && !untouched(state))) return [];
    const found = valueAt(app, { world: other, kind: 'whole', k: 0 }, state);
    return found ? [{ label: WORLD_NAMES[other], color, from: found.value - found.half, to: found.value + found.half }] : [];
  });
  draw(byId('probe-sums'), {
    title: 'Partial sums at this place, beside path tracer and radiosity',
    x: 'partial sum',
    y: 'radiance',
    names: all.map((s) => symbol(s)),
    series: [{
      label: 'partial sums',
      color: 'var(--c1)',
      marks: all.map((s, k) => {
        const found = valueAt(app, s, state);
        return { x: k, y: found?.value ?? NaN, half: found?.half ?? 0, open: () => app.store.set({ subject: s }) };
      }),
    }],
    bands,
  });
}

/** @param {App} app @param {State} state */
function title(app, { pixel, tiles }) {
  if (pixel) return `Pixel ${pixel[0]}, ${pixel[1]}`;
  const [w, h] = app.run.data.full;
  const edge = (/** @type {number} */ t, /** @type {number} */ size) => Math.ceil((t * size) / TILES);
  const [left, top, right, bottom] = tiles ?? [0, 0, 0, 0];
  return `Block of pixels ${edge(left, w)}, ${edge(top, h)} to ${edge(right, w) - 1}, ${edge(bottom, h) - 1}`;
}

/**
 * @param {App} app @param {State} state @param {Subject[]} terms
 * @param {ReturnType<typeof valueAt>[]} values @param {number} whole
 */
function table(app, state, terms, values, whole) {
  const row = (/** @type {string} */ name, /** @type {ReturnType<typeof valueAt>} */ v, /** @type {string} */ share) => {
    const cells = [0, 1, 2].map((c) => `<td>${plusMinus(v?.rgb[c] ?? NaN, v?.errors[c] ?? NaN)}</td>`).join('');
    return `<tr><th scope="row">${name}</th>${cells}<td>${share}</td></tr>`;
  };
  const rows = terms.map((s, i) => row(symbol(s), values[i], percent((values[i]?.value ?? NaN) / whole)));
  const wholes = app.run.data.worlds.map((a) => {
    const subject = /** @type {Subject} */ ({ world: a.world, kind: 'whole', k: 0 });
    const at = app.run.hasTerms(a.world) || untouched(state) ? '' : ' at s = 1';
    return row(`L, ${WORLD_NAMES[a.world]}${at}`, valueAt(app, subject, state), '');
  });
  if (app.composer.own && state.pixel) rows.push(row('your picture', valueAt(app, { world: 'own', kind: 'whole', k: 0 }, state), ''));
  const notes = [];
  if (state.pixel) notes.push('Intervals (95 %) of a changed or partial sum are upper bounds, because terms may come from the same paths.');
  else notes.push('The intervals come from independent replicates of the whole image.');
  const doubts = [...new Set(state.pixel ? terms.map((s) => doubtOf(app, s)).filter(Boolean) : [])];
  if (doubts.length) {
    const names = terms.filter((s) => doubtOf(app, s)).map((s) => symbol(s)).join(', ');
    notes.push(`<span class="flag">⚑ The errors of single pixels cannot be trusted for ${names}: light is found there too seldom.</span>`);
  }
  const largest = values.reduce((a, v, k) => ((v?.value ?? 0) > (values[a]?.value ?? 0) && (terms[k].k > 0 || terms[k].kind === 'rest') ? k : a), Math.min(1, values.length - 1));
  const lead = terms.length > 2 ? `<p id="probe-lead">${led(terms, values, largest)} All terms shown together: ${significant(whole)}.</p>` : '';
  return `${lead}<p>${notes.join(' ')}</p><details><summary>All values by channel</summary><div class="wide"><table><thead><tr><th scope="col">term</th>
    <th scope="col">red</th><th scope="col">green</th><th scope="col">blue</th><th scope="col">share</th></tr></thead><tbody>${rows.join('')}${wholes.join('')}</tbody></table></div></details>`;
}

/** Which term is the largest part of the scattered light. @param {Subject[]} terms @param {ReturnType<typeof valueAt>[]} values @param {number} largest */
function led(terms, values, largest) {
  const scattered = values.reduce((a, v, k) => a + (terms[k].kind === 'term' && terms[k].k === 0 ? 0 : (v?.value ?? 0)), 0);
  if (!(scattered > 0)) return 'No scattered light arrives here.';
  return `Of the light that was scattered to here, ${symbol(terms[largest])} is the largest part: ${percent((values[largest]?.value ?? NaN) / scattered)}.`;
}
