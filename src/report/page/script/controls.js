// The controls around the canvas: answers, terms, exposure, gain, colours, reference.

import { WORLD_NAMES, gainText, meaning, symbol } from '#page/format.js';
import { doubtOf } from '#page/reading.js';
import { lookOf } from '#page/gains.js';
import { autoGain, tone } from '#page/tone.js';
import { WORLDS, nameOf, subjectOf } from '#page/state.js';

/** @import { App } from '#page/main.js' */
/** @import { State, Subject, World } from '#page/types.js' */

/** Side of a small picture in the strip. */
const SMALL = 72;

/** @param {string} id */
export const byId = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} id */
export const inputById = (id) => /** @type {HTMLInputElement} */ (document.getElementById(id));

/** @param {App} app */
export function controls(app) {
  const { store } = app;
  /** @type {[string, (value: string) => Partial<State> | undefined][]} */
  const fields = [
    ['exposure', (v) => ({ exposure: Number(v) })],
    ['gain', (v) => ({ gain: /** @type {State['gain']} */ (v) })],
    ['look', (v) => ({ look: /** @type {State['look']} */ (v) })],
    ['metric', (v) => ({ metric: /** @type {State['metric']} */ (v) })],
    ['reference', (v) => {
      const reference = subjectOf(v, app.run.data) ?? (v.startsWith('own') ? { world: 'own', kind: 'whole', k: 0 } : undefined);
      return reference && { reference: /** @type {Subject} */ (reference) };
    }],
  ];
  for (const [id, change] of fields) {
    byId(id).addEventListener('input', (e) => {
      const changed = change(/** @type {HTMLInputElement} */ (e.target).value);
      if (changed) store.set(changed);
    });
  }
  const checked = (/** @type {Event} */ e) => /** @type {HTMLInputElement} */ (e.target).checked;
  byId('wipe').addEventListener('change', (e) => store.set({ wipe: checked(e) ? 0.5 : null }));
  byId('block').addEventListener('change', (e) => (app.viewer.choosing = checked(e)));
  byId('fit').addEventListener('click', () => store.set({ frame: null }));
  byId('closer').addEventListener('click', () => app.viewer.zoomBy(1.5));
  byId('farther').addEventListener('click', () => app.viewer.zoomBy(1 / 1.5));
  store.drawnBy((state) => show(app, state));
  fill(app);
}

/** The answers that have an image. @param {App} app @returns {World[]} */
export const worldsOf = (app) => WORLDS.filter((w) => (w === 'own' ? app.composer.own : app.run.answer(w)));

/**
 * All images of a world.
 * @param {App} app @param {World} world @param {boolean} [sums] partial sums in place of terms
 * @returns {Subject[]}
 */
export function subjectsOf(app, world, sums = app.sums) {
  const whole = /** @type {Subject} */ ({ world, kind: 'whole', k: 0 });
  if (!app.run.hasTerms(world)) return [whole];
  const kind = sums ? 'sum' : 'term';
  const terms = Array.from({ length: app.run.data.max_bounces + 1 }, (_, k) => /** @type {Subject} */ ({ world, kind, k }));
  const rest = app.run.layer(world, 'rest') ? [/** @type {Subject} */ ({ world, kind: 'rest', k: 0 })] : [];
  return [...terms, ...rest, whole];
}

/** Builds the buttons of the answers, the list of references and the strip. @param {App} app */
export function fill(app) {
  letGo(byId('worlds'));
  letGo(byId('strip'));
  const worlds = byId('worlds');
  const button = (/** @type {World} */ world) => {
    const element = document.createElement('button');
    element.type = 'button';
    element.dataset.world = world;
    element.textContent = { terms: 'The series Σ TᵏE', path: 'The path tracer', radiosity: 'Radiosity (matrix)', own: 'Your picture' }[world];
    element.addEventListener('click', () => app.show(world));
    return element;
  };
  const sums = document.createElement('button');
  [sums.type, sums.id, sums.textContent] = ['button', 'sums', 'Partial sums Sₖ'];
  sums.addEventListener('click', () => app.summing(!app.sums));
  worlds.replaceChildren(...worldsOf(app).map(button), sums);
  const reference = byId('reference');
  const option = (/** @type {Subject} */ s) => {
    const words = s.world === 'own' ? 'your picture' : `${symbol(s)}, ${WORLD_NAMES[s.world]}`;
    return new Option(words, nameOf(s));
  };
  reference.replaceChildren(...worldsOf(app).flatMap((w) => subjectsOf(app, w, false).reverse().map(option)));
  strip(app, app.store.state);
  show(app, app.store.state);
}

