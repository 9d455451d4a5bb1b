"""What happens to files: disks, editors, scripts and people."""

import re

import numpy as np

HUGE = [
    b"1000000000",
    b"1e308",
    b"-1e308",
    b"9" * 400,
    b"1e-320",
    b"nan",
    b"inf",
    b"0x1F",
    b"1_000",
]


def flipped(data: bytes, rng: np.random.Generator) -> bytes:
    changed = bytearray(data)
    for place in rng.integers(0, len(data), rng.integers(1, 8)):
        changed[place] ^= 1 << int(rng.integers(8))
    return bytes(changed)


def cut_off(data: bytes, rng: np.random.Generator) -> bytes:
    return data[: rng.integers(1, len(data))]


def lines_dropped(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.splitlines(keepends=True)
    start, count = rng.integers(len(lines)), rng.integers(1, 6)
    return b"".join(lines[:start] + lines[start + count :])


def lines_doubled(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.splitlines(keepends=True)
    start, count = rng.integers(len(lines)), rng.integers(1, 12)
    return b"".join(lines[: start + count] + lines[start:])


def lines_reordered(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.splitlines(keepends=True)
    start, count = rng.integers(len(lines)), rng.integers(2, 12)
    part = lines[start : start + count]
    return b"".join(
        lines[:start] + [part[i] for i in rng.permutation(len(part))] + lines[start + count :]
    )


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
    depth = int(rng.integers(100, 3000))
    lines = data.splitlines(keepends=True)
    at = rng.integers(min(12, len(lines)))
    block = rng.choice(np.array(["{", "JOINT j%d\n{\nOFFSET 1 0 0", "begin", "}", "root j%d", "("]))
    nested = b"".join(
        (str(block) % i if "%" in str(block) else str(block)).encode() + b"\n" for i in range(depth)
    )
    return b"".join(lines[:at]) + nested + b"".join(lines[at:])


def other_encodings(data: bytes, rng: np.random.Generator) -> bytes:
    lines = data.splitlines(keepends=True)
    at = rng.integers(len(lines))
    codec = str(rng.choice(["utf-16", "utf-16-be", "utf-32", "cp037"]))
    strange = ["é", "日本語 ", "\u0663", "\x85", "\u2028", "\ufeff", "\U0001f9cd"]
    if rng.random() < 0.5:
        lines[at] = lines[at].decode("latin-1").encode(codec)
    else:
        new = str(rng.choice(strange)).encode(str(rng.choice(["utf-8", "utf-16-le"])))
        middle = rng.integers(len(lines[at]) + 1)
        lines[at] = lines[at][:middle] + new + lines[at][middle:]
    return b"".join(lines)


def stiff_joints_and_short_lines(data: bytes, rng: np.random.Generator) -> bytes:
    """Few bytes that ask for much memory: bones without values times frames of one value."""
    joints = b"".join(b"JOINT s%d\n{\nOFFSET 0 1 0\n}\n" % i for i in range(rng.integers(1, 1500)))
    rows = b"0\n" * int(rng.integers(1, 30_000))
    head = b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n" + joints + b"}\nMOTION\n"
    seconds = HUGE[rng.integers(2)] if rng.random() < 0.5 else b"%g" % 10 ** rng.uniform(-4, 5)
    return head + b"Frames: %d\nFrame Time: %s\n" % (rows.count(b"\n"), seconds) + rows


MUTATIONS = [
    flipped,
    cut_off,
    lines_dropped,
    lines_doubled,
    lines_reordered,
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
