"""The language of docstrings, comments, messages and pages: the field's terms, plain English."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

WORDS = {
    r"half[- ]zeroed": "half of the values removed",
    r"(?<!averaged over )all shifts(?! of (the|its) pooling grid)": "averaged over all shifts",
    r"\bto the (same )?bits?\b|\bthe same bits\b": "unchanged, bit-identical",
    r"\bto the byte\b": "byte for byte, unchanged",
    r"\btold\b": "mask given; a method is given ..., the command prints ...",
    r"\bblind(ly)?\b": "mask unknown",
    r"\.reach\b|`reach`|\breach(es)? of (the|a) (network|layer|filter)": "receptive radius",
    r"\.shifts\b|`shifts`|frames_per_unit|pooling cells?\b": "stride, hidden frame",
    r"\brooms?\b": "package, module",
    r"\bclaims? held\b|\bheld (if|only if)\b": "a claim is confirmed",
    r"\bends held\b": "ends repeated",
    r"\b(deed|yardstick|contender|servant|gatekeeper)(e?s)?\b|\bstraw m[ae]n\b": "plain words",
    r"\bis so stays\b|\bdear\b": "such files pass through unchanged; expensive",
    r"\bPCA has, in each\b": "for PCA the best size on the test takes is shown, which favours PCA",
}
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
