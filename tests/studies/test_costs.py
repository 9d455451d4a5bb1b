"""Costs: tables of every size, and their slopes; the commands are not run here."""

import pytest

from studies import costs


def test_every_size_has_a_row_and_a_slope(monkeypatch):
    sizes = {"SECONDS": (1, 2, 4), "FILES": (1, 2, 4), "WINDOWS": (1, 2, 4), "JOINTS": (2, 3, 4)}
    for name, few in (sizes | {"HIDDEN": (4, 5, 6), "TAKES": 1, "READ_SECONDS": 10.0}).items():
        monkeypatch.setattr(costs, name, few)
    monkeypatch.setattr(costs, "READERS", {"missing": ""})
    monkeypatch.setattr(costs, "_cost", lambda *words: (2.0, 50.0))
    result = costs.run()
    assert len(result.figures) == 5
    for picture in result.figures.values():
        assert len(picture.draw().axes[0].lines) == 2
    commands, readers, growth = result.tables
    assert commands.rows[1] == ["repair of 80 frames", 2.0, 50.0]
    assert readers.rows[0][0] == "numpy_cae" and readers.rows[0][1] > 0.1
    frames, files, *others = growth.rows
    assert frames[1:] == [30, 120, 2.0, 2.0, pytest.approx(0), 50.0] and files[2] == 4
    assert len(others) == 3 and all(row[3] > 0 for row in others)
    assert costs._slope({n: (0.01 * n**2, None) for n in (1, 10, 20, 40)}) == pytest.approx(2)


def test_a_command_that_fails_is_no_measurement():
    seconds, megabytes = costs._cost("--help")
    assert 0.01 < seconds < 30 and 10 < megabytes < 1000
    with pytest.raises(OSError, match="ended with status 2"):
        costs._cost("rig", "missing.bvh")
