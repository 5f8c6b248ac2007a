// Plots as SVG: points with intervals, bars, straight lines, bands. The nearest point tells its value.

import { significant } from '#page/format.js';

/**
 * @typedef {object} Mark
 * @property {number} x
 * @property {number} y
 * @property {number} half       half width of the interval, 0 if none is known
 * @property {string} [says]     words for the reader; by default its value
 * @property {() => void} [open] what a click shows
 * @property {boolean} [chosen]
 */

/**
 * @typedef {object} Series
 * @property {string} label
 * @property {string} color
 * @property {'dot' | 'bar' | 'line'} [form]
 * @property {Mark[]} marks
 */

/**
 * @typedef {object} Chart
 * @property {string} title                    for readers who cannot see it
 * @property {string} x
 * @property {string} y
 * @property {boolean} [logX]
 * @property {boolean} [logY]
 * @property {string[]} [names]                names of x = 0, 1, …
 * @property {Series[]} series
 * @property {{label: string, color: string, from?: number, at: (x: number) => number}[]} [lines]
 * @property {boolean} [titled]                the title is also shown
 * @property {{label: string, color: string, from: number, to: number}[]} [bands]
 */

export const COLORS = ['var(--c1)', 'var(--c2)', 'var(--c3)', 'var(--c4)', 'var(--c5)', 'var(--c6)', 'var(--c7)', 'var(--c8)', 'var(--c9)', 'var(--c10)', 'var(--c11)', 'var(--c12)'];
const [WIDTH, HEIGHT] = [520, 300];
const [LEFT, RIGHT, TOP, BOTTOM] = [62, 12, 12, 44];

/** @typedef {(v: number) => number} Place */

/**
 * Draws a chart into an element.
 * @param {HTMLElement} into
 * @param {Chart} chart
 */
export function draw(into, chart) {
  const marks = chart.series.flatMap((s) => s.marks);
  const [x, xTicks] = axis(marks.map((m) => m.x), LEFT, WIDTH - RIGHT, chart.logX ? 2 : chart.names ? 'names' : 'counts');
  const limits = chart.logY && chart.logX ? (chart.lines ?? []).flatMap((l) => marks.map((m) => l.at(m.x))) : [];
  const ys = [...limits, ...marks.flatMap((m) => [m.y - m.half, m.y, m.y + m.half]), ...(chart.bands ?? []).flatMap((b) => [b.from, b.to])];
  const [y, yTicks] = axis(ys, HEIGHT - BOTTOM, TOP, chart.logY ? 10 : 'linear');
  const parts = [frame(chart, x, y, xTicks, yTicks)];
  for (const { from, to, color } of chart.bands ?? []) {
    const [a, b] = [y(from), y(to)];
    parts.push(`<rect x="${LEFT}" width="${WIDTH - LEFT - RIGHT}" y="${f(Math.min(a, b) - 1)}" height="${f(Math.abs(a - b) + 2)}" fill="${color}" opacity="0.35"/>`);
  }
  for (const { at, color, from } of chart.lines ?? []) {
    const last = xTicks[xTicks.length - 1][0];
    const ends = [Math.max(from ?? -Infinity, xTicks[0][0]), chart.logX ? last : last + 0.5];
    parts.push(`<path d="M${f(x(ends[0]))} ${f(y(at(ends[0])))}L${f(x(ends[1]))} ${f(y(at(ends[1])))}" stroke="${color}" stroke-width="1.6" stroke-dasharray="6 4" fill="none" clip-path="url(#plot-area)"/>`);
  }
  chart.series.forEach((s, i) => parts.push(one(s, x, y, 5 * (i - (chart.series.length - 1) / 2) * (chart.logX ? 0 : 1))));
  const svg = `<svg viewBox="0 0 ${WIDTH} ${HEIGHT}" role="img" aria-label="${attribute(chart.title)}">
    <clipPath id="plot-area"><rect x="${LEFT}" y="${TOP}" width="${WIDTH - LEFT - RIGHT}" height="${HEIGHT - TOP - BOTTOM}"/></clipPath>${parts.join('')}</svg>`;
  const keys = [...chart.series, ...(chart.lines ?? []), ...(chart.bands ?? [])].filter((s) => s.label);
  const legend = keys.length > 1 ? `<p class="key">${keys.map((k) => `<span><i${'at' in k ? ' class="dashed"' : ''} style="background-color:${k.color}"></i>${attribute(k.label)}</span>`).join('')}</p>` : '';
  into.innerHTML = `${chart.titled ? `<p class="key">${attribute(chart.title)}</p>` : ''}${svg}${legend}<p class="hover" aria-live="polite">Point at a mark, or use the arrow keys on the plot, to read its value.</p>`;
  listen(into, chart, x, y);
}

