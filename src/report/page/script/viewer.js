// The large canvas: an image at any zoom, a second one beside a movable edge, and what lies on it: values of pixels, the chosen
// pixel, the chosen block.
//
//   place on the canvas = (pixel − centre) · zoom + middle of the canvas
//
// Zoom and centre stay when the image changes, so that two images can be compared by switching.

import { significant } from '#page/format.js';
import { TILES } from '#page/run.js';

/** @typedef {{zoom: number, x: number, y: number}} Frame zoom in CSS pixels per pixel, and the pixel in the middle */
/** @typedef {{click: (x: number, y: number) => void, block: (tiles: [number, number, number, number]) => void, frame: (f: Frame) => void, wipe: (at: number) => void, over: (pixel: [number, number] | null) => void}} Asked */

/** From this zoom on the values are written on the pixels. */
const WITH_VALUES = 56;
const LARGEST = 160;

export class Viewer {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {number} width @param {number} height size of the images
   * @param {Asked} asked what the reader does with the pointer
   */
  constructor(canvas, width, height, asked) {
    this.canvas = canvas;
    this.width = width;
    this.height = height;
    this.asked = asked;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    this.images = [0, 1].map(() => {
      const own = new OffscreenCanvas(width, height);
      const context = /** @type {OffscreenCanvasRenderingContext2D} */ (own.getContext('2d'));
      return { canvas: own, context, data: context.createImageData(width, height) };
    });
    /** @type {Frame | null} */
    this.frame = null;
    /** @type {{pixels: Float32Array | null, wipe: number | null, pixel: [number, number] | null, tiles: [number, number, number, number] | null}} */
    this.over = { pixels: null, wipe: null, pixel: null, tiles: null };
    /** True while the next drag chooses a block. */
    this.choosing = false;
    this.#listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** The colours of an image: 0 the shown one, 1 the one behind the edge. @param {number} which */
  colours(which) {
    return this.images[which].data.data;
  }

  /** Takes over the colours that were written. @param {number} which */
  changed(which) {
    const { context, data } = this.images[which];
    context.putImageData(data, 0, 0);
  }

  /** The frame that shows the whole image. @returns {Frame} */
  whole() {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    return { zoom: Math.max(Math.min(w / this.width, h / this.height), 1e-3), x: this.width / 2, y: this.height / 2 };
  }

  /** @returns {Frame} */
  now() {
    return this.frame ?? this.whole();
  }

  /** The pixel under a place on the canvas. @param {number} left @param {number} top @returns {[number, number]} */
  pixelAt(left, top) {
    const { zoom, x, y } = this.now();
    const { clientWidth: w, clientHeight: h } = this.canvas;
    return [x + (left - w / 2) / zoom, y + (top - h / 2) / zoom];
  }

  /** Changes the zoom so that the pixel under a place stays there. @param {number} factor @param {number} [left] @param {number} [top] */
  zoomBy(factor, left = this.canvas.clientWidth / 2, top = this.canvas.clientHeight / 2) {
    const [px, py] = this.pixelAt(left, top);
    const zoom = Math.min(Math.max(this.now().zoom * factor, Math.min(this.whole().zoom, 1)), LARGEST);
    const { clientWidth: w, clientHeight: h } = this.canvas;
    this.asked.frame({ zoom, x: px - (left - w / 2) / zoom, y: py - (top - h / 2) / zoom });
  }

  draw() {
    const { canvas, context } = this;
    const density = window.devicePixelRatio || 1;
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(w * density) || canvas.height !== Math.round(h * density)) {
      [canvas.width, canvas.height] = [Math.round(w * density), Math.round(h * density)];
    }
    context.setTransform(density, 0, 0, density, 0, 0);
    context.clearRect(0, 0, w, h);
    const { zoom, x, y } = this.now();
    const [left, top] = [w / 2 - x * zoom, h / 2 - y * zoom];
    // a picture smaller than its pixels is averaged, a larger one shows its pixels as squares
    context.imageSmoothingEnabled = zoom * density < 1;
    context.drawImage(this.images[0].canvas, left, top, this.width * zoom, this.height * zoom);
    const { wipe } = this.over;
    if (wipe !== null) {
      context.save();
      context.beginPath();
      context.rect(wipe * w, 0, w, h);
      context.clip();
      context.clearRect(0, 0, w, h);
      context.drawImage(this.images[1].canvas, left, top, this.width * zoom, this.height * zoom);
      context.restore();
      this.#line([wipe * w, 0, wipe * w, h]);
    }
    if (zoom >= WITH_VALUES) this.#values(left, top, zoom, wipe === null ? w : wipe * w);
    this.#marks(left, top, zoom);
  }

