// The page of a run in a real browser, opened from disk: what the reader presses, and the numbers that the reader sees.
import { AxeBuilder } from '@axe-core/playwright';
import { expect, test } from '@playwright/test';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { readExr } from '../../src/report/page/script/exr.js';
import { box, terms } from './run.js';

/** Half floats keep 11 bits. */
const HALF = 2 ** -11;

/** @type {string[]} */
let problems = [];
test.beforeEach(async ({ page }) => {
  problems = [];
  page.on('console', (m) => m.type() === 'error' && problems.push(m.text()));
  page.on('pageerror', (e) => problems.push(e.message));
  page.on('request', (r) => /^(file|data|blob):/.test(r.url()) || problems.push(`asks the network for ${r.url()}`));
});
test.afterEach(() => expect(problems).toEqual([]));

/** @param {import('@playwright/test').Page} page @param {string} address */
async function open(page, address) {
  await page.goto(address);
  await page.locator('html[data-ready]').waitFor();
}

/** @param {number[]} v */
const average = (v) => (v[0] + v[1] + v[2]) / 3;

/** The state as the page would write it into the address. @param {import('@playwright/test').Page} page */
async function hash(page) {
  await page.waitForTimeout(320);
  return new URL(page.url()).hash;
}

/** The pixels of a layer of terms.exr. @param {string} folder */
async function layersOf(folder) {
  const file = readFileSync(join(folder, 'terms.exr'));
  const { channels } = await readExr(file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength));
  return (/** @type {string} */ layer) => ['R', 'G', 'B'].map((c) => /** @type {Float32Array} */ (channels.get(`${layer}.${c}`)));
}

test('keys choose terms, sums, answers, exposure and metric, and the address remembers them', async ({ page }) => {
  await open(page, box().page);
  const tag = page.locator('#tag');
  await expect(tag).toHaveText(/^L .* series$/);
  await page.keyboard.press('3');
  await expect(tag).toHaveText(/^T³E ×/);
  await page.keyboard.press('s');
  await expect(tag).toHaveText(/^S₃ /);
  await page.keyboard.press('ArrowRight');
  await expect(tag).toHaveText(/^S₄ /);
  await page.keyboard.press('ArrowDown');
  await expect(tag).toHaveText(/path tracer$/);
  await page.keyboard.press('ArrowDown');
  await expect(tag).toHaveText(/radiosity$/);
  await page.keyboard.press('1');
  await page.keyboard.press('e');
  await expect(page.locator('#exposure-value')).toHaveText('+0.5 EV');
  await page.keyboard.press('E');
  await page.keyboard.press('E');
  await expect(page.locator('#exposure-value')).toHaveText('−0.5 EV');
  expect(await hash(page)).toContain('exposure=-0.5');
  await page.keyboard.press('r');
  expect(await hash(page)).toBe('');
  await page.keyboard.press('b');
  await expect(tag).toHaveText(/^z of/);
  expect(await hash(page)).toContain('metric=z');
  const address = page.url();
  await page.goto('about:blank');
  await open(page, address);
  await expect(tag).toHaveText(/^z of/);
  await page.keyboard.press('?');
  await expect(page.locator('#help')).toBeVisible();
  await page.keyboard.press('Escape');
  await page.keyboard.press('r');
  await page.keyboard.down('Shift');
  await expect(tag).toHaveText(/path tracer/);
  await page.keyboard.up('Shift');
  await expect(tag).toHaveText(/series/);
  await page.keyboard.press('Shift+Digit2');
  await page.keyboard.press('w');
  await expect(page.locator('#tag-right')).toHaveText(/^T²E ×\d+ · series$/);
});

test('zoom and pan stay when the image changes', async ({ page }) => {
  await open(page, box().page);
  await page.locator('#canvas').hover({ position: { x: 120, y: 150 } });
  await page.mouse.wheel(0, -480);
  const before = /frame=[^&]*/.exec(await hash(page))?.[0];
  expect(before).toBeTruthy();
  await page.keyboard.press('2');
  await page.keyboard.press('ArrowDown');
  expect(await hash(page)).toContain(before);
  await page.keyboard.press('f');
  expect(await hash(page)).not.toContain('frame');
});

