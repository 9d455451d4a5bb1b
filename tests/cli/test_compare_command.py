"""`numpy-cae compare`: the matrix that it writes, and its error messages."""

import csv

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.manifold import save_manifold
from numpy_cae.motion import write_bvh


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions")
    (motions / "more").mkdir()
    for name, kind, seconds in (("a", "walk", 2.0), ("more/b", "wave", 1.5), ("more/a", "run", 1)):
        write_bvh(make_take(kind, 0, seconds, 30.0).motion, motions / f"{name}.bvh", unit=0.01)
    return motions


@pytest.fixture(scope="module")
def model(untrained_manifold, tmp_path_factory):
    file = tmp_path_factory.mktemp("model") / "model.npz"
    save_manifold(untrained_manifold, file)
    return file


def run(*argv):
    return main([str(word) for word in argv])


def test_a_folder_becomes_a_matrix_and_a_picture(folder, model, tmp_path, capsys):
    table, picture = tmp_path / "matrix.csv", tmp_path / "matrix.png"
    assert run("compare", folder, "-m", model, "-o", table, "--picture", picture) == 0
    assert capsys.readouterr().out.startswith("a.bvh: nearest is ")
    with open(table, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header == ["", "a.bvh", "more/a.bvh", "more/b.bvh"]
    assert [row[0] for row in rows] == header[1:]
    matrix = np.array([row[1:] for row in rows], dtype=float)
    np.testing.assert_array_equal(matrix, matrix.T)
    np.testing.assert_array_equal(np.diag(matrix), 0)
    assert matrix[0, 1] > 0
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["matrix.csv", "matrix.png"]


def test_two_files_of_one_name_are_told_apart(folder, model, capsys):
    one, other = folder / "a.bvh", folder / "more" / "a.bvh"
    assert run("compare", one, other, "-m", model) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith(f"{one}: nearest is {other}, G = ")
    assert first.split()[-1] == second.split()[-1]


def test_an_error_is_one_line(folder, model, tmp_path, capsys):
    for argv, message in (
        ([folder / "a.bvh"], "one motion alone"),
        ([folder / "a.bvh", tmp_path / "no.bvh"], "no such file"),
        ([folder, "-o", tmp_path / "no" / "m.csv"], "no folder"),
    ):
        assert run("compare", *argv, "-m", model) == 2
        lines = capsys.readouterr().err.strip().splitlines()
        assert len(lines) == 1
        assert lines[0].startswith("numpy-cae compare: ")
        assert message in lines[0]
    assert not list(tmp_path.iterdir())
