"""The blocks of frames; what is made of them is in `test_fast_convolution`."""

from hypothesis import given
from hypothesis import strategies as st

from numpy_cae.fast.blocks import block_length


@given(frames=st.integers(1, 1000), longest=st.integers(2, 60).map(lambda half: 2 * half))
def test_blocks_hold_every_frame_and_waste_less_than_two_a_block(frames, longest):
    length, count = block_length(frames, longest)
    assert length % 2 == 0
    assert length <= longest
    assert frames <= length * count < frames + 2 * count
