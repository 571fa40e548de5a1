"""Tests ``Board`` with the simulated knob of ``touchstone demo``. Skipped if the program is missing."""

import json
import math
import subprocess

import pytest
import touchstone

try:
    touchstone.program()
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)


class Demo:
    """A running ``touchstone demo``; what is written to its standard input happens to the knob or its cable."""

    def __init__(self):
        words = [touchstone.program(), "--json", "demo", "--port-only", "--listen", "127.0.0.1:0"]
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        said = ""
        while not said.endswith("}\n"):
            said += self.process.stdout.readline()
        self.port = json.loads(said)["device"]

    def happens(self, what):
        self.process.stdin.write(what + "\n")
        self.process.stdin.flush()

    def end(self):
        self.process.kill()
        self.process.communicate()


@pytest.fixture
def demo():
    demo = Demo()
    yield demo
    demo.end()


@pytest.fixture
def board(demo):
    board = touchstone.Board(demo.port)
    board.calibrate()
    return board


def test_a_board_tells_what_it_is(demo):
    board = touchstone.Board(demo.port)
    assert board.info()["board"] == "nucleo-g474re"
    assert board.state == "boot"


def test_a_setting_is_read_back(demo):
    board = touchstone.Board(demo.port)
    board.set("wall.k_desired_n_m_per_rad", 3.5)
    assert board.get("wall.k_desired_n_m_per_rad") == 3.5
    board.set("wall.surface_rad", -0.25)
    assert board.settings("wall") == {"wall.surface_rad": -0.25, "wall.k_desired_n_m_per_rad": 3.5}
    assert len(board.settings()) > 50
    board.save()
    with pytest.raises(touchstone.Mistake, match="wall.k_desired_n_m_per_rad"):
        board.set("wall.k_desired_n_m_per_rad", -1)
    with pytest.raises(touchstone.Mistake, match="nosuch"):
        board.get("nosuch.field")


def test_with_switches_the_motor_off(board):
    with board:
        board.arm()
        assert board.state == "armed"
    assert board.state == "ready"


def test_an_error_in_the_block_switches_the_motor_off_and_is_told(board):
    with pytest.raises(ZeroDivisionError):
        with board:
            board.arm()
            1 / 0
    assert board.state == "ready"


def test_records_are_those_of_every_period(board):
    with board:
        board.arm()
        records = list(board.monitor(seconds=0.5))
    assert len(records) > 100
    ticks = [record["tick"] for record in records]
    assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
    assert {record["state"] for record in records} == {"armed"}
    assert all(math.isfinite(record["force_n_m"]) for record in records)
    assert records[-1]["time_s"] == pytest.approx((len(records) - 1) / 1000)


def test_a_loop_that_is_left_frees_the_port_and_the_motor_goes_off(board):
    with board:
        board.arm()
        for record in board.monitor(decimation=2):
            assert record["tick"] % 2 == 0
            break
        assert board.state == "armed"
        left = board.monitor()
        next(left)
    assert board.state == "ready"


def test_a_board_that_does_not_confirm_is_an_error(demo, board):
    with pytest.raises(touchstone.MayBeOn, match="MAY STILL BE ON"):
        with board:
            board.arm()
            demo.happens("pull")


def test_a_lost_cable_ends_the_records_with_an_error(demo, board):
    with pytest.raises(touchstone.MayBeOn) as error:
        with board:
            board.arm()
            for record in board.monitor():
                demo.happens("pull")
    assert isinstance(error.value.__context__, touchstone.Failed), "the error of the block is kept"


def test_no_board_is_an_error_that_names_the_port():
    with pytest.raises(touchstone.Failed, match="127.0.0.1:1"):
        touchstone.Board("tcp:127.0.0.1:1").info()
