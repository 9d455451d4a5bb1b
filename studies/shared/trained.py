"""Networks that studies train, and a folder that keeps them, so that a table can be made again
without training again.

A file of the folder is named by a hash of everything that a training depends on: the takes, the
schedule, the sizes of the network, the seed and the version of numpy_cae. After a change of the
training itself, which the version does not show, delete the folder.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

import numpy_cae
from numpy_cae.manifold import (
    MotionManifold,
    SequenceManifold,
    learn_manifold,
    load_manifold,
)
from numpy_cae.training import Schedule, TrainingState
from studies.shared.messages import note

Manifold = TypeVar("Manifold", MotionManifold, SequenceManifold)


@dataclass(frozen=True)
class Trainer:
    """Trains networks, and keeps them in a folder.

    Parameters
    ----------
    folder : Path, optional
        Nothing is kept where None.
    report : function (TrainingState), optional
        Called after every step of a training.
    """

    folder: Path | None = None
    report: Callable[[TrainingState], None] | None = None

    def learn(
        self, takes: Sequence[np.ndarray], schedule: Schedule, seed: int, **network: Any
    ) -> MotionManifold:
        """`learn_manifold` of takes (F, 20, 3); `network` are its arguments of the network."""
        return self.keep(
            lambda: learn_manifold(takes, schedule, seed, report=self.report, **network),
            *takes,
            schedule,
            seed,
            network,
        )

    def keep(self, train: Callable[[], Manifold], *settings: object) -> Manifold:
        """What `train` returns, or what it returned when the settings were the same."""
        if self.folder is None:
            return train()
        path = self.folder / f"{hash_of(settings)}.npz"
        if not path.is_file():
            manifold = train()
            path.parent.mkdir(parents=True, exist_ok=True)
            manifold.save(path)
            note(f"the network is kept: {path}")
        return load_manifold(path)


def hash_of(settings: Sequence[object]) -> str:
    """A hash of arrays, by their numbers, and of other values, by their repr."""
    digest = blake2b(numpy_cae.__version__.encode(), digest_size=12)
    for value in settings:
        if isinstance(value, np.ndarray):
            digest.update(repr((value.shape, value.dtype.str)).encode())
            digest.update(np.ascontiguousarray(value).tobytes())
        else:
            digest.update(repr(value).encode())
    return digest.hexdigest()


def default_folder() -> Path:
    """The folder of this user's caches."""
    caches = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(caches) / "numpy_cae_studies"