test('means are those of summary.json', async ({ page }) => {
  const { page: address, summary } = box();
  await open(page, address);
  const found = await page.evaluate(async () => {
    const { imageMean } = await import('#page/statistics.js');
    const { weights } = await import('#page/scale.js');
    const { Run } = await import('#page/run.js');
    const { initial } = await import('#page/state.js');
    const data = JSON.parse(document.getElementById('run')?.textContent ?? '');
    const run = new Run(data);
    const state = initial(data);
    const of = (/** @type {any} */ subject) => imageMean(/** @type {any} */ (run.answer(subject.world)), weights(run, subject, state));
    return data.worlds.map((/** @type {any} */ a) => ({
      world: a.world,
      whole: of({ world: a.world, kind: 'whole', k: 0 }),
      terms: a.mean.length > 1 ? a.mean.slice(0, -1).map((/** @type {any} */ _, /** @type {number} */ k) => of({ world: a.world, kind: 'term', k })) : [],
      sum: a.mean.length > 1 ? of({ world: a.world, kind: 'sum', k: data.max_bounces }) : null,
    }));
  });
  expect(found.map((/** @type {any} */ f) => f.world)).toEqual(['terms', 'path', 'radiosity']);
  const close = (/** @type {any} */ a, /** @type {any} */ b) => {
    for (const c of [0, 1, 2]) {
      expect(a.mean[c] / b.mean[c]).toBeCloseTo(1, 5);
      if (b.std_error[c]) expect(a.error[c] / b.std_error[c]).toBeCloseTo(1, 5);
    }
  };
  for (const one of found) {
    const { functionals } = summary.series.find((/** @type {any} */ s) => s.world === one.world && !/coarse/.test(s.label));
    close(one.whole, functionals[0].total);
    one.terms.forEach((/** @type {any} */ t, /** @type {number} */ k) => close(t, functionals[0].terms[k]));
    if (one.sum) close(one.sum, functionals[0].sum);
  }
});

test('pixels are those of terms.exr, to the precision of their storage', async ({ page }) => {
  const { folder, page: address } = box();
  await open(page, address);
  const layer = await layersOf(folder);
  const found = await page.evaluate(async () => {
    const { Run } = await import('#page/run.js');
    const data = JSON.parse(document.getElementById('run')?.textContent ?? '');
    const run = new Run(data);
    await run.load();
    return data.layers.map((/** @type {any} */ l) => ({
      id: l.id,
      step: l.codes[1],
      mean: Array.from(run.means.get(l.id) ?? []),
      error: Array.from(run.errors.get(l.id) ?? []),
    }));
  });
  expect(found.length).toBe(9 + 2 + 1 + 9 + 2);
  for (const { id, step, mean, error } of found) {
    // no layer of the file holds the rest of the matrix
    if (id === 'Rrest') continue;
    const planes = layer(id);
    const largest = Math.max(...planes.map((p) => p.reduce((a, v) => Math.max(a, v), 0)));
    const apart = mean.map((/** @type {number} */ v, /** @type {number} */ i) => Math.abs(v - planes[i % 3][Math.floor(i / 3)]) - HALF * planes[i % 3][Math.floor(i / 3)]);
    expect(Math.max(0, ...apart), id).toBeLessThanOrEqual(largest * 2 ** -38);
    const errors = layer(`${id}_se`);
    const top = Math.max(...errors.map((p) => p.reduce((a, v) => Math.max(a, v), 0)));
    const worst = error.map((/** @type {number} */ v, /** @type {number} */ i) => {
      const truth = errors[i % 3][Math.floor(i / 3)];
      return truth > top * 2 ** -23 ? Math.abs(Math.log2(v / truth)) : 0;
    });
    expect(Math.max(0, ...worst), `${id}_se`).toBeLessThanOrEqual(step / 2 + 1e-4);
  }
});

