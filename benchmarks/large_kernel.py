"""What runs in the notebook's kernel to measure a picture beside a laser: both updated, and when the page has drawn."""

from __future__ import annotations

import json
import threading
import time
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
from IPython.display import display

from robowidgets import ImageWidget
from robowidgets._core.platform_fixes import route_by_message

from . import kernel

RATES = {"color": 30.0, "depth": 10.0}

BARE = """
export default {
  render({ model, el }) {
    const canvas = document.createElement("canvas");
    canvas.width = 640;
    canvas.height = 480;
    el.append(canvas);
    const context = canvas.getContext("2d");
    model.on("msg:custom", ({ number, each }, [bytes]) => {
      requestAnimationFrame(() => {
        const data = new Uint8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength);
        const image = new ImageData(640, 480);
        const pixels = new Uint32Array(image.data.buffer);
        for (let i = 0, at = 0; i < pixels.length; i++, at += each) {
          pixels[i] = 0xff000000 | (data[at + each - 1] << 16) | (data[at + 1] << 8) | data[at];
        }
        context.putImageData(image, 0, 0);
        model.send({ drawn: number });
      });
    });
  },
};
"""


class Bare(anywidget.AnyWidget):
    """The same bytes on a canvas, and nothing else: the next ones go when the last ones are drawn."""

    _esm = BARE

    def __init__(self, on_drawn: Any) -> None:
        super().__init__()
        self._lock, self._is_free, self._newest, self._sent = threading.Lock(), True, (0, b"", 1), 0
        self._on_drawn = on_drawn
        self.on_msg(self._on_page)
        route_by_message(self.comm)

    def update(self, number: int, pixels: Any) -> None:
        """Send it, or keep it until the one before is drawn."""
        with self._lock:
            self._newest = number, pixels.tobytes(), pixels.nbytes // (640 * 480)
            is_free, self._is_free = self._is_free, False
        if is_free:
            self._send_newest()

    def _send_newest(self) -> None:
        self._sent, data, each = self._newest
        self.send({"number": self._sent, "each": each}, [data])

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        self._on_drawn(content["drawn"])
        with self._lock:
            has_newer = self._newest[0] > self._sent
            self._is_free = not has_newer
        if has_newer:
            self._send_newest()


class Source(kernel.Source):
    """A laser, and beside it a picture or nothing: ``color-ours``, ``depth-bare``, ``alone``."""

    def __init__(self, name: str, _count: int) -> None:
        super().__init__("laser", 1)
        self._kind, _, self._whose = name.partition("-")
        self._times: list[float] = []
        self._drawn: list[tuple[int, int, float]] = []
        self._ends = threading.Event()
        self._large: Any = None
        if self._whose == "bare":
            self._large = Bare(self._note)
        elif self._whose:
            self._large = ImageWidget(title="/camera")
            credit = self._large._credit
            heard = credit.on_drawn

            def on_drawn(page: str, number: float, lacks: float | None = None) -> bool:
                self._note(int(number))
                return bool(heard(page, number, lacks))

            credit.on_drawn = on_drawn

    def show(self) -> None:
        """See `kernel.Source`."""
        super().show()
        if self._large is not None:
            display(self._large)  # type: ignore[no-untyped-call]

    def beside(self) -> None:
        """Update it at its rate from now on."""
        if self._large is not None:
            threading.Thread(target=self._pace, daemon=True).start()

    def told(self) -> None:
        """Print what was drawn: milliseconds from `update` until that was heard, how many a second, and how old."""
        self._ends.set()
        late = [1000 * (at - self._times[number - 1]) for number, _, at in self._drawn if number]
        behind = [newest - number for number, newest, _ in self._drawn if number]
        span = self._drawn[-1][2] - self._drawn[0][2] if len(self._drawn) > 1 else 1.0
        found = {
            "late": float(np.median(late)) if late else None,
            "late_p95": float(np.percentile(late, 95)) if late else None,
            "per_second": len(late) / span,
            "behind": max(behind, default=0),
        }
        Path("large.json").write_text(json.dumps(found))

    def _note(self, number: int) -> None:
        self._drawn.append((number, len(self._times), time.perf_counter()))

    def _pace(self) -> None:
        noise = np.random.default_rng(1)
        shape, dtype = ((480, 640, 3), np.uint8) if self._kind == "color" else ((480, 640), np.uint16)
        some = [noise.integers(1, 250, shape).astype(dtype) for _ in range(8)]
        due = time.perf_counter()
        while not self._ends.is_set():
            pixels = some[len(self._times) % len(some)]
            self._times.append(time.perf_counter())
            if self._whose == "bare":
                self._large.update(len(self._times), pixels)
            else:
                self._large.update(pixels)
            due += 1 / RATES[self._kind]
            time.sleep(max(0.0, due - time.perf_counter()))
