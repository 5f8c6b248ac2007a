// Links, pictures and reports to hand in.

import { byId } from '#page/controls.js';
import { WORLD_NAMES, meaning, percent, plusMinus, significant, symbol } from '#page/format.js';
import { leftOut, meanOf, meanOfPixels, words } from '#page/reading.js';
import { valueAt } from '#page/probe.js';
import { nameOf, written } from '#page/state.js';

/** @import { App } from '#page/main.js' */
/** @import { State, Subject } from '#page/types.js' */

/** @param {App} app */
export function share(app) {
  const say = (/** @type {string} */ text) => (byId('share-text').textContent = text);
  byId('copy-link').addEventListener('click', async () => say(await copied(address(app))));
  byId('save-png').addEventListener('click', async () => {
    saved(await picture(app), `${fileName(app)}.png`);
    say('The image was saved as it is seen, with its command below it.');
  });
  byId('save-md').addEventListener('click', () => {
    saved(new Blob([markdown(app)], { type: 'text/markdown' }), `${app.run.data.scene}.md`);
    say('The report was saved.');
  });
  byId('print').addEventListener('click', () => window.print());
  for (const button of document.querySelectorAll('[data-save-svg]')) {
    const id = /** @type {HTMLElement} */ (button).dataset.saveSvg ?? '';
    button.addEventListener('click', () => {
      const text = svg(app, id);
      if (text) saved(new Blob([text], { type: 'image/svg+xml' }), `${app.run.data.scene}-${id}.svg`);
    });
  }
  folded();
}

/** @param {App} app */
function address(app) {
  const part = written(app.store.state, app.start);
  return `${location.href.split('#')[0]}${part ? `#${part}` : ''}`;
}

/** @param {string} text */
async function copied(text) {
  try {
    await navigator.clipboard.writeText(text);
    return 'The link was copied.';
  } catch {
    return `The link: ${text}`;
  }
}

/** @param {App} app */
const fileName = (app) => `${app.run.data.scene}-${nameOf(app.store.state.subject).replace(':', '-')}`;

