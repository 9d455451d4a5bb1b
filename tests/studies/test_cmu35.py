"""The published protocol on CMU subject 35."""

import zipfile

import numpy as np
import pytest

from studies import cmu35
from studies.cmu_protocol import networks, protocol
from studies.cmu_protocol.protocol import GROUPS, read_protocol


@pytest.fixture(scope="module")
def table(data_folder):
    if not (data_folder / "cmu35").is_dir():
        pytest.skip(f"no cmu35 in {data_folder}")
    return data_folder / "cmu35"


@pytest.fixture(scope="module")
def read(table):
    return read_protocol([table])


def test_the_nearest_neighbour_has_the_published_errors(read):
    published = {"leg": [(13.5, 4.44), (14.0, 4.11)], "body": [(20.9, 2.62), (30.9, 3.20)]}
    for group, columns in GROUPS.items():
        for weights, errors in zip((np.ones(59), read.deviation), published[group], strict=True):
            fill = protocol.nearest(read.standardised, columns, weights)
            sc, degrees = read.errors(fill, columns)
            assert (round(sc, 1), round(degrees, 2)) == errors


def test_acclaim_files_give_the_same_protocol(data_folder, read, table, monkeypatch):
    assert sum(map(len, read.takes)) == 2613 and read.test.shape == (124, 59)
    with np.load(table / "walk_jog_30hz.npz") as file:
        np.testing.assert_allclose(read.scale, file["taylor_scale"][9:], rtol=3e-4)
    monkeypatch.setattr(protocol, "TRAINING", [1, 17, 22])
    ours = read_protocol([data_folder / "cmu" / "asfamc" / "35"])
    theirs = read_protocol([table])
    np.testing.assert_array_equal(ours.test, theirs.test)
    np.testing.assert_array_equal(ours.scale, theirs.scale)
    np.testing.assert_array_equal(np.concatenate(ours.takes), np.concatenate(theirs.takes))


def test_a_method_never_receives_hidden_values(read):
    def fill(take, first):
        hidden = np.isnan(take)
        assert hidden[first:, GROUPS["leg"]].all() and hidden.sum() == 7 * (len(take) - first)
        return np.zeros((len(take), 7))

    read.errors(fill, GROUPS["leg"])


def test_the_residual_before_the_hole_is_carried_into_it():
    take = np.full((40, 59), 3.0)
    fill = protocol.add_residual(lambda take, first: np.zeros((len(take), 7)), GROUPS["leg"])
    filled = fill(take, 30)
    assert (filled[30] > 2.5).all() and (filled[30:] > 1).all()
    assert (np.diff(filled[30:], axis=0) < 0).all()


def test_missing_takes_are_named(tmp_path):
    with pytest.raises(ValueError, match=r"35_01, .*download cmu --subjects 35"):
        read_protocol([tmp_path])
    (tmp_path / "walk_jog_30hz.npz").write_bytes(b"no archive")
    with pytest.raises(ValueError, match=r"walk_jog_30hz\.npz: not the protocol"):
        read_protocol([tmp_path])


def test_the_network_is_trained_and_measured(table, monkeypatch):
    monkeypatch.setattr(protocol, "TRAINING", [17, 19, 20, 21, 22])
    monkeypatch.setattr(networks, "STEPS", 2)
    monkeypatch.setattr(cmu35, "SEEDS", 2)
    result = cmu35.run([table])
    published, test = result.tables
    assert len(result.claims) == 5 and len(published.rows) == 9
    names = [row[0] for row in test.rows]
    assert names[-1] == cmu35.NETWORK and all("±" in cell for cell in test.rows[-1][2:])


def test_a_table_that_unpacks_to_too_much_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "walk_jog_30hz.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("train_35_01.npy", bytes(10**8))
    with pytest.raises(ValueError, match="it unpacks to 100 MB, expected at most"):
        cmu35.run([tmp_path])