test('the sliders give the scaled series with its error', async ({ page }) => {
  const { page: address, summary } = box();
  await open(page, address);
  await page.locator('#s-all').fill('0.5');
  await expect(page.locator('#s-green-value')).toHaveText('0.50');
  const { functionals } = summary.series[0];
  const known = functionals[0].terms.reduce((/** @type {number} */ a, /** @type {any} */ t, /** @type {number} */ k) => a + 0.5 ** k * average(t.mean), 0);
  const upper = known + 0.5 ** 9 * average(functionals[0].tail.mean);
  const said = /whole sum ([\d.]+) ±/.exec((await page.locator('#what-if-text').textContent()) ?? '');
  expect(Number(said?.[1]) / upper).toBeCloseTo(1, 3);
  const slack = Number(((await page.locator('#slack').textContent()) ?? '').replace('−', '-'));
  expect(slack / (upper - known)).toBeCloseTo(1, 1);
  const mean = Number.parseFloat((await page.locator('#mean').textContent()) ?? '');
  expect(mean / upper).toBeCloseTo(1, 3);
  // what the lamps send to the camera is not scattered
  const before = functionals[0].total.mean.map((/** @type {number} */ v, /** @type {number} */ c) => v - functionals[0].terms[0].mean[c]);
  const scattered = Number.parseFloat((await page.locator('#scattered').textContent()) ?? '');
  expect(scattered / ((100 * (upper - average(functionals[0].terms[0].mean))) / average(before))).toBeCloseTo(1, 1);
  // beyond what surfaces can reflect it is said
  await page.locator('#s-all').fill('1.4');
  await expect(page.locator('#what-if-text')).toContainText('Not physical');
  await expect(page.locator('#what-if-text')).toContainText('extrapolated');
  await page.locator('#what-if-reset').click();
  await expect(page.locator('#s-all-value')).toHaveText('1.00');
  // without a term, the residual is that term
  await page.locator('#on-1').uncheck();
  const text = (await page.locator('#residual').textContent()) ?? '';
  const residual = Number(/= ([\d.]+)/.exec(text)?.[1]);
  expect(residual / average(functionals[0].terms[1].mean)).toBeCloseTo(1, 1);
});

test('a click shows the series of a pixel, Shift and a drag that of a block', async ({ page }) => {
  const { folder, page: address } = box();
  await open(page, `${address}#pixel=48,40`);
  const layer = await layersOf(folder);
  const i = 40 * 96 + 48;
  await expect(page.locator('#probe-title')).toHaveText('Pixel 48, 40');
  await page.locator('#probe-text summary').click();
  const cell = await page.locator('#probe-text tbody tr').nth(1).locator('td').first().textContent();
  expect(Number.parseFloat(cell ?? '') / layer('T01')[0][i]).toBeCloseTo(1, 2);
  // the whole image is in the middle of the canvas
  const canvas = page.locator('#canvas');
  const size = /** @type {{width: number, height: number}} */ (await canvas.boundingBox());
  const zoom = Math.min(size.width, size.height) / 96;
  const at = (/** @type {number} */ x, /** @type {number} */ y) => ({ x: size.width / 2 + (x + 0.5 - 48) * zoom, y: size.height / 2 + (y + 0.5 - 48) * zoom });
  await canvas.click({ position: at(20, 70) });
  await expect(page.locator('#probe-title')).toHaveText('Pixel 20, 70');
  await page.keyboard.down('Shift');
  await canvas.hover({ position: at(1, 1) });
  await page.mouse.down();
  await canvas.hover({ position: at(40, 20) });
  await page.mouse.up();
  await page.keyboard.up('Shift');
  await expect(page.locator('#probe-title')).toHaveText('Block of pixels 0, 0 to 41, 23');
  await expect(page.locator('#probe-text')).toContainText('replicates');
  expect(await hash(page)).toContain('tiles=0,0,7,4');
});

