// Questions to start with. Each sets the view and says what to look at; the reader finds the answer.

import { byId } from '#page/controls.js';
import { worldWithTerms } from '#page/what_if.js';

/** @import { App } from '#page/main.js' */
/** @import { State } from '#page/types.js' */

/** @type {Record<string, {says: string, set: (app: App) => Partial<State> | undefined}>} */
const TRIES = {
  bounce: {
    says: 'Press 1, 2, 3 to see the light that was scattered once, twice, three times. Then click a surface: the bars beside the image say how much each bounce adds there. Shift and a drag (or the box “Drag to choose a block”) choose a block of pixels, which has less noise. The table “Which bounce lights what?” further down has the shares of whole surfaces.',
    set: (app) => ({ subject: { world: worldWithTerms(app), kind: 'term', k: 1 }, metric: 'value', gain: 'each', spp: null }),
  },
  half: {
    says: 'Every scattering is now half as strong: the term of k bounces is multiplied by 0.5ᵏ. Move the slider s and read how much of the light is left. The lamps stay as they are.',
    set: (app) => ({ subject: { world: worldWithTerms(app), kind: 'whole', k: 0 }, metric: 'value', scale: [0.5, 0.5, 0.5], spp: null }),
  },
  noise: {
    says: 'Both terms with their first samples only. Switch between TE and T²E (keys 1 and 2), then move the slider of the samples. The text below the slider compares their noise and says where it comes from.',
    set: (app) => {
      const spp = Math.min(...app.run.data.early.map((l) => l.spp));
      return Number.isFinite(spp) ? { subject: { world: 'terms', kind: 'term', k: 2 }, metric: 'value', gain: 'each', spp } : undefined;
    },
  },
  bias: {
    says: 'z is the difference of two answers in units of its standard error. Where they agree it is noise, with about 1 pixel in 20 beyond 2. A pattern would be a bias. Press b to leave.',
    set: (app) => {
      app.bias();
      return {};
    },
  },
};

/** @param {App} app */
export function tries(app) {
  for (const button of document.querySelectorAll('[data-try]')) {
    const { says, set } = TRIES[/** @type {HTMLElement} */ (button).dataset.try ?? ''];
    button.addEventListener('click', () => {
      app.reset();
      const change = set(app);
      if (!change) return;
      app.store.set(change);
      byId('hint').textContent = says;
      byId('hint').hidden = false;
    });
    const needs = { noise: app.run.data.early.length > 0, bias: app.run.data.worlds.length > 1, half: app.run.hasTerms(worldWithTerms(app)), bounce: app.run.hasTerms(worldWithTerms(app)) };
    /** @type {HTMLElement} */ (button).hidden = !needs[/** @type {keyof typeof needs} */ (/** @type {HTMLElement} */ (button).dataset.try)];
  }
}
