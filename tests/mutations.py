"""What happens to files: disks, editors, scripts and people."""

import re

import numpy as np

HUGE = [b"1000000000", b"1e308", b"-1e308", b"9" * 400, b"1e-320", b"nan", b"inf", b"0x1F", b"1_0"]
STRANGE = ["é", "日本語 ", "\u0663", "\x85", "\u2028", "\ufeff", "\U0001f9cd"]
BLOCKS = ["{", "JOINT j%d\n{\nOFFSET 1 0 0", "begin", "}", "root j%d", "("]


def flipped_bits(data: bytes, rng: np.random.Generator) -> bytes:
    changed = bytearray(data)
    for place in rng.integers(0, len(data), rng.integers(1, 8)):
        changed[place] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def lines_lost_doubled_or_reordered(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.splitlines(keepends=True)
    start, count = rng.integers(len(lines)), rng.integers(1, 12)
    before, part, after = lines[:start], lines[start : start + count], lines[start + count :]
    changed = ([], part + part, [part[i] for i in rng.permutation(len(part))])[rng.integers(3)]
    return b"".join([*before, *changed, *after])


def a_number_changed(data: bytes, rng: np.random.Generator) -> bytes:
    """Most numbers near the beginning are counts, units and rates."""
    numbers = list(re.finditer(rb"[-+]?\d[\d.e+-]*", data))
    if not numbers:
        return data
    chosen = numbers[int(len(numbers) * rng.random() ** 4)]
    new = HUGE[rng.integers(len(HUGE))] if rng.random() < 0.6 else b"%d" % rng.integers(-3, 300)
    return data[: chosen.start()] + new + data[chosen.end() :]


def a_word_replaced(data: bytes, rng: np.random.Generator) -> bytes:
    """By another word of the file: cycles in a hierarchy, keywords out of place, names twice."""
    words = list(re.finditer(rb"[^\s,]+", data))
    early = [words[int(len(words) * rng.random() ** 3)] for _ in range(2)]
    return data[: early[0].start()] + early[1].group() + data[early[0].end() :]


def deeply_nested(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.splitlines(keepends=True)
    at, block = rng.integers(min(12, len(lines))), BLOCKS[rng.integers(len(BLOCKS))]
    nested = [(block.replace("%d", str(i)) + "\n").encode() for i in range(rng.integers(100, 3000))]
    return b"".join([*lines[:at], *nested, *lines[at:]])


def other_encodings(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.splitlines(keepends=True)
    at = rng.integers(len(lines))
    if rng.random() < 0.5:
        codec = str(rng.choice(["utf-16", "utf-16-be", "utf-32", "cp037"]))
        lines[at] = lines[at].decode("latin-1").encode(codec)
    else:
        new = str(rng.choice(STRANGE)).encode(str(rng.choice(["utf-8", "utf-16-le"])))
        middle = rng.integers(len(lines[at]) + 1)
        lines[at] = lines[at][:middle] + new + lines[at][middle:]
    return b"".join(lines)


MUTATIONS = [
    flipped_bits,
    lines_lost_doubled_or_reordered,
    a_number_changed,
    a_word_replaced,
    deeply_nested,
    other_encodings,
]


def mutated(data: bytes, rng: np.random.Generator) -> tuple[bytes, list[str]]:
    """One to three mutations in turn, and their names."""
    names = []
    for _ in range(rng.integers(1, 4)):
        mutation = MUTATIONS[rng.integers(len(MUTATIONS))]
        data = mutation(data, rng) or data
        names.append(mutation.__name__)
    return data, names
