// The page of a run: reads the data, draws the image that the reader has chosen, and starts everything around it.

import { Composer } from '#page/compose.js';
import { byId, controls, subjectsOf, tagText } from '#page/controls.js';
import { WORLD_NAMES, meaning, plusMinus, significant, symbol } from '#page/format.js';
import { Gains, lookOf } from '#page/gains.js';
import { keys } from '#page/keys.js';
import { own } from '#page/own.js';
import { plots } from '#page/plots.js';
import { probe } from '#page/probe.js';
import { leftOut, meanOf, reading, words } from '#page/reading.js';
import { Run } from '#page/run.js';
import { samples } from '#page/samples.js';
import { share } from '#page/share.js';
import { Store, initial, nameOf, possible, read, subjectOf, written } from '#page/state.js';
import { OCTAVES, gradient, tone } from '#page/tone.js';
import { tries } from '#page/tries.js';
import { Viewer } from '#page/viewer.js';
import { termsOf, whatIf, worldWithTerms } from '#page/what_if.js';

/** @import { Counts } from '#page/tone.js' */
/** @import { State, Subject, World } from '#page/types.js' */

/** Time between two partial sums that play, in milliseconds. */
const BEAT = 700;

export class App {
  /** True while the strip shows partial sums in place of terms. */
  sums = false;
  /** Gain of the image on the canvas. */
  gain = 1;
  /** @type {Counts | null} */
  counts = null;
  /** True while Shift is held. */
  #peeking = false;
  /** @type {ReturnType<typeof setInterval> | undefined} */
  #playing;
  #asked = false;
  /** What is shown after each drawing. @type {(() => void)[]} */
  drawn = [];
  /** The pixel under the pointer. @type {[number, number] | null} */
  #pointed = null;
  /** In a map of z, the share of pixels beyond 2. @type {number | null} */
  far = null;

  /** @param {Run} run */
  constructor(run) {
    this.run = run;
    this.composer = new Composer(run);
    this.gains = new Gains(this.composer);
    this.start = initial(run.data);
    this.store = new Store(read(location.hash, this.start, run.data), (state) => possible(state, run.data));
    this.sums = this.store.state.subject.kind === 'sum';
    const { store } = this;
    this.viewer = new Viewer(/** @type {HTMLCanvasElement} */ (byId('canvas')), run.data.width, run.data.height, {
      click: (x, y) => store.set({ pixel: [x, y], tiles: null }),
      block: (tiles) => {
        this.peek(false);
        store.set({ tiles, pixel: null });
      },
      frame: (frame) => store.set({ frame }),
      wipe: (wipe) => store.set({ wipe }),
      over: (pixel) => {
        this.#pointed = pixel;
        this.#under(pixel);
      },
    });
  }

