// Keys, and the page of help that lists them.

import { byId, subjectsOf, worldsOf } from '#page/controls.js';
import { LOOKS, METRICS, nameOf } from '#page/state.js';
import { termsOf } from '#page/what_if.js';

/** @import { App } from '#page/main.js' */
/** @import { Subject } from '#page/types.js' */

/** @template T @param {readonly T[]} all @param {T} now */
const next = (all, now) => all[(all.indexOf(now) + 1) % all.length];

/** What each key does, with words for the help. @type {{keys: string[], says: string, does: (app: App, key: string) => void}[]} */
const BINDINGS = [
  { keys: [...'0123456789'], says: '<kbd>0</kbd>–<kbd>9</kbd> the term of that number, if the run has it; 0 is E, the light of the lamps', does: (app, key) => app.term(Number(key)) },
  { keys: ['ArrowLeft', 'ArrowRight'], says: '<kbd>←</kbd> <kbd>→</kbd> the term before, the term after', does: (app, key) => step(app, key === 'ArrowRight' ? 1 : -1) },
  { keys: ['ArrowUp', 'ArrowDown'], says: '<kbd>↑</kbd> <kbd>↓</kbd> another answer: series, path tracer, radiosity', does: (app, key) => turn(app, key === 'ArrowDown' ? 1 : -1) },
  { keys: ['s'], says: '<kbd>s</kbd> terms or partial sums', does: (app) => app.summing(!app.sums) },
  { keys: [' '], says: '<kbd>Space</kbd> plays the partial sums S₀, S₁, …', does: (app) => app.play() },
  { keys: ['e', 'E'], says: '<kbd>e</kbd> brighter, <kbd>E</kbd> darker, by half a stop', does: ({ store }, key) => store.set({ exposure: store.state.exposure + (key === 'e' ? 0.5 : -0.5) }) },
  { keys: ['o', 'O'], says: '<kbd>o</kbd> <kbd>O</kbd> adds to the image or takes from it', does: ({ store }, key) => store.set({ offset: +(store.state.offset + (key === 'o' ? 0.05 : -0.05)).toFixed(2) }) },
  { keys: ['n'], says: '<kbd>n</kbd> each image has its own gain', does: ({ store }) => store.set({ gain: 'each', exposure: 0 }) },
  { keys: ['l'], says: '<kbd>l</kbd> all images have one gain', does: ({ store }) => store.set({ gain: store.state.gain === 'one' ? 'each' : 'one' }) },
  { keys: ['t'], says: '<kbd>t</kbd> colours: as seen, false colours, minus and plus', does: ({ store }) => store.set({ look: next(LOOKS, store.state.look) }) },
  { keys: ['m'], says: '<kbd>m</kbd> shows the image, or one of its differences from the reference', does: ({ store }) => store.set({ metric: next(METRICS, store.state.metric) }) },
  { keys: ['b'], says: '<kbd>b</kbd> the map of z: where two answers differ by more than their noise', does: (app) => app.bias() },
  { keys: ['w'], says: '<kbd>w</kbd> a movable edge between image and reference', does: ({ store }) => store.set({ wipe: store.state.wipe === null ? 0.5 : null }) },
  { keys: ['+', '=', '-'], says: '<kbd>+</kbd> <kbd>−</kbd> or the wheel: zoom; drag moves the image', does: ({ viewer }, key) => viewer.zoomBy(key === '-' ? 1 / 1.5 : 1.5) },
  { keys: ['f'], says: '<kbd>f</kbd> the whole image', does: ({ store }) => store.set({ frame: null }) },
  { keys: ['F'], says: '<kbd>F</kbd> the image on the whole screen, for a projector', does: () => fullScreen() },
  { keys: ['r'], says: '<kbd>r</kbd> everything as at the start', does: (app) => app.reset() },
  { keys: ['i'], says: '<kbd>i</kbd> what is known of this image', does: () => byId('reading-card').focus() },
  { keys: ['d'], says: '<kbd>d</kbd> the plot of the decay', does: () => byId('plot-decay')?.scrollIntoView({ block: 'center' }) },
  { keys: ['y'], says: '<kbd>y</kbd> copies a link to this view', does: () => byId('copy-link').click() },
  { keys: ['?'], says: '<kbd>?</kbd> this help', does: () => help() },
];

/** Other ways of using the page. */
const OTHERS = [
  '<kbd>Shift</kbd> held: the reference in place of the image',
  '<kbd>Shift</kbd> and a digit: that term as reference',
  '<kbd>Ctrl</kbd> <kbd>0</kbd>: one pixel of the image on one of the screen',
  'Click or tap: the series of that pixel. <kbd>Shift</kbd> and drag: that of a block.',
  'Two fingers zoom. A picture of your own can be dropped onto the page.',
];

