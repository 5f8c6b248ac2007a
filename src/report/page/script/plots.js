// Decay of the terms and variance against samples, linked to the image: a click on a mark shows its term.

import { COLORS, draw } from '#page/chart.js';
import { byId } from '#page/controls.js';
import { same } from '#page/format.js';
import { termsOf } from '#page/what_if.js';

/** @import { App } from '#page/main.js' */
/** @import { Curve, Plot, State, Subject, World } from '#page/types.js' */

/** @param {App} app */
export function plots(app) {
  app.store.drawnBy((state, before) => {
    if (state.subject !== before.subject) show(app, state);
  });
  show(app, app.store.state);
}

/** @param {App} app @param {State} state */
function show(app, state) {
  const { decay, variance } = app.run.data;
  if (decay) {
    drawn(app, 'plot-decay', decay, {
      x: 'bounce k',
      y: 'mean radiance over all surfaces',
      logX: false,
      subject: (_, x) => ({ world: termsOf(app, state.subject.world), kind: 'term', k: Math.round(x) }),
      chosen: (_, x) => state.subject.kind === 'term' && state.subject.k === x,
    });
  }
  if (variance) {
    const subject = (/** @type {Curve} */ { of }) => (of ? subjectOf(of) : undefined);
    drawn(app, 'plot-variance', variance, {
      x: 'samples per pixel n',
      y: 'variance of the mean of n samples',
      logX: true,
      subject,
      chosen: (curve) => {
        const s = subject(curve);
        return s !== undefined && same(s, state.subject);
      },
    });
  }
}

/** @param {[World, import('#page/types.js').Slot]} of @returns {Subject} */
const subjectOf = ([world, slot]) => (typeof slot === 'number' ? { world, kind: 'term', k: slot } : { world, kind: slot, k: 0 });

/**
 * @param {App} app @param {string} id @param {Plot} plot
 * @param {{x: string, y: string, logX: boolean, subject: (c: Curve, x: number) => Subject | undefined, chosen: (c: Curve, x: number) => boolean}} how
 */
function drawn(app, id, plot, how) {
  const into = byId(id);
  if (!into) return;
  const marks = (/** @type {Curve} */ curve) =>
    curve.points.map(([x, y, half]) => {
      const subject = how.subject(curve, x);
      const open = () => {
        if (!subject || !app.known(subject)) return;
        app.store.set({ subject });
        byId('canvas').scrollIntoView({ block: 'center', behavior: 'smooth' });
      };
      return { x, y, half, chosen: how.chosen(curve, x), open };
    });
  draw(into, {
    title: plot.title,
    titled: true,
    x: how.x,
    y: how.y,
    logX: how.logX,
    logY: true,
    series: plot.curves.map((c, i) => ({
      label: c.label,
      color: COLORS[i % COLORS.length],
      form: how.logX ? 'line' : 'dot',
      marks: marks(c),
    })),
    lines: how.logX ? [slope(plot)] : plot.lines.map((l, i) => ({
      label: l.label,
      color: COLORS[(plot.curves.length + i) % COLORS.length],
      from: l.x0,
      at: (x) => l.value * l.ratio ** (x - l.x0),
    })),
  });
}

/** Independent samples: the variance falls like 1/n; drawn above the largest curve. @param {Plot} plot */
function slope(plot) {
  const level = 1.6 * Math.max(...plot.curves.flatMap((c) => c.points.map(([n, v]) => n * v)));
  return { label: 'slope −1: independent samples', color: 'var(--ink)', at: (/** @type {number} */ n) => level / n };
}

/**
 * Variance of one sample of a term, averaged over the pixels, if it was measured.
 * @param {App} app @param {import('#page/types.js').Slot} slot
 */
export function varianceOfOne(app, slot) {
  const curve = app.run.data.variance?.curves.find((c) => c.of?.[0] === 'terms' && c.of[1] === slot);
  const last = curve?.points.at(-1);
  return last && last[0] * last[1];
}