  /** Draws at the next frame of the screen. */
  ask() {
    if (this.#asked) return;
    this.#asked = true;
    requestAnimationFrame(() => {
      this.#asked = false;
      const begin = performance.now();
      this.draw();
      performance.measure('frame', { start: begin, end: performance.now() });
    });
  }

  draw() {
    const { store, viewer, composer, gains } = this;
    const peeking = this.#peeking;
    /** @type {State} */
    const state = peeking ? { ...store.state, metric: 'value', spp: null } : store.state;
    const subject = peeking ? state.reference : state.subject;
    const pixels = composer.shown(state, subject);
    const look = lookOf(state);
    const colours = (/** @type {Float32Array} */ of, /** @type {Subject} */ s, /** @type {State} */ by, /** @type {number} */ which) => {
      const gain = gains.of(s, by) * 2 ** state.exposure;
      const counts = tone(of, { gain, offset: state.offset, look: lookOf(by) }, viewer.colours(which));
      viewer.changed(which);
      return { gain, counts };
    };
    if (pixels) {
      const { gain, counts } = colours(pixels, subject, state, 0);
      [this.gain, this.counts] = [gain, counts];
    } else {
      viewer.colours(0).fill(0);
      viewer.changed(0);
      this.counts = null;
    }
    if (state.wipe !== null) {
      const plain = /** @type {State} */ ({ ...state, metric: 'value' });
      const { gain } = colours(composer.pixels(state.reference, plain, 'reference'), state.reference, plain, 1);
      byId('tag-right').textContent = tagText(state.reference, gain);
    }
    viewer.frame = state.frame;
    viewer.over = { pixels, wipe: state.wipe, pixel: state.pixel, tiles: state.tiles };
    viewer.draw();
    this.far = state.metric === 'z' && pixels ? farOut(pixels) : null;
    this.#label(state, subject, pixels !== null, look);
    this.drawn.forEach((show) => show());
    this.#under(this.#pointed);
  }

  /** @param {State} state @param {Subject} subject @param {boolean} known @param {import('#page/types.js').Look} look */
  #label(state, subject, known, look) {
    const why = state.metric === 'z' && !known ? 'z needs two answers from different paths, with all samples and known errors' : '';
    const how = (/** @type {Subject} */ s) => this.#how(s, state);
    byId('tag').textContent = why || (state.metric === 'value' ? tagText(subject, this.gain) + how(subject) : compared(state, subject, how));
    byId('tag-right').hidden = state.wipe === null;
    byId('ramp').hidden = look === 'srgb' || !known;
    if (look !== 'srgb') {
      const [from, bar, to] = byId('ramp').children;
      /** @type {HTMLElement} */ (bar).style.background = `linear-gradient(to right, ${gradient(look)})`;
      const unit = state.metric === 'z' ? 'standard errors' : state.metric === 'relative' ? 'of the reference' : 'W sr⁻¹ m⁻²';
      from.textContent = significant(look === 'false' ? 2 ** -OCTAVES / this.gain : -1 / this.gain, 2);
      to.textContent = `${significant(1 / this.gain, 2)} ${unit}${look === 'false' ? ', logarithmic' : ''}`;
    }
    byId('reading').innerHTML = reading(this, state, subject, this.counts, this.gain);
    byId('canvas').setAttribute('aria-label', `${symbol(subject)}: ${meaning(subject, this.run.data.max_bounces)}`);
  }