/** The words of the page. */
const WORDS = [
  ['T', 'the operator of one scattering: it turns light that arrives at surfaces into light that leaves them'],
  ['E, TᵏE', 'the light of the lamps, and the light that was scattered exactly k times; Tₕ is T on a mesh of patches'],
  ['Sₖ, rest, L', 'the sum of the terms 0 to k, everything beyond the last term, and the whole image'],
  ['s', 'a factor for every scattering: the term k is multiplied by sᵏ'],
  ['z', 'the difference of two images in a pixel, divided by its standard error'],
  ['±', 'half of an interval that contains the exact value with 95 % probability'],
  ['⚑', 'light reaches so few samples of a pixel that their scatter does not tell the error'],
  ['prefix, single', 'one path gives all terms, or each term has its own paths'],
  ['mis', 'lamps are found both by choosing a point on them and by hitting them; the two are weighted'],
];

/** @param {App} app */
export function keys(app) {
  byId('help-body').innerHTML = `<ul>${[...BINDINGS.map((b) => b.says), ...OTHERS].map((w) => `<li>${w}</li>`).join('')}</ul><h3>Words</h3><dl>${WORDS.map(([w, says]) => `<div><dt>${w}</dt><dd>${says}</dd></div>`).join('')}</dl>`;
  byId('full-screen').addEventListener('click', fullScreen);
  byId('help-open').addEventListener('click', help);
  document.addEventListener('keydown', (e) => {
    const target = /** @type {HTMLElement} */ (e.target);
    const help = /** @type {HTMLDialogElement} */ (byId('help'));
    if (help.open || e.altKey || e.metaKey || isOwn(target, e.key)) return;
    if (e.ctrlKey) {
      if (e.key === '0') pixelForPixel(app, e);
      return;
    }
    const digit = /^Digit(\d)$/.exec(e.code)?.[1];
    if (e.shiftKey && digit) {
      app.peek(false);
      reference(app, Number(digit));
    } else if (e.key === 'Shift') {
      if (!e.repeat) app.peek(true);
      return;
    } else {
      const binding = BINDINGS.find((b) => b.keys.includes(e.key));
      if (e.shiftKey) app.peek(false);
      if (!binding) return;
      binding.does(app, e.key);
    }
    e.preventDefault();
  });
  document.addEventListener('keyup', (e) => {
    if (e.key === 'Shift') app.peek(false);
  });
  window.addEventListener('blur', () => app.peek(false));
}

/** True if an element uses the key itself. @param {HTMLElement} target @param {string} key */
function isOwn(target, key) {
  const type = target instanceof HTMLInputElement ? target.type : target.tagName;
  const moves = /^(Arrow|Home|End|Page)/.test(key) || key === ' ' || key === '+' || key === '-';
  if (['SELECT', 'TEXTAREA', 'text', 'number'].includes(type)) return true;
  if (['range', 'checkbox', 'file'].includes(type)) return moves;
  return ['BUTTON', 'SUMMARY', 'A'].includes(type) && (key === ' ' || key === 'Enter');
}

/** The image on the whole screen, and back. */
export function fullScreen() {
  const frame = byId('canvas').parentElement;
  if (document.fullscreenElement) document.exitFullscreen();
  else frame?.requestFullscreen?.();
}

const help = () => /** @type {HTMLDialogElement} */ (byId('help')).showModal();

/** @param {App} app @param {KeyboardEvent} e */
function pixelForPixel(app, e) {
  const { x, y } = app.viewer.now();
  app.store.set({ frame: { zoom: 1 / (window.devicePixelRatio || 1), x, y } });
  e.preventDefault();
}

/** @param {App} app @param {number} by */
function step(app, by) {
  const { subject } = app.store.state;
  const all = subjectsOf(app, subject.world);
  const at = all.findIndex((s) => nameOf(s) === nameOf(subject));
  app.store.set({ subject: all[Math.min(Math.max((at < 0 ? all.length - 1 : at) + by, 0), all.length - 1)] });
}

/** @param {App} app @param {number} by */
function turn(app, by) {
  const all = worldsOf(app);
  const at = all.indexOf(app.store.state.subject.world);
  app.show(all[(at + by + all.length) % all.length]);
}

/** Term k as the reference, of the world on the canvas if it has terms. @param {App} app @param {number} k */
function reference(app, k) {
  const { world } = app.store.state.subject;
  const found = /** @type {Subject} */ ({ world: termsOf(app, world), kind: 'term', k });
  if (app.known(found)) app.store.set({ reference: found });
}
