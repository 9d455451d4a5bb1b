"""The map of codes keeps distances, and its page plays every take."""

import numpy as np
import pytest

from numpy_cae.manifold import starter
from studies import codes
from studies.codes import scale
from studies.shared.result import write_moving


@pytest.fixture(scope="module")
def result():
    return codes.run(starter(), None)


def test_squared_distances_on_the_map_are_distances_of_codes():
    # Three places always fit into two dimensions.
    points = np.random.default_rng(0).normal(size=(3, 7))
    places, share = scale(points)
    squared = np.square(places[:, None] - places[None]).sum(axis=-1)
    distances = np.linalg.norm(points[:, None] - points[None], axis=-1)
    np.testing.assert_allclose(squared, distances, atol=1e-12)
    assert share == pytest.approx(1)


def test_nearest_takes_are_of_one_kind_more_often_than_at_random(result):
    shares = [row[1] for row in result.tables[0].rows]
    assert min(shares[:2]) > 5 * shares[2]


def test_the_damaged_copy_lies_further_from_its_take_than_the_projection(result):
    page = result.figures["codes"].page
    paths = [point for point in page.args[0] if len(point.path)]
    lengths = [np.linalg.norm(point.path - point.place, axis=1) for point in paths]
    closer = np.mean([projected < damaged for damaged, projected in lengths])
    assert len(paths) == 16 and closer > 0.8


@pytest.mark.parametrize("name", ["codes", "filters"])
def test_a_page_is_smaller_than_a_megabyte(result, name, tmp_path):
    path = tmp_path / f"{name}.html"
    write_moving(result.figures[name], path)
    assert path.stat().st_size < 1e6
