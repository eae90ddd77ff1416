"""A program that computes without a pause leaves the widgets' threads time to run."""

from __future__ import annotations

import subprocess
import sys

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.versions]

STARVING = """
import os, sys, threading, time
from robowidgets.widget.pacer import Pacer

class Sender:
    sent = 0
    def send_newest(self):
        self.sent += 1
        return 0

{before}
sender, pacer = Sender(), Pacer()
pacer.mark(sender)

def feed():
    while True:
        time.sleep(0.025)
        pacer.mark(sender)

threading.Thread(target=feed, daemon=True).start()
end = time.process_time() + {seconds}  # of computing, however little of it a busy machine grants
while time.process_time() < end:
    os.path.exists("/no/such/file")
    sum(range({work}))
print(sender.sent, sys.getswitchinterval())
"""


def run(before: str = "", work: int = 100_000, seconds: float = 1.0) -> tuple[int, float]:
    program = STARVING.format(before=before, work=work, seconds=seconds)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    sent, interval = done.stdout.split()
    return int(sent), float(interval)


@pytest.mark.parametrize("work", [30_000, 200_000])
def test_a_loop_that_reads_a_file_each_millisecond_does_not_starve_sending(work: int) -> None:
    sent, _ = run(work=work)
    assert sent > 10, "of 40"


def test_a_switch_interval_that_the_program_has_set_stays() -> None:
    _, interval = run(before="sys.setswitchinterval(0.002)", work=10, seconds=0.1)
    assert interval == 0.002
