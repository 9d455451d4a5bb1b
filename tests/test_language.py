"""The language of docstrings, comments, messages and pages: the field's terms, plain English."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

LINES = (ROOT / "tests" / "files" / "old_words.txt").read_text(encoding="utf-8").splitlines()
WORDS = dict(line.split("\t") for line in LINES)
"""Words that a reader stops at, and what to write instead."""

CODE = sorted((ROOT / "numpy_cae").rglob("*.py")) + sorted((ROOT / "data_synth").glob("*.py"))
PAGES = [ROOT / "README.md", *(ROOT / "docs").glob("*.md"), *(ROOT / "docs/lab_book").glob("*.md")]


@pytest.mark.parametrize("word", WORDS)
def test_no_text_has_a_word_of_the_old_language(word):
    lines = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in [*CODE, *PAGES]
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if re.search(word, line, re.IGNORECASE)
    ]
    assert not lines, f"write instead: {WORDS[word]}\n" + "\n".join(lines)
