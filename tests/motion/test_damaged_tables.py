"""Damaged mappings and labels raise the documented error and no other exception."""

import json

import numpy as np
import pytest
from mutations import mutated

from numpy_cae.motion import JOINTS, UnknownRigError, read_mapping

MAPPING = json.dumps({joint: joint.title() for joint in JOINTS}, indent=1).encode()


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