test('a block that is the whole image has the error of the image', async ({ page }) => {
  const { page: address, summary } = box();
  await open(page, address);
  const found = await page.evaluate(async () => {
    const { blockMean } = await import('#page/statistics.js');
    const { Run } = await import('#page/run.js');
    const data = JSON.parse(document.getElementById('run')?.textContent ?? '');
    const run = new Run(data);
    await run.load();
    const answer = /** @type {any} */ (run.answer('terms'));
    return blockMean(run, answer, [0, 0, 16, 16], answer.mean.map((/** @type {any} */ _, /** @type {number} */ j) => (j === 2 ? [1, 1, 1] : [0, 0, 0])));
  });
  const truth = summary.series[0].functionals[0].terms[2];
  for (const c of [0, 1, 2]) {
    expect(found.mean[c] / truth.mean[c]).toBeCloseTo(1, 3);
    expect(found.error[c] / truth.std_error[c]).toBeCloseTo(1, 2);
  }
});

test('the picture of the reader is compared, and what cannot be read is said', async ({ page }) => {
  const { folder, page: address } = box();
  await open(page, address);
  await page.locator('#own-file').setInputFiles(join(folder, 'terms.exr'));
  await expect(page.locator('#own-text')).toContainText('layer path');
  await expect(page.locator('#tag')).toHaveText(/your picture/);
  await page.locator('#metric').selectOption('difference');
  const same = await page.evaluate(() => document.getElementById('reading')?.textContent);
  expect(same).toContain('your picture');
  await page.locator('#own-file').setInputFiles(join(folder, 'summary.json'));
  await expect(page.locator('#own-text')).toContainText('neither an EXR nor a PNG');
  await page.locator('#own-file').setInputFiles(join(folder, 'path.png'));
  await expect(page.locator('#own-text')).toContainText('a caption, are left out');
  // two right answers differ by noise: the share of |z| > 2 between two answers
  await page.keyboard.press('r');
  await page.keyboard.press('b');
  const far = Number.parseFloat((await page.locator('#far').textContent()) ?? '');
  expect(far).toBeGreaterThan(2);
  expect(far).toBeLessThan(9);
});

test('the first samples have the mean of all', async ({ page }) => {
  await open(page, box().page);
  await page.locator('#spp').fill('0');
  await expect(page.locator('#tag')).toHaveText(/16 samples/);
  const text = (await page.locator('#samples-text').textContent()) ?? '';
  const few = Number(/mean ([\d.]+) before clipping/.exec(text)?.[1]);
  const all = Number(/With all 256 samples: mean ([\d.]+)/.exec(text)?.[1]);
  // the noise of 16 × 96² paths, and the codes of the early image
  expect(Math.abs(few / all - 1)).toBeLessThan(0.05);
  // both cards count the same clipped pixels
  const share = /\(([\d.]+ %)\) are too bright/.exec((await page.locator('#reading').textContent()) ?? '')?.[1];
  await expect(page.locator('#samples-text')).toContainText(`${share} of the pixels clipped`);
  // of other images the first samples are not kept, and nothing claims them
  await page.keyboard.press('4');
  await expect(page.locator('#tag')).not.toHaveText(/samples/);
  expect(await hash(page)).not.toContain('spp');
});

test('links ask for nothing that cannot be', async ({ page }) => {
  const { page: address } = box();
  // the first samples are not scaled, and s ends before the series diverges
  await open(page, `${address}#show=terms:T2&spp=16&s=0.5,0.5,0.5`);
  await expect(page.locator('#tag')).toHaveText(/16 samples$/);
  await expect(page.locator('#s-all-value')).toHaveText('1.00');
  await page.goto('about:blank');
  await open(page, `${address}#s=9,9,9&show=nonsense&pixel=-3,7&constructor=1&off=1`);
  await expect(page.locator('#reading')).not.toContainText('not finite');
  await expect(page.locator('#reading')).toContainText('Left out: TE.');
  await expect(page.locator('#tag')).toHaveText(/series · s = \d.*some terms off$/);
  // the path tracer has no terms, and its label claims no s
  await page.keyboard.press('ArrowDown');
  await expect(page.locator('#tag')).toHaveText(/path tracer$/);
});

