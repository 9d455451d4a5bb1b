"""`--json`: one value on standard output, whatever is in a result, and nothing beside it."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from numpy_cae.cli.shared.output import plain, print_json


@dataclass(frozen=True)
class Found:
    name: str
    figures: dict
    held: bool


def test_whatever_a_result_is_made_of(capsys):
    figures = {1: np.float32(0.5), "none": np.nan, "far": -np.inf, "many": np.arange(3)}
    found = Found("é", figures, np.bool_(True))
    print_json({"all": [found, (None, Path("a"))]})
    said = capsys.readouterr().out
    assert "é" in said
    figures = {"1": 0.5, "none": None, "far": None, "many": [0, 1, 2]}
    assert json.loads(said) == {
        "all": [{"name": "é", "figures": figures, "held": True}, [None, "a"]]
    }
    with pytest.raises(TypeError, match="bytes has no form"):
        plain({"picture": b"PNG"})