/** @param {Blob} blob @param {string} name */
function saved(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** The image at its own size with its label and command. @param {App} app @returns {Promise<Blob>} */
function picture(app) {
  const { width, height, command } = app.run.data;
  const scale = Math.max(1, Math.round(512 / Math.max(width, height)));
  const [w, lines] = [width * scale, [byId('tag').textContent ?? '', ramp(), command, address(app).split('#')[1] ?? '']];
  const out = new OffscreenCanvas(w, height * scale + 16 * lines.length + 12);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (out.getContext('2d'));
  context.fillStyle = '#fff';
  context.fillRect(0, 0, out.width, out.height);
  context.imageSmoothingEnabled = false;
  context.drawImage(app.viewer.images[0].canvas, 0, 0, w, height * scale);
  context.fillStyle = '#000';
  context.font = '12px system-ui, sans-serif';
  lines.filter(Boolean).forEach((line, i) => context.fillText(line, 6, height * scale + 18 + 16 * i, w - 12));
  return out.convertToBlob({ type: 'image/png' });
}

/** The range of the colours, if they are not those of the scene. */
function ramp() {
  const [from, , to] = [...byId('ramp').children].map((e) => e.textContent);
  return byId('ramp').hidden ? '' : `colours from ${from} to ${to}`;
}

/** A plot as a file of its own. @param {App} app @param {string} id */
function svg(app, id) {
  const element = byId(id)?.querySelector('svg');
  if (!element) return undefined;
  const copy = /** @type {SVGSVGElement} */ (element.cloneNode(true));
  const style = getComputedStyle(element);
  const colours = ['--ink', '--soft', '--line', '--c1', '--c2', '--c3', '--c4', '--c5', '--c6', '--c7', '--c8'];
  const css = document.createElementNS(element.namespaceURI, 'style');
  css.textContent = `svg { ${colours.map((c) => `${c}: ${style.getPropertyValue(c)}`).join('; ')}; background: ${style.getPropertyValue('--paper')}; }
    text { font: 12px sans-serif; fill: var(--ink); } .grid { stroke: var(--line); } .edge { stroke: var(--soft); fill: none; } .ring { display: none; }`;
  copy.prepend(css);
  const comment = document.createComment(` ${app.run.data.command.replaceAll('--', '- -')} `);
  copy.prepend(comment);
  return new XMLSerializer().serializeToString(copy);
}

/** Folded tables are unfolded for the printer. */
function folded() {
  /** @type {HTMLDetailsElement[]} */
  let opened = [];
  window.addEventListener('beforeprint', () => {
    opened = [...document.querySelectorAll('details')].filter((d) => !d.open);
    opened.forEach((d) => (d.open = true));
  });
  window.addEventListener('afterprint', () => opened.forEach((d) => (d.open = false)));
}

/** The report as Markdown: answer, numbers, verdicts, and the view. @param {App} app */
export function markdown(app) {
  const { data } = app.run;
  const { state, start } = { state: app.store.state, start: app.start };
  const answer = document.querySelector('.answer')?.textContent ?? '';
  const lines = [`# ${data.scene}`, '', answer, '', '```sh', data.command, '```', ''];
  lines.push(`${data.full[0]} × ${data.full[1]} pixels, ${data.spp} samples per pixel, seed ${data.seed}, K = ${data.max_bounces}.`, '');
  for (const verdict of data.verdicts) lines.push(`- ${verdict}`);
  lines.push('', '## Mean radiance', '', 'W sr⁻¹ m⁻², mean of the channels, ± half a 95 % interval.', '');
  const worlds = data.worlds.map((a) => a.world);
  lines.push(`| k | ${worlds.map((w) => WORLD_NAMES[w]).join(' | ')} |`, `|:---|${worlds.map(() => '---:|').join('')}`);
  const row = (/** @type {string} */ name, /** @type {(w: typeof worlds[0]) => Subject} */ of) => {
    const cell = (/** @type {typeof worlds[0]} */ w) => {
      const subject = of(w);
      const found = app.known(subject) ? meanOf(app, subject, start) : null;
      return found ? words(found) : '';
    };
    return `| ${name} | ${worlds.map(cell).join(' | ')} |`;
  };
  for (let k = 0; k <= data.max_bounces; k += 1) lines.push(row(String(k), (world) => ({ world, kind: 'term', k })));
  lines.push(row('rest', (world) => ({ world, kind: 'rest', k: 0 })), row('whole', (world) => ({ world, kind: 'whole', k: 0 })), '');
  lines.push(...view(app, state));
  return `${lines.join('\n')}\n`;
}

/** The view at this moment. @param {App} app @param {State} state */
function view(app, state) {
  const { subject } = state;
  const first = app.composer.isFirst(subject, state);
  const mean = first ? null : meanOf(app, subject, state);
  const value = mean ? words(mean) : `${significant(meanOfPixels(app, subject, state))}, from the pixels`;
  const lines = ['## This view', '', `${byId('tag').textContent}`, '', `${symbol(subject)}: ${meaning(subject, app.run.data.max_bounces)}. Mean radiance ${value}.`];
  if (first) lines.push('', `Only the first ${state.spp} samples of each pixel.`);
  if (app.run.hasTerms(subject.world)) {
    if (state.scale.some((s) => s !== 1)) lines.push('', `Every scattering scaled by s = ${state.scale.join(', ')} in red, green, blue.`);
    const off = leftOut(app, subject, state);
    if (off.length) lines.push('', `Left out: ${off.join(', ')}.`);
  }
  if (state.pixel || state.tiles) {
    const world = app.run.hasTerms(subject.world) ? subject.world : 'terms';
    const terms = Array.from({ length: app.run.data.max_bounces + 1 }, (_, k) => /** @type {Subject} */ ({ world, kind: 'term', k }));
    if (app.run.layer(world, 'rest')) terms.push({ world, kind: 'rest', k: 0 });
    const values = terms.filter((s) => app.known(s)).map((s) => valueAt(app, s, state));
    const whole = valueAt(app, { world, kind: 'whole', k: 0 }, state)?.value ?? NaN;
    lines.push('', `### ${byId('probe-title').textContent}`, '', '| k | radiance | share |', '|:---|---:|---:|');
    values.forEach((v, k) => lines.push(`| ${terms[k].kind === 'rest' ? 'rest' : k} | ${plusMinus(v?.value ?? NaN, v?.half ?? 0)} | ${percent((v?.value ?? NaN) / whole)} |`));
  }
  const part = written(state, app.start);
  if (part) lines.push('', `Open \`index.html#${part}\` to see it.`);
  return lines;
}
