"""The curve that grows while a loop runs: one display, updated, with the means of blocks."""

import pytest

from numpy_cae.viz import LiveCurve

ipython = pytest.importorskip("IPython.display")


class Display(list):
    """In place of IPython's display and its handle: the points of each figure displayed."""

    def update(self, figure, display_id=None):
        self.append(figure.axes[0].lines[0].get_xydata().tolist())
        return self

    __call__ = update


def test_the_last_drawing_has_every_value(monkeypatch):
    shown = Display()
    monkeypatch.setattr(ipython, "display", shown)
    with LiveCurve("loss", block=2, seconds=1e9) as curve:
        assert not shown
        for value in (4, 2, 1, 3, 5):
            curve.add(value)
    assert shown == [[[1, 4]], [[2, 3], [4, 2], [5, 5]]]
