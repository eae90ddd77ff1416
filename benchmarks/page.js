// Reads back, after every animation frame, the number that the picture shows (see scan.py), and counts what comes over
// the wire. The same for every library: where the dots of a bit lie is learned from scans that differ in that bit alone.
window.bench = (() => {
  const BITS = 24;
  const RAYS_PER_BIT = 43;

  // The machine's clock, by which the kernel says when it handed a scan over, finer than Date.now() tells it.
  let origin = 0;
  const now = () => origin + performance.now();
  function setClock() {
    const tick = Date.now();
    let next = tick;
    while (next === tick) next = Date.now();
    origin = next - performance.now();
  }
  setClock();

  const messages = [];
  window.WebSocket = class extends WebSocket {
    constructor(...parts) {
      super(...parts);
      this.addEventListener("message", ({ data }) => {
        messages.push([now(), data.byteLength ?? data.size ?? data.length]);
      });
    }
  };

  // WebGL forgets its picture once it is on the screen, unless it is told not to.
  const getContext = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    const kept = kind.startsWith("webgl") ? { ...options, preserveDrawingBuffer: true } : options;
    return getContext.call(this, kind, kept);
  };

  // Resolves when a frame has been drawn: after its animation callbacks, styles and layout.
  const channel = new MessageChannel();
  const waiting = [];
  channel.port2.onmessage = () => {
    for (const resolve of waiting.splice(0)) resolve();
  };
  const frame = () =>
    new Promise((resolve) => {
      requestAnimationFrame(() => {
        waiting.push(resolve);
        channel.port1.postMessage(null);
      });
    });

  const scratch = document.createElement("canvas").getContext("2d", { willReadFrequently: true });

  const isRed = (pixels, at) =>
    pixels[at] > 150 && pixels[at + 1] < 110 && pixels[at + 2] < 110 && pixels[at + 3] > 150;

  // Copies a canvas to where it can be read: one copy per frame, because of WebGL each waits for the whole picture.
  function copy(canvas) {
    const { width, height } = canvas;
    if (scratch.canvas.width < width) scratch.canvas.width = width;
    if (scratch.canvas.height < height) scratch.canvas.height = height;
    scratch.clearRect(0, 0, width, height);
    scratch.drawImage(canvas, 0, 0);
  }

  function redOf(canvas) {
    const { width, height } = canvas;
    const mask = new Uint8Array(width * height);
    if (!mask.length) return { width, mask };
    copy(canvas);
    const { data } = scratch.getImageData(0, 0, width, height);
    for (let i = 0; i < mask.length; i++) mask[i] = isRed(data, 4 * i);
    return { width, mask };
  }

  // A view whose dots are pixels of canvases.
  class Pixels {
    #root;
    #probes = [];

    constructor(root) {
      this.#root = root;
    }

    get #canvases() {
      return [...this.#root.querySelectorAll("canvas")];
    }

    snapshot() {
      return this.#canvases.map(redOf);
    }

    isPainted() {
      return this.snapshot().some(({ mask }) => mask.includes(1));
    }

    same(a, b) {
      return a.length === b.length && a.every(({ mask }, i) => mask.every((red, at) => red === b[i].mask[at]));
    }

    // Where the dots of a bit are when it is 0, and where when it is 1.
    learn(bit, zero, one) {
      this.#probes[2 * bit] = middleOf(zero, one);
      this.#probes[2 * bit + 1] = middleOf(one, zero);
    }

    read() {
      const lit = [];
      for (const [index, canvas] of this.#canvases.entries()) {
        if (!this.#probes.some((probe) => probe.canvas === index)) continue;
        copy(canvas);
        for (const [i, probe] of this.#probes.entries()) {
          if (probe.canvas === index) lit[i] = isRed(scratch.getImageData(probe.x, probe.y, 1, 1).data, 0);
        }
      }
      return (i) => lit[i];
    }
  }

  // The middle of the pixels that are red in one picture and not in the other, as near as one has such neighbours only.
  function middleOf(here, there) {
    const found = [];
    for (const [canvas, { mask, width }] of here.entries()) {
      const counts = (at) => mask[at] === 1 && there[canvas].mask[at] === 0;
      for (let at = width + 1; at < mask.length - width - 1; at++) {
        if (counts(at) && [-width, width, -1, 1].every((step) => counts(at + step))) {
          found.push({ canvas, x: at % width, y: Math.floor(at / width) });
        }
      }
    }
    if (!found.length) throw new Error("no dot of this bit is to be seen");
    // The first canvas with dots: an index view shows them once more.
    const dots = found.filter(({ canvas }) => canvas === found[0].canvas);
    const mean = (of) => dots.reduce((sum, pixel) => sum + of(pixel), 0) / dots.length;
    const [x, y] = [mean((pixel) => pixel.x), mean((pixel) => pixel.y)];
    const off = (pixel) => Math.hypot(pixel.x - x, pixel.y - y);
    return dots.reduce((best, pixel) => (off(pixel) < off(best) ? pixel : best));
  }

  // A view whose dots are elements, one per ray: the places of the middle ray of each bit.
  class Elements {
    #root;
    #selector;
    #probes = [];

    constructor(root, selector) {
      this.#root = root;
      this.#selector = selector;
    }

    snapshot() {
      const dots = this.#root.querySelectorAll(this.#selector);
      const middle = Math.floor(RAYS_PER_BIT / 2);
      return Array.from({ length: BITS }, (_, bit) => placeOf(dots[bit * RAYS_PER_BIT + middle]));
    }

    isPainted() {
      return this.snapshot().every(Boolean);
    }

    same(a, b) {
      return a.every((place, i) => distance(place, b[i]) === 0);
    }

    learn(bit, zero, one) {
      this.#probes[2 * bit] = zero[bit];
      this.#probes[2 * bit + 1] = one[bit];
    }

    read() {
      const places = this.snapshot();
      const off = (i) => distance(places[i >> 1], this.#probes[i]);
      return (i) => off(i) < off(i ^ 1);
    }
  }

  // Where an SVG element stands, by its `transform="translate(x, y)"`; null without one.
  function placeOf(element) {
    const numbers = element?.getAttribute("transform")?.match(/-?[\d.]+(?:e-?\d+)?/g);
    return numbers ? { x: Number(numbers[0]), y: Number(numbers[1]) } : null;
  }

  const distance = (a, b) => (a && b ? Math.hypot(a.x - b.x, a.y - b.y) : Infinity);

  // The number of a view; null when what it shows is none.
  function decode(isLit) {
    let number = 0;
    for (let bit = 0; bit < BITS; bit++) {
      if (isLit(2 * bit) === isLit(2 * bit + 1)) return null;
      if (isLit(2 * bit + 1)) number += 2 ** bit;
    }
    return number;
  }

  let views = [];
  let zero = [];
  let last = [];
  let unread = 0;
  let painted = [];

  async function follow() {
    const followed = views;
    while (followed === views) {
      await frame();
      for (const [i, view] of views.entries()) {
        const number = decode(view.read());
        if (number === null) unread++;
        else if (number !== last[i]) {
          last[i] = number;
          painted.push([now(), i, number]);
        }
      }
    }
  }

  return {
    frame,

    // Sets what is looked at: the elements of a selector, their dots in canvases or (with `svg`) in elements.
    look(selector, svg) {
      const roots = [...document.querySelectorAll(selector)];
      views = roots.map((root) => (svg ? new Elements(root, svg) : new Pixels(root)));
      return views.length;
    },

    // Milliseconds until dots are to be seen in an element that comes with `start`.
    async firstPaint(start, selector, svg) {
      const began = performance.now();
      start();
      do {
        await frame();
        if (performance.now() - began > 60_000) throw new Error("no dots within a minute");
      } while (!this.look(selector, svg) || !views.every((view) => view.isPainted()));
      return performance.now() - began;
    },

    // Learns how a bit looks from the scan that has just been sent; the first is the scan that says 0 (bit = null).
    async learn(bit) {
      const deadline = performance.now() + 20_000;
      const differs = (view, i, shown) => bit === null || !view.same(zero[i], shown[i]);
      let [before, still] = [null, 0];
      for (;;) {
        await frame();
        const shown = views.map((view) => view.snapshot());
        still = before && views.every((view, i) => view.same(before[i], shown[i])) ? still + 1 : 0;
        before = shown;
        if (still >= 3 && views.every((view, i) => differs(view, i, shown))) break;
        if (performance.now() > deadline) throw new Error(`bit ${bit} never came to be seen`);
      }
      if (bit === null) zero = before;
      else for (const [i, view] of views.entries()) view.learn(bit, zero[i], before[i]);
    },

    follow() {
      zero = [];
      follow();
    },

    // Reads every view once.
    read: () => views.map((view) => decode(view.read())),

    // Whether every view shows a number within some milliseconds.
    async comes(number, patience) {
      const deadline = performance.now() + patience;
      const isShown = () => last.every((seen) => seen === number);
      while (!isShown() && performance.now() < deadline) await new Promise((resume) => setTimeout(resume, 20));
      return isShown();
    },

    // What was painted (when, in which view, which number) and what came (when, bytes) since the last call.
    take() {
      const taken = { painted, messages: messages.splice(0), unread, clockOff: now() - Date.now() };
      painted = [];
      unread = 0;
      setClock();
      return taken;
    },
  };
})();