test('plots tell values and lead to the image', async ({ page }) => {
  await open(page, box().page);
  const plot = page.locator('#plot-variance svg');
  await plot.hover();
  await expect(page.locator('#plot-variance .hover')).toHaveText(/= \d+/);
  await plot.focus();
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Enter');
  expect(await hash(page)).toBeDefined();
  await expect(page.locator('#plot-decay svg')).toBeVisible();
});

test('a run without a rest says so', async ({ page }) => {
  await open(page, terms().page);
  await page.locator('#s-all').fill('0.5');
  await expect(page.locator('#what-if-text')).toContainText('paths were cut');
  await expect(page.locator('#residual')).toContainText('no path tracer');
});

test('reports can be handed in', async ({ page }) => {
  const { page: address, summary } = box();
  await open(page, address);
  const download = async (/** @type {string} */ id) => {
    const [file] = await Promise.all([page.waitForEvent('download'), page.locator(id).click()]);
    return readFileSync(await file.path());
  };
  const text = (await download('#save-md')).toString();
  expect(text).toContain(summary.command);
  expect(text).toContain('| whole |');
  expect((await download('#save-png')).subarray(1, 4).toString()).toBe('PNG');
  const svg = (await download('[data-save-svg="plot-decay"]')).toString();
  expect(svg).toContain('<svg');
  expect(svg).toContain(summary.command.replaceAll('--', '- -'));
});

for (const width of [1280, 390]) {
  for (const scheme of /** @type {const} */ (['light', 'dark'])) {
    test(`${width} px wide, ${scheme}: nothing is cut off, and axe finds no error`, async ({ page }) => {
      await page.setViewportSize({ width, height: 844 });
      await page.emulateMedia({ colorScheme: scheme });
      await open(page, `${box().page}#pixel=48,40`);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth);
      expect(wide).toBeLessThanOrEqual(width);
      const { violations } = await new AxeBuilder({ page }).analyze();
      expect(violations.map((v) => `${v.id}: ${v.nodes.map((n) => n.target).join(', ')}`)).toEqual([]);
    });
  }
}

test('a tap chooses a pixel and two fingers zoom', async ({ browser }) => {
  const context = await browser.newContext({ hasTouch: true, viewport: { width: 390, height: 844 } });
  const page = await context.newPage();
  await open(page, box().page);
  const canvas = page.locator('#canvas');
  await canvas.scrollIntoViewIfNeeded();
  await canvas.tap();
  await expect(page.locator('#probe-title')).toHaveText(/^Pixel \d+, \d+$/);
  const cdp = await context.newCDPSession(page);
  const area = /** @type {{x: number, y: number, width: number, height: number}} */ (await canvas.boundingBox());
  const [cx, cy] = [area.x + area.width / 2, area.y + area.height / 2];
  const touch = (/** @type {'touchStart' | 'touchMove' | 'touchEnd'} */ type, /** @type {number} */ apart) =>
    cdp.send('Input.dispatchTouchEvent', {
      type,
      touchPoints: type === 'touchEnd' ? [] : [{ x: cx - apart, y: cy, id: 1 }, { x: cx + apart, y: cy, id: 2 }],
    });
  await touch('touchStart', 30);
  for (const apart of [40, 60, 90]) await touch('touchMove', apart);
  await touch('touchEnd', 0);
  const frame = /frame=([\d.]+)/.exec(await hash(page));
  expect(Number(frame?.[1])).toBeGreaterThan((1.5 * area.width) / 96);
  await context.close();
});
