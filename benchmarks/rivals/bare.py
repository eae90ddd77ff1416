"""The limit: a widget that draws only dots, paced by time, always the newest scan."""

import threading
import time

import anywidget
import traitlets

NAME = "bare canvas"
INTERVAL = 1 / 60

ESM = """
export default {
  render({ model, el }) {
    const canvas = el.appendChild(document.createElement("canvas"));
    canvas.width = 760;
    canvas.height = 560;
    const context = canvas.getContext("2d");
    const angle = (i) => (-0.75 + (1.5 * i) / 1039) * Math.PI;
    let pending = false;
    const draw = () => {
      pending = false;
      const bytes = model.get("ranges");
      const count = bytes.byteLength / 4;
      context.clearRect(0, 0, 760, 560);
      context.fillStyle = "red";
      for (let i = 0; i < count; i++) {
        const range = bytes.getFloat32(4 * i, true) * 50;
        context.fillRect(379 - range * Math.sin(angle(i)), 309 - range * Math.cos(angle(i)), 3, 3);
      }
    };
    model.on("change:ranges", () => {
      if (!pending) pending = requestAnimationFrame(draw);
    });
    draw();
  },
};
"""


class Bare(anywidget.AnyWidget):
    _esm = ESM
    ranges = traitlets.Bytes().tag(sync=True)

    def __init__(self, ranges):
        super().__init__(ranges=ranges.tobytes())
        self._newest = ranges
        self._wake = threading.Event()
        threading.Thread(target=self._flush, daemon=True).start()

    def update(self, ranges):
        self._newest = ranges
        self._wake.set()

    def _flush(self):
        while True:
            self._wake.wait()
            self._wake.clear()
            self.ranges = self._newest.tobytes()
            time.sleep(INTERVAL)


def make(ranges):
    bare = Bare(ranges)
    return bare, bare.update
