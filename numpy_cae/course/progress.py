"""How many functions of the course are the student's own, and what they add up to."""

from contextlib import suppress
from pathlib import Path

from numpy_cae.course.catalogue import EXERCISES, LESSONS
from numpy_cae.course.mine import FILE, NotSavedError, run

ADD_UP_TO = {
    "00": "a first pullback",
    "01": "positions from a motion file",
    "02": "the features and the way back",
    "03": "the convolution",
    "04": "pooling and its inverses",
    "05": "a layer of the first paper",
    "06": "its training",
    "07": "the whole network of the first paper",
    "07b": "optimisers that train it in seconds",
    "08": "repair, filling, comparing, and the linear baseline",
    "09": "a GRU through time",
    "10": "the autoencoder of the second paper",
    "11": "new motions from a known distribution",
    "12": "a gradient checker",
    "13": "a fast convolution",
    "14": "losses of your own project",
}
"""ADD_UP_TO: what the exercises of a lesson make, when all of them are solved."""


def progress() -> None:
    """Print how many functions mine.py has, what the finished lessons make, and what is next."""
    mine: set[str] = set()
    with suppress(FileNotFoundError, NotSavedError, UnicodeDecodeError):
        mine = set(run(Path(FILE).read_text(encoding="utf-8"))) & set(EXERCISES)
    missing = {n: {task.name for task in tasks} - mine for n, tasks in LESSONS.items()}
    made = [ADD_UP_TO[number] for number, names in missing.items() if not names]
    print(f"{len(mine)} of {len(EXERCISES)} functions are yours")
    if made:
        print(f"They add up to: {', '.join(made)}.")
    if after := next((number for number, names in missing.items() if names), None):
        print(f"Next: {ADD_UP_TO[after]} (lesson {after}).")
