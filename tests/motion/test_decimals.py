"""Decimal numbers by arithmetic on their bytes: what `float` says of each word, to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from numpy_cae.motion import decimals as module
from numpy_cae.motion.io.decimals import a_word_at_a_time, decimals

DIGITS = st.text("0123456789", max_size=19)
NUMBERS = st.one_of(
    st.builds("{}{}.{}".format, st.sampled_from(["", "-", "+"]), DIGITS, DIGITS),
    st.builds("{}{}".format, st.sampled_from(["", "-", "+"]), DIGITS.filter(bool)),
    st.floats(allow_nan=False).map(repr),
    st.builds("{:.{}f}".format, st.floats(-1e4, 1e4), st.integers(0, 9)),
    st.builds("{:.{}e}".format, st.floats(-1e4, 1e4), st.integers(0, 9)),
).filter(lambda word: any(letter.isdigit() for letter in word) or word.endswith("inf"))
NONE = "- + . -. e 1e 1e5.3 1.2.3 1-2 --1 +-1 1_000 0x1F nan -inf 1,5 a ٣ 1\x0c2"
JUNK = st.one_of(
    st.sampled_from(NONE.split(" ")),
    st.text(st.sampled_from("0123456789.+-eE_ \tx"), min_size=1, max_size=6),
)
GAPS = st.text(" \t", min_size=1, max_size=3)
EDGES = st.text(" \t", max_size=2)


@st.composite
def tables(draw, words=NUMBERS):
    """Text of a few lines, and how many words stand in each of most of them."""
    width = draw(st.integers(1, 5))
    lines = []
    for _ in range(draw(st.integers(1, 6))):
        line = draw(EDGES)
        for word in draw(st.lists(words, min_size=width, max_size=width)):
            line += word + draw(GAPS)
        lines.append(line if draw(st.booleans()) else line.rstrip(" \t"))
    return "\n".join(lines), width


def same(one, other):
    """Bit for bit: -0.0 is not 0.0."""
    if one is None or other is None:
        return one is other
    return one.shape == other.shape and one.tobytes() == other.tobytes()


@given(tables(), st.integers(1, 40))
@example((".5 5. -.5 -5. +0 -0 -0.0 00000000.00000000", 8), 40)
@example(("99999999.99999999 9007199.254740993 123456789.5 .123456789", 4), 40)
@example(("1e-5 -1.6201e-014 1E5 -1.5e+3", 4), 40)
def test_every_number_is_what_float_makes_of_it(table, block):
    text, width = table
    expected = a_word_at_a_time(text, width)
    assert expected is not None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "BLOCK", block)
        assert same(decimals(text.encode(), width), expected)


@given(tables(st.one_of(NUMBERS, JUNK)), st.integers(-1, 1))
def test_whatever_else_stands_there_both_refuse(table, more):
    text, width = table
    width = max(1, width + more)
    expected = a_word_at_a_time(text, width)
    found = decimals(text.encode(), width)
    # What is not of ASCII, or blank in an unusual way, is left to the twin altogether.
    usual = text.isascii() and "\x0c" not in text
    assert same(found, expected) if usual else found is None


@pytest.mark.parametrize("text", ["", "\n", "\n1 2", "1 2 \n \n3 4", "1 2\n3", "1\n2 3 4"])
def test_lines_of_other_lengths(text):
    assert decimals(text.encode(), 2) is None
    assert a_word_at_a_time(text, 2) is None


def test_every_real_number_of_six_decimals():
    """A table as programs write it, of more than one block."""
    values = np.random.default_rng(0).normal(0, 60, (9000, 6))
    text = "\n".join(" ".join(f"{value:.6f}" for value in row) for row in values)
    assert len(text) > 1.5 * module.BLOCK
    assert same(decimals(text.encode(), 6), a_word_at_a_time(text, 6))
