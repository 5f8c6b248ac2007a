// The picture of the reader: an EXR or PNG file of the same scene, dropped onto the page or chosen, beside the reference.

import { byId, fill } from '#page/controls.js';
import { readExr } from '#page/exr.js';
import { linear } from '#page/tone.js';

/** @import { App } from '#page/main.js' */
/** @import { Exr } from '#page/exr.js' */

/** @typedef {{width: number, height: number, pixels: Float32Array, errors: Float32Array | null, eightBit: boolean, said: string}} Picture */

/** @param {App} app */
export function own(app) {
  const take = async (/** @type {File | undefined} */ file) => {
    if (!file) return;
    const say = (/** @type {string} */ words) => (byId('own-text').textContent = words);
    try {
      const picture = fitted(app, await read(file));
      app.composer.own = picture;
      app.gains.forget();
      fill(app);
      app.store.set({ subject: { world: 'own', kind: 'whole', k: 0 }, spp: null });
      say(`${file.name}: ${picture.said} Show its difference from the reference under “Show”.`);
    } catch (error) {
      say(`${file.name} cannot be shown: ${error instanceof Error ? error.message : error}.`);
    }
  };
  byId('own-file').addEventListener('change', (e) => take(/** @type {HTMLInputElement} */ (e.target).files?.[0]));
  document.addEventListener('dragover', (e) => e.preventDefault());
  document.addEventListener('drop', (e) => {
    e.preventDefault();
    take(e.dataTransfer?.files[0]);
  });
}

/** @param {File} file @returns {Promise<Picture>} */
async function read(file) {
  const buffer = await file.arrayBuffer();
  const magic = new DataView(buffer, 0, Math.min(buffer.byteLength, 4));
  if (magic.byteLength === 4 && magic.getUint32(0, true) === 20000630) return fromExr(await readExr(buffer));
  if (magic.byteLength === 4 && magic.getUint32(0) === 0x89504e47) return fromPng(file);
  throw new Error('it is neither an EXR nor a PNG file');
}

/** @param {Exr} exr @returns {Picture} */
function fromExr({ width, height, channels }) {
  const rgb = (/** @type {string} */ layer) => ['R', 'G', 'B'].map((c) => channels.get(layer ? `${layer}.${c}` : c));
  const whole = ['path', 'Tall', 'Tsum', 'Rfull'].find((l) => rgb(l).every(Boolean) && rgb(`${l}_se`).every(Boolean));
  const grey = channels.get('Y');
  const planes = whole ? rgb(whole) : rgb('').every(Boolean) ? rgb('') : grey ? [grey, grey, grey] : undefined;
  if (!planes) throw new Error(`it has no channels R, G, B, only ${[...channels.keys()].slice(0, 8).join(', ')}`);
  const errors = whole ? mixed(/** @type {Float32Array[]} */ (rgb(`${whole}_se`))) : null;
  const said = whole ? `floats of the layer ${whole}, with its standard errors.` : 'floats; its errors are not known.';
  return { width, height, pixels: mixed(/** @type {Float32Array[]} */ (planes)), errors, eightBit: false, said };
}

/** @param {Float32Array[]} planes */
function mixed(planes) {
  const out = new Float32Array(3 * planes[0].length);
  planes.forEach((plane, c) => plane.forEach((v, i) => (out[3 * i + c] = v)));
  return out;
}

/** @param {Blob} file @returns {Promise<Picture>} */
async function fromPng(file) {
  const bitmap = await createImageBitmap(file, { colorSpaceConversion: 'none', premultiplyAlpha: 'none' });
  const { width, height } = bitmap;
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(width, height).getContext('2d'));
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  const curve = Float32Array.from({ length: 256 }, (_, code) => linear(code / 255));
  const pixels = new Float32Array(3 * width * height);
  for (let i = 0; i < width * height; i += 1) {
    for (let c = 0; c < 3; c += 1) pixels[3 * i + c] = curve[data[4 * i + c]];
  }
  const said = '8 bits per channel, read as sRGB; its exposure and its errors are not known, and what was clipped is lost.';
  return { width, height, pixels, errors: null, eightBit: true, said };
}

/**
 * The picture in the size of the page.
 * @param {App} app @param {Picture} picture
 * @returns {Picture}
 */
function fitted(app, picture) {
  const { width, height, full, reduced } = app.run.data;
  if (picture.width === width && picture.height === height) return picture;
  if (reduced > 1 && picture.width === full[0] && picture.height === full[1]) {
    const pixels = blocks(picture.pixels, full, reduced, width, height);
    return { ...picture, width, height, pixels, errors: null, said: `${picture.said} Reduced like all images of this page.` };
  }
  if (picture.width === width && picture.height > height && picture.height < 1.5 * height) {
    const pixels = picture.pixels.slice(0, 3 * width * height);
    return { ...picture, height, pixels, errors: null, said: `${picture.said} The lowest ${picture.height - height} rows, a caption, are left out.` };
  }
  throw new Error(`it has ${picture.width} × ${picture.height} pixels, and this page ${full[0]} × ${full[1]}`);
}

/** Means of blocks of n × n pixels. @param {Float32Array} pixels @param {[number, number]} full @param {number} n @param {number} w @param {number} h */
function blocks(pixels, full, n, w, h) {
  const out = new Float32Array(3 * w * h);
  for (let y = 0; y < h; y += 1) {
    for (let x = 0; x < w; x += 1) {
      const [right, bottom] = [Math.min((x + 1) * n, full[0]), Math.min((y + 1) * n, full[1])];
      const count = (right - x * n) * (bottom - y * n);
      for (let v = y * n; v < bottom; v += 1) {
        for (let u = x * n; u < right; u += 1) {
          for (let c = 0; c < 3; c += 1) out[3 * (y * w + x) + c] += pixels[3 * (v * full[0] + u) + c] / count;
        }
      }
    }
  }
  return out;
}