/** @param {number} v */
const f = (v) => (Number.isFinite(v) ? v.toFixed(1) : '-999');

/** @param {string} text */
const attribute = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('"', '&quot;');

/**
 * Places and ticks of an axis.
 * @param {number[]} values
 * @param {number} start @param {number} end
 * @param {2 | 10 | 'linear' | 'counts' | 'names'} kind
 * @returns {[Place, [number, string][]]}
 */
function axis(values, start, end, kind) {
  const finite = values.filter((v) => Number.isFinite(v) && (typeof kind === 'string' || v > 0));
  const [low, high] = finite.length ? [Math.min(...finite), Math.max(...finite)] : [1, 1];
  if (typeof kind === 'number') {
    const log = (/** @type {number} */ v) => Math.log(v) / Math.log(kind);
    const [a, b] = [Math.floor(log(low) - 0.05), Math.ceil(log(high) + 0.05)];
    const every = Math.ceil((b - a) / 7);
    const ticks = Array.from({ length: b - a + 1 }, (_, i) => a + i).filter((e) => (e - a) % every === 0);
    const place = (/** @type {number} */ v) => (v > 0 ? start + ((log(v) - a) / (b - a)) * (end - start) : start);
    return [place, ticks.map((e) => [kind ** e, kind === 10 ? `10${power(e)}` : String(kind ** e)])];
  }
  if (kind !== 'linear') {
    const place = (/** @type {number} */ v) => start + ((v - low + 0.5) / (high - low + 1)) * (end - start);
    const every = Math.ceil((high - low + 1) / 16);
    return [place, Array.from({ length: high - low + 1 }, (_, i) => low + i).filter((k) => k % every === 0).map((k) => [k, String(k)])];
  }
  const [a, b] = [Math.min(0, low), high > 0 ? high * 1.06 : 1];
  const raw = (b - a) / 5;
  const power10 = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power10).find((s) => s >= raw) ?? raw;
  const ticks = [];
  for (let t = Math.ceil(a / step); t * step <= b; t += 1) ticks.push(t * step);
  return [(v) => start + ((v - a) / (b - a)) * (end - start), ticks.map((t) => [t, tick(t, step)])];
}

/** A multiple of a step, without digits that are zero. @param {number} t @param {number} step */
const tick = (t, step) => String(Number((Math.round(t / step) * step).toPrecision(6))).replace('-', '−');

/** @param {number} e */
const power = (e) => [...String(e)].map((d) => (d === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(d)])).join('');

/**
 * @param {Chart} chart @param {Place} x @param {Place} y
 * @param {[number, string][]} xTicks @param {[number, string][]} yTicks
 */
function frame(chart, x, y, xTicks, yTicks) {
  const names = chart.names;
  const across = yTicks.map(([v, t]) => `<path class="grid" d="M${LEFT} ${f(y(v))}H${WIDTH - RIGHT}"/><text x="${LEFT - 6}" y="${f(y(v) + 4)}" text-anchor="end">${t}</text>`);
  const up = xTicks.map(([v, t]) => `<text x="${f(x(v))}" y="${HEIGHT - BOTTOM + 17}" text-anchor="middle">${names ? names[v] : t}</text>`);
  return `${across.join('')}${up.join('')}<path class="edge" d="M${LEFT} ${TOP}V${HEIGHT - BOTTOM}H${WIDTH - RIGHT}"/>
    <text x="${(LEFT + WIDTH) / 2}" y="${HEIGHT - 6}" text-anchor="middle">${attribute(chart.x)}</text>
    <text transform="translate(13 ${(HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">${attribute(chart.y)}</text>`;
}