/** A click with a pointer does not keep the focus, so that Space plays. @param {HTMLElement} group */
function letGo(group) {
  group.onclick = (e) => {
    if (e.detail > 0 && document.activeElement instanceof HTMLElement) document.activeElement.blur();
  };
}

/** One small picture for each image of the world, each at its own gain. @param {App} app @param {State} state */
export function strip(app, state) {
  const element = byId('strip');
  const one = (/** @type {Subject} */ subject) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.dataset.name = nameOf(subject);
    button.title = meaning(subject, app.run.data.max_bounces);
    const doubt = doubtOf(app, subject) && subject.kind !== 'sum';
    button.append(small(app, subject), `${symbol(subject)}${doubt ? ' ⚑' : ''}`);
    if (doubt) button.title += '; ⚑ errors of single pixels cannot be trusted';
    button.addEventListener('click', () => app.store.set({ subject }));
    return button;
  };
  element.replaceChildren(...subjectsOf(app, state.subject.world).map(one));
  element.dataset.shows = `${state.subject.world} ${app.sums}`;
}

/** @param {App} app @param {Subject} subject */
function small(app, subject) {
  const { width, height } = app.run.data;
  const pixels = app.composer.pixels(subject, app.start);
  const scale = SMALL / Math.max(width, height);
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [Math.max(1, Math.round(width * scale)), Math.max(1, Math.round(height * scale))];
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  const image = context.createImageData(canvas.width, canvas.height);
  const some = new Float32Array(3 * canvas.width * canvas.height);
  // every pixel of the small picture is one of the large one: its noise is part of what it shows
  for (let y = 0; y < canvas.height; y += 1) {
    for (let x = 0; x < canvas.width; x += 1) {
      const from = 3 * (Math.floor((y + 0.5) / scale) * width + Math.floor((x + 0.5) / scale));
      some.set(pixels.subarray(from, from + 3), 3 * (y * canvas.width + x));
    }
  }
  const gain = subject.kind === 'term' ? autoGain(some) : app.gains.of(subject, app.start);
  tone(some, { gain, offset: 0, look: 'srgb' }, image.data);
  context.putImageData(image, 0, 0);
  canvas.setAttribute('aria-hidden', 'true');
  return canvas;
}

/** Shows the state in the controls. @param {App} app @param {State} state */
function show(app, state) {
  const field = (/** @type {string} */ id, /** @type {string} */ value) => (inputById(id).value = value);
  const { subject } = state;
  field('exposure', String(state.exposure));
  byId('exposure-value').textContent = `${state.exposure > 0 ? '+' : ''}${state.exposure} EV`.replace('-', '−');
  field('gain', state.gain);
  field('look', lookOf(state));
  byId('look').toggleAttribute('disabled', state.metric !== 'value');
  field('metric', state.metric);
  field('reference', nameOf(state.reference));
  inputById('wipe').checked = state.wipe !== null;
  for (const button of byId('worlds').querySelectorAll('[data-world]')) {
    button.setAttribute('aria-pressed', String(/** @type {HTMLElement} */ (button).dataset.world === subject.world));
  }
  byId('sums').setAttribute('aria-pressed', String(app.sums));
  byId('sums').hidden = !app.run.hasTerms(subject.world);
  if (byId('strip').dataset.shows !== `${subject.world} ${app.sums}`) strip(app, state);
  for (const button of byId('strip').children) {
    button.setAttribute('aria-pressed', String(/** @type {HTMLElement} */ (button).dataset.name === nameOf(subject)));
  }
}

/**
 * The words on an image: its symbol, its world and its gain.
 * @param {Subject} subject @param {number} gain
 */
export const tagText = (subject, gain) => `${symbol(subject)} ${gainText(gain)} · ${WORLD_NAMES[subject.world]}`;
