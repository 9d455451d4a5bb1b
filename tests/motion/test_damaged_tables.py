"""Damaged mappings and labels raise the documented error and no other exception."""

from __future__ import annotations

import json

import numpy as np
import pytest
from mutations import mutated

from data_synth.__main__ import main as make
from numpy_cae.experiments import material
from numpy_cae.motion import JOINTS, MotionFileError, UnknownRigError, read_mapping

MAPPING = json.dumps({joint: joint.title() for joint in JOINTS}, indent=1).encode()


@pytest.fixture(scope="module")
def labels(tmp_path_factory):
    folder = tmp_path_factory.mktemp("labels")
    assert make([str(folder), "--minutes", "0.1", "--rate", "30", "--quiet"]) == 0
    return (folder / "labels.csv").read_bytes()


@pytest.mark.parametrize("count", [60, pytest.param(5000, marks=pytest.mark.thorough)])
def test_mutated_mappings(tmp_path, count):
    for number in range(count):
        data, names = mutated(MAPPING, np.random.default_rng(number))
        path = tmp_path / "rig.json"
        path.write_bytes(data)
        try:
            mapping = read_mapping(path)
        except UnknownRigError as refused:
            assert str(path) in str(refused), (number, names)
        else:
            assert all(isinstance(name, str) for name in mapping.values())


def test_a_mapping_that_is_nested_deeply(tmp_path):
    path = tmp_path / "rig.json"
    path.write_text('{"hips":' + "[" * 100_000)
    with pytest.raises(UnknownRigError):
        read_mapping(path)


@pytest.mark.parametrize("count", [60, pytest.param(5000, marks=pytest.mark.thorough)])
def test_mutated_labels(tmp_path, labels, count):
    names = [line.split(",")[0] for line in labels.decode().splitlines()[1:]]
    for number in range(count):
        data, done = mutated(labels, np.random.default_rng(number))
        material._read_labels.cache_clear()
        (tmp_path / "labels.csv").write_bytes(data)
        try:
            for name in names:
                source, kind, style = material.labels_of(tmp_path / name)
                assert (source, type(kind), type(style)) in (
                    ("synthetic", str, str),
                    ("other", str, str),
                )
        except MotionFileError as refused:
            assert "labels.csv" in str(refused), (number, done)
    material._read_labels.cache_clear()
