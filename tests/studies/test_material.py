"""Labels come from file names and tables, and the split from the names of files."""

import pytest

from data_synth import plan_takes, write_series
from numpy_cae.mocap.bodies import read_body
from studies.shared.material import labels_of, read_material, read_takes

PLANS = plan_takes(0.7, seed=3, kinds=["walk", "idle"])


@pytest.fixture(scope="module")
def material(tmp_path_factory):
    """Synthetic takes, the last for testing."""
    folder = tmp_path_factory.mktemp("takes") / "synthetic"
    write_series(PLANS, folder, rate=30.0)
    return read_material([folder], [f"{PLANS[-1].name}.bvh"])


def test_takes_whose_name_matches_a_pattern_are_for_testing(material):
    assert [take.path.stem for take in material.testing] == [PLANS[-1].name]


def test_all_others_are_for_training(material):
    assert {take.path.stem for take in material.training} == {plan.name for plan in PLANS[:-1]}


def test_labels_of_synthetic_takes_come_from_their_table(material):
    kinds = {plan.name: plan.kind for plan in PLANS}
    for take in material.training + material.testing:
        assert (take.source, take.content) == ("synthetic", kinds[take.path.stem])


def test_a_source_without_takes_is_empty(material):
    assert material.of("bandai").training == []


@pytest.mark.parametrize(
    ("name", "labels"),
    [
        (
            "dataset-2_raise-up-left-hand_elderly_004.bvh",
            ("bandai", "raise-up-left-hand", "elderly"),
        ),
        ("02_01.amc", ("other", "", "")),
    ],
)
def test_labels_come_from_the_name(tmp_path, name, labels):
    assert labels_of(tmp_path / name) == labels


@pytest.fixture
def broken(tmp_path):
    path = tmp_path / "broken.bvh"
    path.write_text("HIERARCHY\nROOT\n")
    return path


def test_a_file_that_cannot_be_read_is_noted_and_left_out(material, broken, capsys):
    good = material.testing[0].path
    assert [path for path, _ in read_takes([broken, good], read_body)] == [good]
    assert f"left out: {broken}" in capsys.readouterr().err


def test_files_of_which_none_can_be_read_are_refused(broken):
    with pytest.raises(ValueError, match="none of 1 files can be read"):
        list(read_takes([broken], read_body))
