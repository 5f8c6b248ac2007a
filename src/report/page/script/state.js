// What the reader has chosen, and its form in the address of the page.
//
//   index.html#show=terms:S3&against=path:whole&metric=z&exposure=1
//
// Only choices that differ from those at the start are in the address. What cannot be read is ignored.

import { TILES } from '#page/run.js';
import { largest } from '#page/scale.js';

/** @import { Data, Look, Metric, State, Subject, World } from '#page/types.js' */

/** @type {World[]} */
export const WORLDS = ['terms', 'path', 'radiosity', 'own'];
/** @type {Metric[]} */
export const METRICS = ['value', 'difference', 'absolute', 'relative', 'z'];
/** @type {Look[]} */
export const LOOKS = ['srgb', 'false', 'signed'];

/**
 * The state at the start: the whole image of the first world.
 * @param {Data} data
 * @returns {State}
 */
export function initial(data) {
  const worlds = data.worlds.map((a) => a.world);
  const first = worlds[0] ?? 'own';
  const reference = worlds.includes('path') ? 'path' : first;
  return {
    subject: { world: first, kind: 'whole', k: 0 },
    reference: { world: reference, kind: 'whole', k: 0 },
    metric: 'value',
    look: 'srgb',
    exposure: 0,
    offset: 0,
    gain: data.gain,
    wipe: null,
    scale: [1, 1, 1],
    on: Array.from({ length: data.max_bounces + 2 }, () => true),
    spp: null,
    pixel: null,
    tiles: null,
    frame: null,
  };
}

/** @param {Subject} s */
export const nameOf = ({ world, kind, k }) => `${world}:${{ term: `T${k}`, sum: `S${k}`, rest: 'rest', whole: 'whole' }[kind]}`;

/**
 * @param {string} text
 * @param {Data} data
 * @returns {Subject | undefined}
 */
export function subjectOf(text, data) {
  const found = /^(terms|path|radiosity|own):(?:([TS])(\d+)|(rest|whole))$/.exec(text);
  if (!found) return undefined;
  const [world, k] = [/** @type {World} */ (found[1]), Number(found[3] ?? 0)];
  const kind = found[2] ? (found[2] === 'T' ? 'term' : 'sum') : /** @type {'rest' | 'whole'} */ (found[4]);
  const known = data.layers.some((l) => l.world === world && (kind === 'whole' || l.slot === (kind === 'rest' ? kind : k)));
  return known ? { world, kind, k } : undefined;
}

/** How each choice is written and read. @type {Record<string, [(s: State) => string, (text: string, data: Data) => Partial<State> | undefined]>} */
const PARTS = {
  show: [(s) => nameOf(s.subject), (text, data) => given('subject', subjectOf(text, data))],
  against: [(s) => nameOf(s.reference), (text, data) => given('reference', subjectOf(text, data))],
  metric: [(s) => s.metric, (text) => given('metric', METRICS.find((m) => m === text))],
  look: [(s) => s.look, (text) => given('look', LOOKS.find((l) => l === text))],
  gain: [(s) => s.gain, (text) => given('gain', /** @type {const} */ (['each', 'one', 'off']).find((g) => g === text))],
  exposure: [(s) => String(s.exposure), (text) => given('exposure', numbers(text, 1)?.[0])],
  offset: [(s) => String(s.offset), (text) => given('offset', numbers(text, 1)?.[0])],
  wipe: [(s) => (s.wipe === null ? '' : s.wipe.toFixed(3)), (text) => given('wipe', within(text, 0, 1))],
  s: [(s) => s.scale.map((v) => +v.toFixed(3)).join(','), (text) => given('scale', numbers(text, 3)?.map((v) => Math.max(0, v)))],
  off: [
    (s) => s.on.flatMap((on, j) => (on ? [] : [j])).join(','),
    (text, data) => ({ on: Array.from({ length: data.max_bounces + 2 }, (_, j) => !text.split(',').includes(String(j))) }),
  ],
  spp: [(s) => (s.spp === null ? '' : String(s.spp)), (text, data) => given('spp', data.early.find((l) => String(l.spp) === text)?.spp)],
  pixel: [
    (s) => s.pixel?.join(',') ?? '',
    (text, { width, height }) => {
      const [x, y] = numbers(text, 2)?.map(Math.floor) ?? [-1, -1];
      return x >= 0 && y >= 0 && x < width && y < height ? { pixel: [x, y] } : undefined;
    },
  ],
  tiles: [
    (s) => s.tiles?.join(',') ?? '',
    (text) => {
      const [left, top, right, bottom] = numbers(text, 4)?.map(Math.floor) ?? [0, 0, 0, 0];
      const inside = left >= 0 && top >= 0 && left < right && top < bottom && right <= TILES && bottom <= TILES;
      return inside ? { tiles: [left, top, right, bottom] } : undefined;
    },
  ],
  frame: [
    (s) => (s.frame ? [s.frame.zoom, s.frame.x, s.frame.y].map((v) => +v.toFixed(4)).join(',') : ''),
    (text) => {
      const [zoom, x, y] = numbers(text, 3) ?? [0, 0, 0];
      return zoom > 0 ? { frame: { zoom, x, y } } : undefined;
    },
  ],
};

