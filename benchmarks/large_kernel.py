"""The code in the notebook's kernel that updates a picture or a cloud together with a laser."""

from __future__ import annotations

import json
import threading
import time
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
from IPython.display import display
from numpy.typing import NDArray

from robowidgets import CloudWidget, ImageWidget
from robowidgets.runtime.platform_fixes import route_by_message

from . import kernel

RATES = {"color": 30.0, "photo": 30.0, "depth": 10.0, "cloud": 10.0}
POINTS, DRAWN_OF = 100_000, 4
DIFFERENT = 8
"""The number of different pictures."""

BARE = """
export default {
  render({ model, el }) {
    const canvas = document.createElement("canvas");
    canvas.width = 640;
    canvas.height = 480;
    el.append(canvas);
    const context = canvas.getContext("2d");
    const image = new ImageData(640, 480);
    const pixels = new Uint32Array(image.data.buffer);
    const drawPicture = (data, each) => {
      for (let i = 0, at = 0; i < pixels.length; i++, at += each) {
        pixels[i] = 0xff000000 | (data[at + each - 1] << 16) | (data[at + 1] << 8) | data[at];
      }
    };
    const drawPoints = (data) => {
      pixels.fill(0xff000000);
      const values = new Float32Array(data.slice().buffer);
      for (let i = 0; i < values.length; i += 4) {
        const at = 640 * Math.round(240 - 20 * values[i]) + Math.round(320 - 20 * values[i + 1]);
        for (const pixel of [at, at + 1, at + 640, at + 641]) pixels[pixel] = 0xff00ff00;
      }
    };
    model.on("msg:custom", ({ number, each }, [bytes]) => {
      requestAnimationFrame(() => {
        const data = new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength);
        if (each) drawPicture(data, each);
        else drawPoints(data);
        context.putImageData(image, 0, 0);
        model.send({ drawn: number });
      });
    });
  },
};
"""


class Bare(anywidget.AnyWidget):
    """A bare canvas for the same bytes. The next picture is sent once the last one is drawn."""

    _esm = BARE

    def __init__(self, kind: str, on_drawn: Any) -> None:
        super().__init__()
        self._each = {"color": 3, "depth": 2, "cloud": 0}[kind]
        self._lock, self._is_free, self._newest, self._sent = threading.Lock(), True, (0, b""), 0
        self._on_drawn = on_drawn
        self.on_msg(self._on_page)
        route_by_message(self.comm)

    def update(self, number: int, pixels: NDArray[Any]) -> None:
        """Send a picture, or keep it until the previous one is drawn."""
        with self._lock:
            self._newest = number, (pixels if self._each else pixels[::DRAWN_OF]).tobytes()
            is_free, self._is_free = self._is_free, False
        if is_free:
            self._send_newest()

    def _send_newest(self) -> None:
        self._sent, data = self._newest
        self.send({"number": self._sent, "each": self._each}, [data])

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        self._on_drawn(content["drawn"])
        with self._lock:
            has_newer = self._newest[0] > self._sent
            self._is_free = not has_newer
        if has_newer:
            self._send_newest()


class Source(kernel.Source):
    """A laser with a large view or alone: ``color-ours``, ``cloud-bare``, ``alone``."""

    def __init__(self, name: str, _count: int) -> None:
        super().__init__("laser", 1)
        self._kind, _, self._whose = name.partition("-")
        self._times: list[float] = []
        self._drawn: dict[int, tuple[int, float]] = {}
        """By the number of a drawn picture: the number of the newest picture at that time, and the time."""
        self._span = 0.0, 0.0
        self._ends = threading.Event()
        noise = np.random.default_rng(1)
        self._some = [self._one(noise) for _ in range(DIFFERENT)] if self._whose else []
        self._large: Any = None
        if self._whose == "bare":
            self._large = Bare(self._kind, self._note)
        elif self._whose:
            self._large = self._made()
            credit = self._large._credit
            heard = credit.on_drawn

            def on_drawn(page: str, number: float, lacks: float | None = None) -> bool:
                self._note(int(number))
                return bool(heard(page, number, lacks))

            credit.on_drawn = on_drawn

    def _made(self) -> ImageWidget | CloudWidget:
        if self._kind != "cloud":
            return ImageWidget(title="/camera")
        return CloudWidget(title="/points", most_points=POINTS if self._whose == "all" else None)

    def show(self) -> None:
        """See `kernel.Source`."""
        super().show()
        if self._large is not None:
            display(self._large)  # type: ignore[no-untyped-call]

    def pace(self, hz: float, seconds: float, settling: float = 0.0) -> None:
        """See `kernel.Source`. The first seconds of the large view do not count."""
        if self._large is not None:
            threading.Thread(target=self._pace_large, daemon=True).start()
        begin = time.perf_counter()
        super().pace(hz, seconds)
        self._span = begin + settling, time.perf_counter()
        self._ends.set()

    def told(self) -> None:
        """Save the milliseconds from `update` to the report of drawing, the pictures per second, and their ages."""
        begin, end = self._span
        counts = {number: (newest, at) for number, (newest, at) in self._drawn.items() if begin <= at <= end}
        # Without a large view, the figures are NaN.
        late = [1000 * (at - self._times[number - 1]) for number, (_, at) in counts.items()] or [float("nan")]
        behind = [newest - number for number, (newest, _) in counts.items()] or [float("nan")]
        found = {
            "late": float(np.median(late)),
            "late_p95": float(np.percentile(late, 95)),
            "per_second": len(counts) / (end - begin),
            "behind": float(np.median(behind)),
            "behind_most": float(max(behind)),
        }
        Path("large.json").write_text(json.dumps(found))

    def _note(self, number: int) -> None:
        if number:
            self._drawn.setdefault(number, (len(self._times), time.perf_counter()))

    def _pace_large(self) -> None:
        some, due = self._some, time.perf_counter()
        while not self._ends.is_set():
            one = some[len(self._times) % len(some)]
            self._times.append(time.perf_counter())
            if self._whose == "bare":
                self._large.update(len(self._times), one)
            else:
                self._large.update(one)
            due += 1 / RATES[self._kind]
            time.sleep(max(0.0, due - time.perf_counter()))

    def _one(self, noise: np.random.Generator) -> NDArray[Any]:
        if self._kind == "color":
            return noise.integers(1, 250, (480, 640, 3), np.uint8)
        if self._kind == "photo":
            rows, columns = np.mgrid[:480, :640]
            smooth = np.dstack([40 + columns // 4, 60 + rows // 4, 90 + (columns // 40 + rows // 40) % 2 * 60])
            return (smooth + noise.normal(0, 4, smooth.shape)).clip(0, 255).astype(np.uint8)
        if self._kind == "depth":
            return noise.integers(1, 250, (480, 640)).astype(np.uint16)
        cloud = np.empty(POINTS, [(field, np.float32) for field in ("x", "y", "z", "intensity")])
        for field in cloud.dtype.names or ():
            cloud[field] = noise.uniform(-10, 10, POINTS)
        return cloud
