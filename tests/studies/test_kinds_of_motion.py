"""PCA on one kind of motion and on many."""

from pathlib import Path

import numpy as np
import pytest

from numpy_cae.evaluation.tables import clips_of
from studies import kinds_of_motion
from studies.kinds_of_motion import ALL, ALL_AXES, FRAMES, NETWORK, OWN, WINDOWS, Kinds
from studies.shared.material import LabelledTake, Material


def test_both_kinds_of_pca_are_judged(result_of):
    claims = result_of("kinds_of_motion").claims
    for key in ("pca_many_types", "pca_gait", "small_subspace"):
        assert [claim.of for claim in claims if claim.key == key] == [FRAMES, WINDOWS]


def test_methods_that_are_compared_have_as_many_numbers(result_of):
    frames, _, _, windows, *_ = result_of("kinds_of_motion").tables
    for table, name in ((frames, FRAMES), (windows, WINDOWS)):
        of_all = table.value(f"{name}, {ALL}", "numbers")
        assert of_all == table.value(f"{name}, {OWN}", "numbers")
        assert table.value(f"{name}, {ALL_AXES}", "numbers") <= table.value(NETWORK, "numbers")
    assert frames.value(f"{FRAMES}, {ALL}", "numbers") == 4  # 16 units for 4 frames


def test_windows_of_a_kind_are_those_of_its_takes(small_manifold, labelled):
    clips = clips_of(small_manifold, [take.positions for take in labelled.training])
    kinds = Kinds.of(labelled.training, clips)
    walks = kinds.pick(["walk"])
    assert set(walks.kinds) == {"walk"} and len(walks.clips) == kinds.counts()["walk"]
    contents = [labelled.training[number].content for number in walks.clips.take]
    assert set(contents) == {"walk"}
    np.testing.assert_array_equal(walks.clips.x, clips.x[kinds.kinds == "walk"])


def test_a_kind_without_training_takes_is_left_out(small_manifold, labelled):
    waves = [take for take in labelled.training if take.content == "wave"]
    with pytest.raises(ValueError, match="one kind for training and for testing"):
        walks = [take for take in labelled.testing if take.content == "walk"]
        kinds_of_motion.run(small_manifold, Material(waves, walks))
    result = kinds_of_motion.run(small_manifold, Material(waves, labelled.testing))
    assert "pca_gait" not in {claim.key for claim in result.claims}


def test_a_tenth_of_the_dimensions_is_counted(result_of):
    tables = result_of("kinds_of_motion").tables
    frames = next(table for table in tables if table.header[0] == "principal components")
    assert (frames.value(FRAMES, "axes"), frames.value(FRAMES, "dimensions")) == (6, 63)


def test_short_takes_are_counted():
    takes = [LabelledTake(Path(), np.zeros((frames, 20, 3))) for frames in (100, 160, 161, 400)]
    (claim,) = kinds_of_motion._actions(takes).claims
    assert claim.figures.startswith("50%") and claim.fulfilled is None
