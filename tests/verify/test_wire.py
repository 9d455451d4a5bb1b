"""Arrays cross to the student's process as they are, and nonsense from there is refused."""

import io
import json

import numpy as np
import pytest

from numpy_cae.verify.sandbox import wire

LARGER = np.arange(120.0).reshape(4, 6, 5)


def crossed(*values):
    pipe = io.BytesIO()
    wire.send(pipe, {"do": "call"}, values)
    pipe.seek(0)
    message, received = wire.receive(pipe)
    assert message == {"do": "call"} and not pipe.read()
    return received


@pytest.mark.parametrize(
    "array",
    [
        LARGER,
        LARGER[::-1, ::2, ::-3],
        LARGER.transpose(2, 0, 1),
        np.asfortranarray(LARGER),
        np.broadcast_to(np.ones(3), (2, 3)),
        LARGER.astype(np.float32)[1:3],
        LARGER[:, :0],
        LARGER > 3,
        np.array(1.5),
    ],
)
def test_an_array_keeps_numbers_dtype_and_strides(array):
    (received,) = crossed(array)
    np.testing.assert_array_equal(received, array)
    assert received.dtype == array.dtype
    assert received.strides == array.strides or not array.size
    assert received.flags.writeable


def test_numbers_keep_their_kind():
    half, precise, plain, nothing, flag = crossed(np.float32(0.5), np.float64(0.1), 0.1, None, True)
    assert type(half) is np.float32 and type(precise) is np.float64
    assert type(plain) is float and nothing is None and flag is True


def test_tuples_are_nested_and_what_cannot_be_sent_is_named():
    ((array, (inner,)), unsendable) = crossed((np.ones(2), [np.zeros(1)]), {1, 2})
    assert array.tolist() == [1, 1] and inner.tolist() == [0]
    assert isinstance(unsendable, wire.Unsendable) and unsendable.kind == "set"


def test_text_dicts_and_the_numbers_of_lent_functions_cross():
    text, named, lent = crossed("text", {"x": np.ones(2), "y": (1.0,)}, wire.Lent(3))
    assert text == "text" and named["x"].tolist() == [1, 1] and named["y"] == (1.0,)
    assert isinstance(lent, wire.Lent) and lent.number == 3


def message(**packed):
    header = json.dumps({"values": [packed]}).encode()
    return len(header).to_bytes(8, "big") + header + b"\0" * 64


@pytest.mark.parametrize(
    "said",
    [
        b"",
        b"short",
        (2**60).to_bytes(8, "big"),
        (5).to_bytes(8, "big") + b"{bad}",
        (2).to_bytes(8, "big") + b"{}",
        (2).to_bytes(8, "big") + b"[]",
        message(shape=[2], dtype="|O", strides=[8], scalar=False, bytes=16),
        message(shape=[2], dtype="<f8", strides=[8], scalar=False, bytes=2**40),
        message(shape=[3], dtype="<f8", strides=[8], scalar=False, bytes=16),
        message(shape=[2], dtype="<f8", strides=[8, 8], scalar=False, bytes=16),
        message(shape=[2], dtype="nonsense", strides=[8], scalar=False, bytes=16),
        message(shape=[2]),
    ],
)
def test_nonsense_is_a_broken_wire(said):
    with pytest.raises(wire.BrokenWire):
        wire.receive(io.BytesIO(said))