  /** The value under the pointer with its standard error. @param {[number, number] | null} pixel */
  #under(pixel) {
    const { state } = this.store;
    const pixels = this.viewer.over.pixels;
    byId('under').hidden = !pixel || !pixels;
    if (!pixel || !pixels) return;
    const [x, y] = pixel;
    const i = 3 * (y * this.run.data.width + x);
    const own = state.metric === 'value' && state.spp === null && !this.#peeking;
    const { errors } = own ? this.composer.at(state.subject, state, i) : { errors: [NaN, NaN, NaN] };
    const value = state.metric === 'z' ? significant(pixels[i], 3) : [0, 1, 2].map((c) => plusMinus(pixels[i + c], errors[c])).join(', ');
    byId('under').textContent = `${x}, ${y}: ${value}`;
  }

  /** How an image was changed: its first samples only, scaled, terms left out. @param {Subject} subject @param {State} state */
  #how(subject, state) {
    if (this.composer.isFirst(subject, state)) return ` · ${state.spp} samples`;
    if (!this.run.hasTerms(subject.world)) return '';
    const { scale } = state;
    const s = scale.every((v) => v === scale[0]) ? scale[0].toFixed(2) : scale.map((v) => v.toFixed(2)).join(', ');
    const off = leftOut(this, subject, state).length > 0;
    return `${scale.some((v) => v !== 1) ? ` · s = ${s}` : ''}${off ? ' · some terms off' : ''}`;
  }

  /** Tells a screen reader what is shown. */
  speak() {
    const { subject } = this.store.state;
    const { state } = this.store;
    const mean = this.composer.isFirst(subject, state) ? null : meanOf(this, subject, state);
    byId('spoken').textContent = `${meaning(subject, this.run.data.max_bounces)}${this.#how(subject, state)}${mean ? `, mean radiance ${words(mean)}` : ''}`;
  }

  /** True if there is such an image. @param {Subject} subject */
  known(subject) {
    return subject.world === 'own' ? this.composer.own !== null : subjectOf(nameOf(subject), this.run.data) !== undefined;
  }

  /** Everything as at the start. */
  reset() {
    this.sums = false;
    byId('hint').hidden = true;
    this.store.set(this.start);
  }

  /** Shows a world: the same part of it, if it has that part. @param {World} world */
  show(world) {
    const subject = { ...this.store.state.subject, world };
    this.store.set({ subject: this.known(subject) && world !== 'own' ? subject : { world, kind: 'whole', k: 0 } });
  }

  /** Shows term k, or the partial sum up to it. @param {number} k */
  term(k) {
    const { world } = this.store.state.subject;
    const subject = /** @type {Subject} */ ({ world: termsOf(this, world), kind: this.sums ? 'sum' : 'term', k });
    if (this.known(subject)) this.store.set({ subject });
  }

  /** Shows partial sums, or terms. @param {boolean} on */
  summing(on) {
    const { subject } = this.store.state;
    const [from, to] = on ? ['term', 'sum'] : ['sum', 'term'];
    this.sums = on;
    this.store.set({ subject: subject.kind === from ? /** @type {Subject} */ ({ ...subject, kind: to }) : { ...subject } });
  }

  /** Shows the reference as long as Shift is held. @param {boolean} on */
  peek(on) {
    if (on === this.#peeking) return;
    this.#peeking = on;
    this.ask();
  }

  /** Plays the partial sums, or stops. */
  play() {
    if (this.#playing) {
      clearInterval(this.#playing);
      this.#playing = undefined;
      return;
    }
    const world = worldWithTerms(this);
    this.sums = true;
    const all = subjectsOf(this, world).filter((s) => s.kind === 'sum' || s.kind === 'whole');
    let at = 0;
    const beat = () => {
      this.store.set({ subject: all[at], gain: 'one' });
      at += 1;
      if (at === all.length) this.play();
    };
    this.#playing = setInterval(beat, BEAT);
    beat();
  }

  /** The map of z between two answers. */
  bias() {
    const { state } = this.store;
    if (state.metric === 'z') return this.store.set({ metric: 'value' });
    const worlds = this.run.data.worlds.map((a) => a.world);
    const first = worldWithTerms(this);
    const other = worlds.includes('path') ? 'path' : worlds.find((w) => w !== first);
    if (!other) return undefined;
    return this.store.set({
      metric: 'z',
      subject: { world: first, kind: 'whole', k: 0 },
      reference: { world: other, kind: 'whole', k: 0 },
      spp: null,
    });
  }
}

/**
 * What a difference is, in words.
 * @param {State} state @param {Subject} subject @param {(s: Subject) => string} how
 */
function compared({ metric, reference }, subject, how) {
  const [a, b] = [subject, reference].map((s) => `${symbol(s)} (${WORLD_NAMES[s.world]}${how(s)})`);
  return { value: a, difference: `${a} − ${b}`, absolute: `|${a} − ${b}|`, relative: `relative: ${a} − ${b}`, z: `z of ${a} − ${b}` }[metric];
}

/** Share of the pixels with |z| > 2, of those that have a z. @param {Float32Array} z three equal values per pixel */
function farOut(z) {
  // where no light arrived there is no z
  let [far, all] = [0, 0];
  for (let i = 0; i < z.length; i += 3) {
    all += z[i] === 0 ? 0 : 1;
    far += Math.abs(z[i]) > 2 ? 1 : 0;
  }
  return far / Math.max(all, 1);
}

/** Starts the page. */
export async function start() {
  const run = new Run(JSON.parse(byId('run').textContent ?? ''));
  await run.load();
  byId('view').hidden = false;
  for (const still of document.querySelectorAll('[data-still]')) still.remove();
  const app = new App(run);
  [controls, whatIf, samples, probe, plots, own, share, keys, tries].forEach((part) => part(app));
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let later;
  app.store.drawnBy((state) => {
    app.ask();
    clearTimeout(later);
    later = setTimeout(() => {
      history.replaceState(null, '', `#${written(state, app.start)}`);
      app.speak();
    }, 250);
  });
  window.addEventListener('hashchange', () => app.store.set(read(location.hash, app.start, run.data)));
  app.draw();
  document.documentElement.dataset.ready = 'true';
  performance.mark('ready');
}
