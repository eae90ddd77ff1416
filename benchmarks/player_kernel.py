"""The code in the notebook's kernel while a recording is played: the player, and a widget that only answers."""

from __future__ import annotations

import anywidget
from IPython.display import display

import robowidgets

HZ = 40.0

_ESM = """
export default {
  render({ model }) {
    window.roundTrip = () =>
      new Promise((resolve) => {
        const began = performance.now();
        const onAnswer = async () => {
          model.off("msg:custom", onAnswer);
          const answered = performance.now() - began;
          await window.bench.frame();
          resolve([answered, performance.now() - began]);
        };
        model.on("msg:custom", onAnswer);
        model.send({});
      });
  },
};
"""


class Echo(anywidget.AnyWidget):
    """A widget that answers each message of the page with one message."""

    _esm = _ESM


class Source:
    """A recording on show.

    Args:
        name: the name of the MCAP file in the folder of the notebook.
        count: the number of its scans, `HZ` per second.
    """

    def __init__(self, name: str, count: int) -> None:
        self._count = count
        self._recording = robowidgets.open(f"{name}.mcap")
        self._echo = Echo()
        self._echo.on_msg(lambda echo, _content, _buffers: echo.send({}))

    def show(self) -> None:
        """Display the player with the whole drive above it, and the widget that answers."""
        self.player = self._recording.show(scanogram=True)
        self.player.speed = 10.0
        display(self._echo, self.player)  # type: ignore[no-untyped-call]

    def to_scan(self, number: int) -> None:
        """Show the scan of a number; a negative number counts from the end."""
        self.player.time = (number % self._count) / HZ

    def lacking(self) -> list[int]:
        """Return the seconds of the recording that the page does not have."""
        sender = self.player._prefetcher
        assert sender is not None
        return [second for second in range(int(self._count / HZ)) if second not in sender._sent]


def peak() -> float:
    """Return the peak memory of this process in megabytes."""
    with open("/proc/self/status") as lines:
        return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:")) * 1024 / 1e6
