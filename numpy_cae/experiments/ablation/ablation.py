"""Is the deep architecture worth it? One table over every choice of holden2015.

"We also wish to thoroughly evaluate our work against alternative methods and justify the
effectiveness of using a deep architecture" (holden2015, section 7). Here that is done on the
same takes, with the same measures (`experiments.evaluation`), from several seeds, each of which
draws the first weights, the order, the corruption and the values that are lost in the test; row by
row the same, so that rows are compared seed by seed.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.experiments.ablation.baselines import BASELINES, baselines
from numpy_cae.experiments.ablation.choices import Choice
from numpy_cae.experiments.ablation.evaluation import Evaluation, Measured
from numpy_cae.experiments.ablation.result import Ablation, Row
from numpy_cae.training import DivergedError, train_autoencoder

SEEDS = 5
Said = Callable[[str], None]


def ablation(
    evaluation: Evaluation,
    chosen: Sequence[Choice],
    seeds: int = SEEDS,
    kept: Path | None = None,
    say: Said = lambda line: None,
) -> Ablation:
    """Train and measure every choice and every baseline, from seeds 0, 1, ….

    All rows of a seed come before those of the next, so that of a run that was cut off whole
    columns are there.

    Parameters
    ----------
    evaluation : Evaluation
    chosen : sequence of Choice
        The paper's first.
    seeds : int
    kept : path, optional
        A file where every measurement is kept as soon as it is made; what it holds of the same
        windows and the same choice is not measured again.
    say : function
        Told of every measurement, in a line.
    """
    memory = _Memory(evaluation, kept)
    methods = baselines(evaluation, chosen[0].latent)
    rows = [Row(each.group, each.name, each.parameters, each.latent) for each in chosen]
    rows += [Row(BASELINES, name) for name in methods]
    jobs = [(repr(each), partial(_trained, evaluation, each)) for each in chosen]
    jobs += [
        (f"{name}, beside {chosen[0].latent}", partial(evaluation.measure, method))
        for name, method in methods.items()
    ]
    for seed in range(seeds):
        for row, (job, measure) in zip(rows, jobs, strict=True):
            row.measured.append(memory.recall(job, seed, measure))
            say(f"seed {seed}: {row.said()}")
    return Ablation(rows, evaluation.split.sample)


def _trained(evaluation: Evaluation, choice: Choice, seed: int) -> Measured | None:
    """None where training diverges."""
    rng = np.random.default_rng(seed)
    network = choice.network(rng)
    try:
        train_autoencoder(network, evaluation.windows, choice.schedule, rng, show_progress=False)
    except DivergedError:
        return None
    rescaled = choice.schedule.fine_tuning.rescaled
    return evaluation.measure(evaluation.of_network(network, rescaled), seed)


@dataclass
class _Memory:
    """Measurements in a JSON file, by what was measured and on which windows."""

    evaluation: Evaluation
    path: Path | None

    def __post_init__(self):
        windows = self.evaluation.windows, self.evaluation.testing.x
        self._of = "-".join(f"{zlib.crc32(np.ascontiguousarray(x)):08x}" for x in windows)
        self._known = {}
        if self.path is not None and self.path.exists():
            try:
                self._known = json.loads(self.path.read_text(encoding="utf-8"))
            except ValueError:
                raise ValueError(f"{self.path} is damaged: remove it to measure anew") from None

    def recall(
        self, name: str, seed: int, measure: Callable[[], Measured | None]
    ) -> Measured | None:
        """What is known, or what `measure` finds."""
        key = f"{self._of} seed {seed}: {name}"
        if key not in self._known:
            found = measure(seed)
            self._known[key] = found and asdict(found)
            if self.path is not None:
                with atomic_write(self.path) as beside:
                    beside.write_text(json.dumps(self._known, indent=1), encoding="utf-8")
        known = self._known[key]
        return Measured(**known) if known else None
