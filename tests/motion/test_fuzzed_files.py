"""Whatever happens to a file's text: it is read, all finite, or refused as a MotionFileError."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_acclaim import AMC, ASF
from test_damaged_bvh import WHOLE as BVH

from numpy_cae.motion import MotionFileError, load_motion

PIECES = [
    "{", "}", "\n", " ", "#", ":", "-", ".", "0", "1e5", "nan", "MOTION", "ROOT a", "JOINT b",
    "End Site", "OFFSET 1 2 3", "CHANNELS 1 Xrotation", "begin", "end", "root", "dof rx",
    ":root", ":bonedata", ":hierarchy", "tibia", "hip", "²", "٣", "\x85", "\u2028", "\0",
]  # fmt: skip


def mangled(text: str):
    """The text with a few stretches cut out, doubled or replaced."""
    place = st.integers(0, len(text))
    piece = st.sampled_from(PIECES) | st.builds(
        lambda at, n: text[at : at + n], place, st.integers(0, 40)
    )
    edits = st.lists(st.tuples(place, st.integers(0, 30), piece), min_size=1, max_size=4)

    def apply(edits):
        result = text
        for at, length, new in edits:
            result = result[:at] + new + result[at + length :]
        return result

    return edits.map(apply)


def read_or_refuse(path):
    try:
        motion = load_motion(path)
    except MotionFileError as refused:
        assert len(str(refused)) < 1000
    else:
        assert len(motion) > 0
        assert np.isfinite(motion.positions()).all()


@settings(max_examples=200, deadline=None)
@given(text=mangled(BVH))
def test_mangled_bvh(tmp_path_factory, text):
    path = tmp_path_factory.getbasetemp() / "mangled.bvh"
    path.write_bytes(text.encode())
    read_or_refuse(path)


@settings(max_examples=200, deadline=None)
@given(text=mangled(ASF))
def test_mangled_skeleton(tmp_path_factory, text):
    folder = tmp_path_factory.getbasetemp() / "mangled_asf"
    folder.mkdir(exist_ok=True)
    (folder / "02.asf").write_bytes(text.encode())
    (folder / "02_01.amc").write_text(AMC)
    read_or_refuse(folder / "02_01.amc")


@settings(max_examples=200, deadline=None)
@given(text=mangled(AMC))
def test_mangled_motion(tmp_path_factory, text):
    folder = tmp_path_factory.getbasetemp() / "mangled_amc"
    folder.mkdir(exist_ok=True)
    (folder / "02.asf").write_text(ASF)
    (folder / "02_01.amc").write_bytes(text.encode())
    read_or_refuse(folder / "02_01.amc")


@settings(max_examples=50, deadline=None)
@given(data=st.binary(min_size=1, max_size=200), suffix=st.sampled_from([".bvh", ".amc"]))
def test_anything_at_all(tmp_path_factory, data, suffix):
    path = tmp_path_factory.getbasetemp() / f"anything{suffix}"
    path.write_bytes(data)
    with pytest.raises(MotionFileError):
        load_motion(path)
