"""The motions that excite a unit most: what a filter of the deepest layer is about, shown by the
held-out takes in which it is highest (holden2015, section 6: "natural … components of motion").
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold, hidden_units
from numpy_cae.measures.retrieval import bootstrapped_difference
from numpy_cae.motion import PARENTS, POSITIONS
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, save_figure, strip_figure

TOP = 5
"""Takes that a unit is judged by."""
UNITS, ROWS, SHOWN = 3, 3, 54
"""Units drawn, takes of each, frames about the moment: half of what a unit sees."""
_COLOURS = (PROJECTED, CORRUPTED, TRUTH)


@dataclass(frozen=True)
class Excited:
    """Where each unit of the deepest layer is highest.

    Parameters
    ----------
    highest, moment : (takes, units) arrays
        The largest value in a take, and the frame in which it stands.
    takes : list of LabelledTake
    local : list of (F, 20, 3) array
        Their joints in the body's own heading, metres.
    agreement : label to name to (units,) array
        How many of the top takes of a unit bear the label that most of them bear, as a share: of
        the trained network, of an untrained one, and of takes drawn at random.
    rate : float
    seed : int
        Of the resampling.
    """

    highest: np.ndarray
    moment: np.ndarray
    takes: list[LabelledTake]
    local: list[np.ndarray]
    agreement: dict[str, dict[str, np.ndarray]]
    rate: float
    seed: int
    title: str = "The motions that excite a unit most"

    def text(self) -> str:
        """A few units with their takes, and how far the top takes agree over all units."""
        rows = [
            [f"unit {unit + 1}", *[
                f"{_name(self.takes[take])} ({self.highest[take, unit]:.2f})"
                for take in self._top(unit)[:ROWS]
            ]]
            for unit in self._chosen()
        ]  # fmt: skip
        names = list(next(iter(self.agreement.values())))
        agree = [
            [name, *[f"{each[name].mean():.2f}" for each in self.agreement.values()]]
            for name in names
        ]
        ranks = [str(rank) for rank in range(1, ROWS + 1)]
        return (
            f"Takes of {len(self.takes)} held out in which a unit is highest:\n\n"
            f"{text_table(['unit', *ranks], rows)}\n\n"
            f"Of the top {TOP} takes of a unit, the share that bear the commonest label among "
            f"them, mean of {self.highest.shape[1]} units:\n\n"
            f"{text_table(['takes', *self.agreement], agree)}"
        )

    def findings(self) -> list[Finding]:
        """Whether units are about contents and styles, more than an untrained network's are."""
        found = []
        for label, each in self.agreement.items():
            trained, before, drawn = each.values()
            gap = bootstrapped_difference(trained, before, self.seed)
            found.append(
                Finding(
                    "Each filter corresponds to a natural component of motion (holden2015, section "
                    f"6): the motions that excite a unit most agree in {label}, more than those "
                    "that excite an untrained one.",
                    gap.low > 0,
                    f"{trained.mean():.2f} of the top {TOP} bear one label, {before.mean():.2f} "
                    f"untrained, {drawn.mean():.2f} at random; difference {gap.text()}, resampling "
                    "units.",
                )
            )
        return found

    def save_picture(self, path: str | Path) -> None:
        """Strips about the moment, a colour for each unit, PNG."""
        actors = []
        for unit, colour in zip(self._chosen(), _COLOURS, strict=False):
            for take in self._top(unit)[:ROWS]:
                shown = self._about(take, self.moment[take, unit])
                label = f"unit {unit + 1}: {_name(self.takes[take])}"
                actors.append(Actor(shown, PARENTS, label, colour))
        save_figure(strip_figure(actors, self.rate, azimuth=55.0), path)

    def _about(self, take: int, moment: int) -> np.ndarray:
        """`SHOWN` frames about a moment, of a shorter take its last pose held."""
        frames = len(self.local[take])
        start = int(np.clip(moment - SHOWN // 2, 0, max(frames - SHOWN, 0)))
        return self.local[take][np.minimum(np.arange(start, start + SHOWN), frames - 1)]

    def _top(self, unit: int) -> np.ndarray:
        return np.argsort(-self.highest[:, unit], kind="stable")[:TOP]

    def _chosen(self) -> list[int]:
        """Units that tell takes apart most, each excited by other takes than those before it."""
        chosen, taken = [], set()
        for unit in np.argsort(-self.highest.std(axis=0), kind="stable"):
            first = set(self._top(unit)[:ROWS].tolist())
            if not first & taken:
                chosen.append(int(unit))
                taken |= first
            if len(chosen) == UNITS:
                break
        return chosen


def excited(manifold: MotionManifold, material: Material, seed: int = 0) -> Excited:
    """Find the held-out takes in which each unit of the deepest layer is highest.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        Its labelled testing takes where there are any, else all of them.
    seed : int
        Of the untrained network, of the takes drawn at random and of the resampling.

    Raises
    ------
    ValueError
        If fewer than `TOP` takes are held out.
    """
    takes = [take for take in material.testing if take.content] or material.testing
    if len(takes) < TOP:
        raise ValueError(f"excited needs {TOP} held-out takes, there are {len(takes)}")
    clips = [manifold.features(take.positions)[0] for take in takes]
    highest, moment = _highest(manifold, clips)
    before, _ = _highest(untrained(manifold, seed), clips)
    drawn = np.random.default_rng(seed).random(highest.shape)
    agreement = {
        label: {
            name: _agreement(each, [getattr(take, label) for take in takes])
            for name, each in (
                ("trained", highest), ("untrained", before), ("drawn at random", drawn))
        }
        for label in ("content", "style")
    }  # fmt: skip
    local = [clip[:, POSITIONS].reshape(len(clip), -1, 3) for clip in clips]
    return Excited(highest, moment, takes, local, agreement, manifold.rate, seed)


def _highest(
    manifold: MotionManifold, clips: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """The largest value of each unit in each clip, and the middle frame of its hidden frame."""
    units = [hidden_units(manifold, clip) for clip in clips]
    wide = manifold.network.frames_per_unit
    place = np.array([each.argmax(axis=0) for each in units])
    return np.array([each.max(axis=0) for each in units]), place * wide + wide // 2


def _agreement(highest: np.ndarray, labels: Sequence[str]) -> np.ndarray:
    """The share of the commonest label among the top takes of each unit."""
    tops = np.argsort(-highest, axis=0, kind="stable")[:TOP].T
    common = [Counter(labels[take] for take in top).most_common(1)[0][1] for top in tops]
    return np.array(common) / TOP


def _name(take: LabelledTake) -> str:
    return f"{take.content}, {take.style}" if take.content else take.path.stem