  /** @param {[number, number, number, number]} ends */
  #line([x0, y0, x1, y1]) {
    for (const [colour, width] of /** @type {[string, number][]} */ ([['#000', 4], ['#fff', 1.6]])) {
      this.context.strokeStyle = colour;
      this.context.lineWidth = width;
      this.context.beginPath();
      this.context.moveTo(x0, y0);
      this.context.lineTo(x1, y1);
      this.context.stroke();
    }
  }

  /** Red, green and blue on each visible pixel. @param {number} left @param {number} top @param {number} zoom @param {number} right */
  #values(left, top, zoom, right) {
    const { pixels } = this.over;
    if (!pixels) return;
    const { context, canvas } = this;
    const [x0, y0] = this.pixelAt(0, 0).map((v) => Math.max(0, Math.floor(v)));
    const [x1, y1] = this.pixelAt(right, canvas.clientHeight);
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    for (let y = y0; y < Math.min(y1, this.height); y += 1) {
      for (let x = x0; x < Math.min(x1, this.width); x += 1) {
        const i = 3 * (y * this.width + x);
        const rgb = this.colours(0).subarray((4 * i) / 3, (4 * i) / 3 + 3);
        context.fillStyle = rgb[0] + 2 * rgb[1] + rgb[2] > 500 ? '#000' : '#fff';
        for (let c = 0; c < 3; c += 1) {
          context.fillText(significant(pixels[i + c], 3), left + (x + 0.5) * zoom, top + (y + 0.5) * zoom + 14 * (c - 1) + 4);
        }
      }
    }
  }

  /** @param {number} left @param {number} top @param {number} zoom */
  #marks(left, top, zoom) {
    const { context, over } = this;
    const frame = (/** @type {number[]} */ [x0, y0, x1, y1]) => {
      for (const [colour, width] of /** @type {[string, number][]} */ ([['#000', 4], ['#ffd34d', 2]])) {
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.strokeRect(left + x0 * zoom - 1, top + y0 * zoom - 1, (x1 - x0) * zoom + 2, (y1 - y0) * zoom + 2);
      }
    };
    if (over.tiles) {
      const scale = [this.width / TILES, this.height / TILES];
      frame(over.tiles.map((t, i) => t * scale[i % 2]));
    }
    if (over.pixel) {
      const [x, y] = over.pixel;
      // a frame of at least 9 CSS pixels
      const air = Math.max(0, (9 / zoom - 1) / 2);
      frame([x - air, y - air, x + 1 + air, y + 1 + air]);
    }
  }

  /** Pointers: a click chooses a pixel, a drag moves the image or the edge, two fingers zoom, Shift and a drag choose a block. */
  #listen() {
    const { canvas } = this;
    /** @type {Map<number, [number, number]>} */
    const down = new Map();
    /** @type {{kind: 'move' | 'block' | 'wipe', from: [number, number], frame: Frame, moved: boolean} | null} */
    let drag = null;
    const place = (/** @type {PointerEvent | WheelEvent} */ e) => /** @type {[number, number]} */ ([e.offsetX, e.offsetY]);
    canvas.addEventListener('pointerdown', (e) => {
      canvas.setPointerCapture(e.pointerId);
      down.set(e.pointerId, place(e));
      const { wipe } = this.over;
      const near = wipe !== null && Math.abs(e.offsetX - wipe * canvas.clientWidth) < 14;
      const kind = near ? 'wipe' : e.shiftKey || this.choosing ? 'block' : 'move';
      drag = { kind, from: place(e), frame: this.now(), moved: false };
    });
    const inside = (/** @type {number[]} */ [x, y]) => x >= 0 && y >= 0 && x < this.width && y < this.height;
    canvas.addEventListener('pointerleave', () => this.asked.over(null));
    canvas.addEventListener('pointermove', (e) => {
      const [u, v] = this.pixelAt(e.offsetX, e.offsetY).map(Math.floor);
      this.asked.over(inside([u, v]) ? [u, v] : null);
      if (!drag || !down.has(e.pointerId)) return;
      const before = /** @type {[number, number]} */ (down.get(e.pointerId));
      const other = [...down].find(([id]) => id !== e.pointerId)?.[1];
      down.set(e.pointerId, place(e));
      const [dx, dy] = [e.offsetX - drag.from[0], e.offsetY - drag.from[1]];
      if (Math.hypot(dx, dy) > 4) drag.moved = true;
      if (other) {
        const apart = (/** @type {[number, number]} */ p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
        this.zoomBy(apart(place(e)) / Math.max(apart(before), 1), (e.offsetX + other[0]) / 2, (e.offsetY + other[1]) / 2);
        [drag.from, drag.frame, drag.moved] = [place(e), this.now(), true];
      } else if (drag.kind === 'wipe') {
        this.asked.wipe(Math.min(Math.max(e.offsetX / canvas.clientWidth, 0), 1));
      } else if (drag.kind === 'block' && drag.moved) {
        this.asked.block(this.#tiles(drag.from, place(e)));
      } else if (drag.moved) {
        const { zoom, x, y } = drag.frame;
        this.asked.frame({ zoom, x: x - dx / zoom, y: y - dy / zoom });
      }
    });
    const up = (/** @type {PointerEvent} */ e) => {
      const click = drag && !drag.moved && down.size === 1 && e.type === 'pointerup' && drag.kind !== 'wipe';
      down.delete(e.pointerId);
      if (click) {
        const [x, y] = this.pixelAt(e.offsetX, e.offsetY).map(Math.floor);
        if (inside([x, y])) this.asked.click(x, y);
      }
      if (down.size === 0) drag = null;
    };
    canvas.addEventListener('pointerup', up);
    canvas.addEventListener('pointercancel', up);
    canvas.addEventListener(
      'wheel',
      (e) => {
        // the whole image is seen: the page scrolls
        if (e.deltaY > 0 && this.now().zoom <= this.whole().zoom * 1.001) return;
        e.preventDefault();
        this.zoomBy(2 ** (-e.deltaY / 240), e.offsetX, e.offsetY);
      },
      { passive: false },
    );
  }

  /** The tiles that a drag touches. @param {[number, number]} from @param {[number, number]} to @returns {[number, number, number, number]} */
  #tiles(from, to) {
    const [a, b] = [this.pixelAt(...from), this.pixelAt(...to)];
    const tile = (/** @type {number} */ v, /** @type {number} */ size) => Math.floor((v * TILES) / size);
    const inside = (/** @type {number} */ t) => Math.min(Math.max(t, 0), TILES - 1);
    const [x0, x1] = [a[0], b[0]].map((v) => inside(tile(v, this.width))).sort((p, q) => p - q);
    const [y0, y1] = [a[1], b[1]].map((v) => inside(tile(v, this.height))).sort((p, q) => p - q);
    return [x0, y0, x1 + 1, y1 + 1];
  }
}
