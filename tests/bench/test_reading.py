"""The reading benchmark: every reader on every file, as a table and as JSON."""

import json

from data_synth import make_take
from numpy_cae.bench.reading import HEADER
from numpy_cae.cli import main
from numpy_cae.motion import write_acclaim, write_bvh


def test_a_table_and_json(tmp_path, capsys):
    motion = make_take("walk", 0, seconds=1.0, rate=120.0).motion
    write_bvh(motion, tmp_path / "a.bvh", unit=0.01)
    write_acclaim(motion, tmp_path / "a.amc")
    files = [str(tmp_path / "a.bvh"), str(tmp_path / "a.amc")]
    assert main(["bench", "--rounds", "2", "--reading", *files]) == 0
    said = capsys.readouterr().out
    assert said.startswith(HEADER)
    assert "| a.amc | a line at a time | values as lists |" in said
    assert main(["bench", "--rounds", "2", "--json", "--reading", *files]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert {row["file"] for row in rows} == {"a.bvh", "a.amc"}
    assert all(row["speed"] > 0 for row in rows)


def test_what_cannot_be(tmp_path, capsys):
    assert main(["bench", "--reading", str(tmp_path / "no.bvh")]) == 2
    assert "no such file" in capsys.readouterr().err
