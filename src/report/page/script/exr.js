// Reads OpenEXR files: one part, scan lines, without compression or with RLE, ZIPS or ZIP; 16-bit and 32-bit floats.
//
// After the magic number and the version come attributes, a table of offsets, and blocks of 1 or 16 lines. A compressed block holds
// the even bytes, then the odd ones, each as the difference from the byte before, plus 128.
//
// Reference: openexr.com, "OpenEXR File Layout".

import { halfFloats, inflate } from '#page/decode.js';

/** @typedef {{width: number, height: number, channels: Map<string, Float32Array>}} Exr */

const COMPRESSIONS = ['none', 'RLE', 'ZIPS', 'ZIP', 'PIZ', 'PXR24', 'B44', 'B44A', 'DWAA', 'DWAB'];
/** Lines of a block, by compression. */
const LINES = [1, 1, 1, 16];

/**
 * @param {ArrayBuffer} buffer
 * @returns {Promise<Exr>}
 */
export async function readExr(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < 8 || view.getUint32(0, true) !== 20000630) throw new Error('this is no OpenEXR file');
  const flags = view.getUint32(4, true);
  if (flags & 0x1a00) throw new Error('only scan lines in one part can be read, no tiles, no deep data, no several parts');
  const { attributes, end } = header(view);
  const [x0, y0, x1, y1] = [0, 4, 8, 12].map((at) => need(attributes, 'dataWindow').getInt32(at, true));
  const [width, height] = [x1 - x0 + 1, y1 - y0 + 1];
  const compression = need(attributes, 'compression').getUint8(0);
  const lines = LINES[compression];
  if (!lines) throw new Error(`compression ${COMPRESSIONS[compression] ?? compression} cannot be read; save it without compression or with ZIP`);
  const channels = channelList(need(attributes, 'channels'));
  if (!(width > 0 && height > 0 && width * height * channels.length < 2 ** 29)) throw new Error('its size is not valid');
  /** @type {Map<string, Float32Array>} */
  const out = new Map(channels.map(({ name }) => [name, new Float32Array(width * height)]));
  const line = channels.reduce((a, c) => a + c.bytes * width, 0);
  for (let block = 0; block < Math.ceil(height / lines); block += 1) {
    const at = Number(view.getBigUint64(end + 8 * block, true));
    const y = view.getInt32(at, true) - y0;
    const size = view.getInt32(at + 4, true);
    const count = Math.min(lines, height - y);
    const raw = await unpacked(new Uint8Array(buffer, at + 8, size), compression, line * count);
    let from = 0;
    for (let row = y; row < y + count; row += 1) {
      for (const channel of channels) {
        copy(raw, from, channel, /** @type {Float32Array} */ (out.get(channel.name)), row * width, width);
        from += channel.bytes * width;
      }
    }
  }
  return { width, height, channels: out };
}

/** @param {Map<string, DataView>} attributes @param {string} name */
function need(attributes, name) {
  const found = attributes.get(name);
  if (!found) throw new Error(`its header lacks ${name}`);
  return found;
}

/** The attributes by name. @param {DataView} view */
function header(view) {
  /** @type {Map<string, DataView>} */
  const attributes = new Map();
  let at = 8;
  while (view.getUint8(at) !== 0) {
    const name = text(view, at);
    at += name.length + 1;
    at += text(view, at).length + 1;
    const size = view.getInt32(at, true);
    attributes.set(name, new DataView(view.buffer, view.byteOffset + at + 4, size));
    at += 4 + size;
  }
  return { attributes, end: at + 1 };
}

/** A text that ends with a zero byte. @param {DataView} view @param {number} at */
function text(view, at) {
  let out = '';
  for (let i = at; view.getUint8(i) !== 0; i += 1) out += String.fromCharCode(view.getUint8(i));
  return out;
}

/** @typedef {{name: string, type: number, bytes: number}} Channel */

/** @param {DataView} view @returns {Channel[]} */
function channelList(view) {
  const channels = [];
  for (let at = 0; view.getUint8(at) !== 0; ) {
    const name = text(view, at);
    at += name.length + 1;
    const type = view.getInt32(at, true);
    if (view.getInt32(at + 8, true) !== 1 || view.getInt32(at + 12, true) !== 1) throw new Error('subsampled channels cannot be read');
    channels.push({ name, type, bytes: type === 1 ? 2 : 4 });
    at += 16;
  }
  return channels;
}

/** @param {Uint8Array} raw @param {number} from @param {Channel} channel @param {Float32Array} to @param {number} start @param {number} count */
function copy(raw, from, { type, bytes }, to, start, count) {
  const view = new DataView(raw.buffer, raw.byteOffset + from, bytes * count);
  const halves = halfFloats();
  for (let i = 0; i < count; i += 1) {
    to[start + i] = type === 1 ? halves[view.getUint16(2 * i, true)] : type === 2 ? view.getFloat32(4 * i, true) : view.getUint32(4 * i, true);
  }
}

/** The bytes of a block. @param {Uint8Array<ArrayBuffer>} packed @param {number} compression @param {number} size */
async function unpacked(packed, compression, size) {
  // a block that would grow is stored as it is
  if (compression === 0 || packed.length === size) return packed;
  const mixed = compression === 1 ? runs(packed, size) : await inflate(packed);
  if (mixed.length !== size) throw new Error('a block has the wrong length');
  for (let i = 1; i < size; i += 1) mixed[i] = mixed[i - 1] + mixed[i] - 128;
  const [out, half] = [new Uint8Array(size), Math.ceil(size / 2)];
  for (let i = 0; i < size; i += 1) out[i] = mixed[i % 2 ? half + (i >> 1) : i >> 1];
  return out;
}

/** Run lengths: a negative count copies bytes, any other repeats one byte. @param {Uint8Array} packed @param {number} size */
function runs(packed, size) {
  const out = new Uint8Array(size);
  for (let i = 0, o = 0; i < packed.length && o < size; ) {
    const count = (packed[i] << 24) >> 24;
    if (count < 0) {
      out.set(packed.subarray(i + 1, i + 1 - count), o);
      [i, o] = [i + 1 - count, o - count];
    } else {
      out.fill(packed[i + 1], o, o + count + 1);
      [i, o] = [i + 2, o + count + 1];
    }
  }
  return out;
}
