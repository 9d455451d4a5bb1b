"""Pairs of submissions that are alike after renaming: a sign to look at them, not a verdict."""

import ast
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

from numpy_cae.verify.grading.submission import Submission

LONG = 6
"""LONG: runs of so many parts of the syntax are compared."""
LEAST_SHARE = 0.6
"""LEAST_SHARE: a pair is listed if it shares this part of what is not common to the class."""
LEAST_RUNS = 20
"""LEAST_RUNS: a pair with less to compare is not listed: a short answer has few forms."""
COMMON = 0.1
"""COMMON: a run in more than this part of the submissions, and in more than `FEW`, is common."""
FEW = 4


def similar_pairs(submissions: Mapping[str, Sequence[Submission]]) -> list[tuple[float, str, str]]:
    """The pairs of students whose functions are alike, each with the share, most alike first.

    Names, comments, docstrings, numbers and the layout do not count.
    """
    runs = {student: set(_runs(files)) for student, files in submissions.items()}
    counts = Counter(run for each in runs.values() for run in each)
    most = max(FEW, COMMON * len(runs))
    rare = {student: {r for r in each if counts[r] <= most} for student, each in runs.items()}
    pairs = []
    for one, other in combinations(rare, 2):
        union = len(rare[one] | rare[other])
        share = len(rare[one] & rare[other]) / max(union, LEAST_RUNS)
        if share >= LEAST_SHARE:
            pairs.append((share, one, other))
    return sorted(pairs, reverse=True)


def _runs(files: Sequence[Submission]) -> Iterator[tuple[str, ...]]:
    for file in files:
        for _, source in file.cells:
            try:
                tree = ast.parse(source)
            except (SyntaxError, ValueError, RecursionError, MemoryError):
                continue
            for function in ast.walk(tree):
                if isinstance(function, ast.FunctionDef):
                    parts = list(_parts(function))
                    yield from zip(*(parts[n:] for n in range(LONG)), strict=False)


def _parts(function: ast.FunctionDef) -> Iterator[str]:
    """The types of the syntax of a function, in their order, and the names of attributes."""
    for node in ast.walk(function):
        if not isinstance(node, ast.Load | ast.Store | ast.Constant | ast.arg | ast.Name):
            yield type(node).__name__ + getattr(node, "attr", "")