/** @template {keyof State} Key @param {Key} key @param {State[Key] | undefined} value */
const given = (key, value) => (value === undefined ? undefined : { [key]: value });

/** @param {string} text @param {number} count */
function numbers(text, count) {
  const all = text.split(',').map(Number);
  return all.length === count && all.every(Number.isFinite) ? all : undefined;
}

/** @param {string} text @param {number} low @param {number} high */
const within = (text, low, high) => numbers(text, 1)?.filter((v) => v >= low && v <= high)[0];

/**
 * The part of the address behind `#`.
 * @param {State} state @param {State} start
 */
export function written(state, start) {
  const of = (/** @type {State} */ s, /** @type {string} */ name) => PARTS[name][0](s);
  const changed = Object.keys(PARTS).filter((name) => of(state, name) !== of(start, name));
  return changed.map((name) => `${name}=${of(state, name)}`).join('&');
}

/**
 * The state that an address stands for.
 * @param {string} text @param {State} start @param {Data} data
 * @returns {State}
 */
export function read(text, start, data) {
  const parts = text.replace(/^#/, '').split('&').map((part) => part.split('='));
  const known = parts.filter(([name]) => Object.hasOwn(PARTS, name));
  const found = known.reduce((state, [name, value = '']) => ({ ...state, ...PARTS[name][1](decoded(value), data) }), start);
  const most = largest(data);
  const scale = found.scale.map((s, c) => Math.min(s, most[c]));
  return possible(found.spp === null ? { ...found, scale } : { ...found, scale: start.scale, on: start.on }, data);
}

/** The first samples are kept of some images only. @param {State} state @param {Data} data @returns {State} */
export function possible(state, data) {
  const { spp, subject } = state;
  const slot = subject.kind === 'term' ? subject.k : subject.kind;
  const kept = data.early.some((l) => l.spp === spp && l.world === subject.world && l.slot === slot);
  return spp === null || kept ? state : { ...state, spp: null };
}

/** @param {string} text */
function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** Holds the state and tells everyone who draws when it changes. */
export class Store {
  /** @type {((state: State, before: State) => void)[]} */
  #drawers = [];

  /** @param {State} state @param {(state: State) => State} possible the state that is shown for one that is asked for */
  constructor(state, possible) {
    this.state = state;
    this.possible = possible;
  }

  /** @param {(state: State, before: State) => void} draw */
  drawnBy(draw) {
    this.#drawers.push(draw);
  }

  /** @param {Partial<State>} change */
  set(change) {
    const [before, begin] = [this.state, performance.now()];
    this.state = this.possible({ ...before, ...change });
    this.#drawers.forEach((draw) => draw(this.state, before));
    performance.measure('state', { start: begin, end: performance.now() });
  }
}
