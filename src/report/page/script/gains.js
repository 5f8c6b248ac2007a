// The gain of each image: its own, one for all, or none; and fixed ones for relative differences and z.

import { autoGain, signedGain } from '#page/tone.js';
import { nameOf } from '#page/state.js';

/** @import { Composer } from '#page/compose.js' */
/** @import { Look, State, Subject } from '#page/types.js' */

/** Full colour at a relative difference of 10 %, and at three standard errors. */
const RELATIVE = 10;
const Z = 1 / 3;

/** The colours of an image: differences have a sign, their sizes have none. @param {State} state @returns {Look} */
export function lookOf({ metric, look }) {
  return metric === 'value' ? look : metric === 'absolute' ? 'false' : 'signed';
}

export class Gains {
  /** @type {Map<string, number>} */
  #known = new Map();

  /** @param {Composer} composer */
  constructor(composer) {
    this.composer = composer;
  }

  /** Forgets the gains of a picture that was replaced. */
  forget() {
    this.#known.clear();
  }

  /**
   * The gain before the exposure. It belongs to the unchanged series, so that an image gets darker when its terms do.
   * @param {Subject} subject
   * @param {State} state
   */
  of(subject, state) {
    const { metric, gain, reference } = state;
    if (metric === 'relative') return RELATIVE;
    if (metric === 'z') return Z;
    if (gain === 'off') return 1;
    const whole = /** @type {Subject} */ ({ world: this.composer.run.data.worlds[0]?.world ?? 'own', kind: 'whole', k: 0 });
    const of = metric === 'value' && gain === 'one' ? whole : subject;
    const name = [metric, nameOf(of), metric === 'value' ? '' : nameOf(reference)].join(' ');
    const found = this.#known.get(name) ?? this.#measure(of, { ...state, scale: [1, 1, 1], on: state.on.map(() => true), spp: null });
    this.#known.set(name, found);
    return found;
  }

  /** @param {Subject} subject @param {State} state */
  #measure(subject, state) {
    const pixels = this.composer.shown(state, subject);
    if (!pixels) return 1;
    if (state.metric !== 'value') return signedGain(pixels);
    // lamps would make the walls black
    const lamps = subject.kind === 'whole' || subject.kind === 'sum' ? this.composer.lamps(subject.world) : undefined;
    return autoGain(pixels, lamps);
  }
}
