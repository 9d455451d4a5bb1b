"""How arrays travel between the grader and a student's process: JSON and raw bytes, no pickle.

A message is a header in JSON, its length before it in 8 bytes, and the bytes of its arrays after
it. Arrays keep their dtype and, towards the student, their strides. Imports nothing of the
project, since the student's process uses it too.
"""

from __future__ import annotations

import json
from typing import BinaryIO

import numpy as np

LONGEST_HEADER = 10**7
LARGEST_ARRAY = 2**30


class BrokenWire(Exception):
    """The other side is gone, or what it says makes no sense."""


def send(pipe: BinaryIO, message: dict, values: list | tuple = ()) -> None:
    """Send a message with some values: arrays, numbers, text, None, tuples and dicts of these."""
    buffers: list[bytes] = []
    header = json.dumps({**message, "values": [_packed(value, buffers) for value in values]})
    encoded = header.encode()
    pipe.write(b"".join([len(encoded).to_bytes(8, "big"), encoded, *buffers]))
    pipe.flush()


def receive(pipe: BinaryIO) -> tuple[dict, list]:
    """Receive a message and its values.

    Raises
    ------
    BrokenWire
        If the pipe ends or the message makes no sense.
    """
    length = int.from_bytes(_read(pipe, 8), "big")
    if length > LONGEST_HEADER:
        raise BrokenWire("a header of impossible length")
    try:
        message = json.loads(_read(pipe, length))
        values = [_unpacked(packed, pipe) for packed in message.pop("values")]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise BrokenWire(f"a message that makes no sense ({error})") from None
    return message, values


class Unsendable:
    """Stands for something that cannot be sent."""

    def __init__(self, kind: str) -> None:
        self.kind = kind


class Lent:
    """Stands for a function that stays on the grader's side, to be called from the other."""

    def __init__(self, number: int) -> None:
        self.number = number


def _packed(value, buffers: list[bytes]):
    if value is None or type(value) in (bool, int, float, str):
        return {"plain": value}
    if isinstance(value, tuple | list):
        return {"tuple": [_packed(part, buffers) for part in value]}
    if isinstance(value, dict) and all(isinstance(key, str) for key in value):
        return {"dict": {key: _packed(part, buffers) for key, part in value.items()}}
    if isinstance(value, Lent):
        return {"lent": value.number}
    if isinstance(value, np.ndarray | np.generic) and value.dtype.kind in "biuf":
        return _packed_array(np.asarray(value), isinstance(value, np.generic), buffers)
    return {"other": type(value).__name__}


def _packed_array(array: np.ndarray, is_scalar: bool, buffers: list[bytes]) -> dict:
    """Its numbers in the order of its own strides, so that the other side can lay it out alike."""
    buffers.append(array.tobytes())
    return {
        "shape": array.shape,
        "dtype": array.dtype.str,
        "strides": array.strides,
        "scalar": is_scalar,
        "bytes": array.nbytes,
    }


def _unpacked(packed: dict, pipe: BinaryIO):
    if "plain" in packed:
        return packed["plain"]
    if "tuple" in packed:
        return tuple(_unpacked(part, pipe) for part in packed["tuple"])
    if "dict" in packed:
        return {str(key): _unpacked(part, pipe) for key, part in packed["dict"].items()}
    if "lent" in packed:
        return Lent(int(packed["lent"]))
    if "other" in packed:
        return Unsendable(str(packed["other"]))
    if not 0 <= packed["bytes"] <= LARGEST_ARRAY:
        raise ValueError("an array of impossible size")
    dtype = np.dtype(packed["dtype"])
    if dtype.kind not in "biuf":
        raise ValueError(f"an array of {dtype}")
    numbers = np.frombuffer(_read(pipe, packed["bytes"]), dtype).reshape(packed["shape"])
    if packed["scalar"]:
        return numbers[()]
    return laid_out(numbers, tuple(packed["strides"]))


def laid_out(numbers: np.ndarray, strides: tuple[int, ...]) -> np.ndarray:
    """A writeable copy with the given strides, in memory of its own."""
    reach = [(n - 1) * s for n, s in zip(numbers.shape, strides, strict=True)]
    if numbers.size == 0 or sum(map(abs, reach)) > LARGEST_ARRAY:
        return numbers.copy()
    first = -sum(min(r, 0) for r in reach)
    memory = np.zeros(first + sum(max(r, 0) for r in reach) + numbers.itemsize, np.uint8)
    array = np.ndarray(numbers.shape, numbers.dtype, memory, first, strides)
    array[...] = numbers
    return array


def _read(pipe: BinaryIO, count: int) -> bytes:
    data = pipe.read(count)
    if data is None or len(data) < count:
        raise BrokenWire("the end of the pipe")
    return data
