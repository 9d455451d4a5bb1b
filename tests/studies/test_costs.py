"""Costs: tables of every size, and their slopes; the commands are not run here."""

import pytest

from studies import costs


@pytest.fixture(scope="module")
def result():
    """All tables for few sizes; the commands are not run, each costs 2 s and 50 MB."""
    sizes = {"SECONDS": (1, 2, 4), "FILES": (1, 2, 4), "WINDOWS": (1, 2, 4), "JOINTS": (2, 3, 4)}
    sizes |= {"HIDDEN": (4, 5, 6), "TAKES": 1}
    with pytest.MonkeyPatch.context() as patch:
        for name, few in sizes.items():
            patch.setattr(costs, name, few)
        patch.setattr(costs, "_cost", lambda *words: (2.0, 50.0))
        return costs.run()


def test_each_command_has_its_seconds_and_memory(result):
    commands, *_ = result.tables
    assert commands.rows[1] == ["repair of 80 frames", 2.0, 50.0]


def test_a_cost_that_does_not_grow_has_the_slope_0(result):
    frames, files, *_ = result.tables[-1].rows
    assert frames[1:] == [30, 120, 2.0, 2.0, pytest.approx(0), 50.0]
    assert files[2] == 4


def test_what_is_timed_here_takes_time(result):
    _, _, *timed = result.tables[-1].rows
    assert len(timed) == 3 and all(row[3] > 0 for row in timed)


def test_each_growth_is_drawn_beside_a_straight_line(result):
    figures = [picture.draw() for picture in result.figures.values()]
    assert [len(figure.axes[0].lines) for figure in figures] == [2] * 5


def test_the_slope_of_a_square_is_2():
    squares = {n: (0.01 * n**2, None) for n in (1, 10, 20, 40)}
    assert costs._slope(squares) == pytest.approx(2)


def test_a_command_has_seconds_and_memory():
    seconds, megabytes = costs._cost("--help")
    assert 0.01 < seconds < 30 and 10 < megabytes < 1000


def test_a_command_that_fails_is_no_measurement():
    with pytest.raises(OSError, match="ended with status 2"):
        costs._cost("rig", "missing.bvh")
