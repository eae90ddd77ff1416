"""Programs that host widgets without cells, and name something else as the shell of IPython."""

from __future__ import annotations

import subprocess
import sys

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.versions]

STAND_INS = {
    # Like Solara's, which makes a new one for each call.
    "of Solara": """
class StandIn:
    def __init__(self):
        self.context = self.display_pub = SimpleNamespace()
        self.kernel = SimpleNamespace(shell=SimpleNamespace())
        self.events = mock.MagicMock()
    def enable_gui(self, gui): pass
    def register_post_execute(self, callback): pass
    def set_parent(self, *args): pass
    def showtraceback(self): pass
    def magic(self, *args): pass
    def set_custom_exc(self, exc_tuple, handler): pass
""",
    "with nothing at all": """
class StandIn:
    __slots__ = ()
""",
    "with cells but no tracebacks": """
class StandIn(InteractiveShell):
    def __init__(self):
        self.events = mock.MagicMock()
        self.get_parent = dict
""",
}
USE = """
import threading
from types import SimpleNamespace
from unittest import mock
import IPython
from IPython.core.interactiveshell import InteractiveShell
{stand_in}
IPython.get_ipython = StandIn
import ipywidgets.widgets.widget
ipywidgets.widgets.widget.get_ipython = lambda: None

def use():
    import robowidgets
    from robowidgets import feeds
    from robowidgets.behaviors import Drive
    laser = robowidgets.LaserWidget()
    laser.update(ranges=[1.0, 2.0], angle_min=0.0, angle_increment=0.1, range_min=0.1, range_max=9.0)
    robowidgets.SpeedWidget(), robowidgets.TouchWidget(), robowidgets.PathWidget(), robowidgets.DriveWidget()
    recording = robowidgets.open(robowidgets.SAMPLE)
    recording.show()
    assert recording.at("/scan", 1.0).sample.distance() > 0
    with feeds.simulator(wander=False) as feed:
        feed.show()
        feed.drive(0.1)
        went = threading.Event()
        @feed.program(rate=50)
        def go():
            went.set()
            return Drive(0.1)
        assert went.wait(120)
        feed.stop()
    done.append(True)

done = []
use()
thread = threading.Thread(target=use)  # Solara calls its components in threads
thread.start()
thread.join()
assert done == [True, True]
"""


@pytest.mark.parametrize("name", STAND_INS)
def test_where_something_stands_in_for_the_shell_the_package_is_imported_shows_and_drives(name: str) -> None:
    program = USE.format(stand_in=STAND_INS[name])
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (ended.returncode, "Error" in ended.stderr) == (0, False), ended.stderr