/** @param {Series} s @param {Place} x @param {Place} y @param {number} shift */
function one({ color, form, marks }, x, y, shift) {
  const interval = (/** @type {Mark} */ m) => (m.half > 0 ? `<path d="M${f(x(m.x) + shift)} ${f(y(m.y - m.half))}V${f(y(m.y + m.half))}" stroke="${form === 'bar' ? 'var(--ink)' : color}" stroke-width="2"/>` : '');
  if (form === 'line') {
    const path = marks.filter((m) => m.y > 0).map((m, i) => `${i ? 'L' : 'M'}${f(x(m.x))} ${f(y(m.y))}`).join('');
    return `<path d="${path}" fill="none" stroke="${color}" stroke-width="2"/>${marks.map((m) => `<circle cx="${f(x(m.x))}" cy="${f(y(m.y))}" r="${m.chosen ? 5 : 2.5}" fill="${color}"/>`).join('')}${marks.map(interval).join('')}`;
  }
  const place = (/** @type {Mark} */ m) =>
    form === 'bar'
      ? `<rect x="${f(x(m.x) + shift - 11)}" width="22" y="${f(Math.min(y(m.y), y(0)))}" height="${f(Math.abs(y(m.y) - y(0)))}" fill="${color}"${m.chosen ? ' class="chosen"' : ''}/>`
      : `<circle cx="${f(x(m.x) + shift)}" cy="${f(y(m.y))}" r="${m.chosen ? 6 : 4}" fill="${color}"/>`;
  return marks.map((m) => place(m) + interval(m)).join('');
}

/**
 * Tells the value of the nearest mark; a click opens it.
 * @param {HTMLElement} into @param {Chart} chart @param {Place} x @param {Place} y
 */
function listen(into, chart, x, y) {
  const svg = /** @type {SVGSVGElement} */ (into.querySelector('svg'));
  const says = /** @type {HTMLElement} */ (into.querySelector('.hover'));
  const all = chart.series.flatMap((s) => s.marks.map((m) => ({ ...m, label: s.label, left: x(m.x), top: y(m.y) })));
  if (all.length === 0) return;
  const ordered = [...all].sort((a, b) => a.left - b.left);
  let at = -1;
  const tell = (/** @type {(typeof all)[0]} */ m) => {
    at = ordered.indexOf(m);
    const name = chart.names?.[m.x] ?? `${chart.x.split(' ').at(-1)} = ${+m.x.toPrecision(5)}`;
    const half = m.half > 0 ? ` ± ${significant(m.half, 2)}` : '';
    says.textContent = m.says ?? `${m.label ? `${m.label}, ` : ''}${name}: ${significant(m.y)}${half}`;
    svg.querySelector('.ring')?.remove();
    svg.insertAdjacentHTML('beforeend', `<circle class="ring" cx="${f(m.left)}" cy="${f(m.top)}" r="8"/>`);
  };
  const nearest = (/** @type {PointerEvent | MouseEvent} */ e) => {
    const box = svg.getBoundingClientRect();
    const [px, py] = [((e.clientX - box.left) / box.width) * WIDTH, ((e.clientY - box.top) / box.height) * HEIGHT];
    return all.reduce((a, b) => (Math.hypot(b.left - px, b.top - py) < Math.hypot(a.left - px, a.top - py) ? b : a));
  };
  svg.addEventListener('pointermove', (e) => tell(nearest(e)));
  svg.addEventListener('click', (e) => {
    const m = nearest(e);
    tell(m);
    m.open?.();
  });
  svg.setAttribute('tabindex', '0');
  svg.addEventListener('keydown', (e) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
    if (step) tell(ordered[(at + step + ordered.length) % ordered.length]);
    else if (e.key === 'Enter' && at >= 0) ordered[at].open?.();
    else return;
    e.preventDefault();
    e.stopPropagation();
  });
}
