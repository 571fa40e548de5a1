"""Prints the ticks per second from Python (``pytest -s``), and tests that a call for many ticks lets other threads run.

The floors are far below the speed of an idle computer, because tests run beside other programs. ``python -m touchstone.speed`` measures.
"""

import sys
import threading
import time

import numpy
import touchstone
from touchstone import speed


def test_ticks_per_second_are_printed_and_above_a_floor():
    print()
    for name, batch, single in speed.speeds(50_000):
        print(f"{name:<40}{batch / 1e6:>8.2f} million/s in one call, {single / 1e6:>6.2f} million/s one by one")
        assert batch > 200_000, name
        assert single > 50_000, name


def _rounds_beside(call):
    """How often this thread runs while another one is inside ``call``."""
    begun, ended = threading.Event(), threading.Event()

    def compute():
        begun.set()
        call()
        ended.set()

    before = sys.getswitchinterval()
    # Python then takes the lock (GIL) from no thread: this thread runs during the call only if the call gives the lock away.
    sys.setswitchinterval(1000.0)
    try:
        thread = threading.Thread(target=compute)
        thread.start()
        begun.wait()
        rounds = 0
        while not ended.is_set():
            rounds += 1
            time.sleep(0.001)
        thread.join()
        return rounds
    finally:
        sys.setswitchinterval(before)


def test_other_threads_run_during_a_call_for_many_ticks():
    places = 0.005 * numpy.sin(numpy.arange(2_000_000) * 0.06)
    moved, wanted = numpy.diff(places, prepend=0.0), 40.0 * places
    wall = touchstone.Wall()
    guard = touchstone.Guard(rate_hz=1000, force_limit_n_m=0.5, count_rad=1.6e-4, damping_n_m_s_per_rad=4e-4, delay_s=0.0)
    assert _rounds_beside(lambda: sum(range(2_000_000))) == 0, "a call that keeps the lock"
    assert _rounds_beside(lambda: wall.ticks(places)) > 0
    assert _rounds_beside(lambda: guard.ticks(moved, wanted)) > 0
