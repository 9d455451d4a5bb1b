"""How many functions of the course are the student's own, and what they add up to."""

from contextlib import suppress
from pathlib import Path

from numpy_cae.course.catalogue import EXERCISES, LESSONS
from numpy_cae.course.exercises.entries import made_by
from numpy_cae.course.mine import FILE, NotSavedError, run


def progress() -> None:
    """Print how many functions mine.py has, what the finished lessons make, and what is next."""
    mine: set[str] = set()
    with suppress(FileNotFoundError, NotSavedError, UnicodeDecodeError):
        mine = set(run(Path(FILE).read_text(encoding="utf-8"))) & set(EXERCISES)
    missing = {n: {task.name for task in tasks} - mine for n, tasks in LESSONS.items()}
    made = [made_by(number) for number, names in missing.items() if not names]
    print(f"{len(mine)} of {len(EXERCISES)} functions are yours")
    if made:
        print(f"They add up to: {', '.join(made)}.")
    if after := next((number for number, names in missing.items() if names), None):
        print(f"Next: {made_by(after)} (lesson {after}).")
