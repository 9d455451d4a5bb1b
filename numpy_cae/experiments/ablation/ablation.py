"""Train and measure every row of the ablation, from several seeds.

"We also wish to thoroughly evaluate our work against alternative methods and justify the
effectiveness of using a deep architecture" (holden2015, section 7). A seed sets the first weights,
the order, the corruption and the lost values of the test, equally for all rows, so that rows are
compared seed by seed.
"""

import json
import zlib
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.experiments.ablation.baselines import baselines
from numpy_cae.experiments.ablation.choices import SEEDS, Choice
from numpy_cae.experiments.ablation.evaluation import Evaluation, Measured
from numpy_cae.experiments.ablation.result import Row
from numpy_cae.training import DivergedError, train_autoencoder


def measure_rows(
    evaluation: Evaluation,
    choices: Sequence[Choice],
    seeds: int = SEEDS,
    cache: Path | None = None,
    progress: Callable[[str], None] = lambda line: None,
) -> list[Row]:
    """Train and measure every choice and every baseline, all of them from one seed after another.

    The paper's choice is the first. Each measurement is saved in the file `cache` as soon as it is
    made; what the file holds for the same windows and the same choice is not measured again.
    `progress` is called with a line of text after each measurement.
    """
    rows, jobs = [], []
    for choice in choices:
        rows.append(Row(choice.name, choice.parameters, choice.latent))
        jobs.append((repr(choice), partial(_train_and_measure, evaluation, choice)))
    for name, repair in baselines(evaluation.split).items():
        rows.append(Row(name))
        jobs.append((name, partial(evaluation.measure, repair)))
    known, data = _read(cache), _checksum(evaluation)
    for seed in range(seeds):
        for row, (job, measure) in zip(rows, jobs, strict=True):
            key = f"{data} seed {seed}: {job}"
            if key not in known:
                known[key] = measure(seed)
                _write(cache, known)
            row.measured.append(known[key])
            last = known[key]
            status = f"half zeroed {last['half_zeroed']:.2f} cm" if last else "diverged"
            progress(f"seed {seed}: {row.name}: {status}")
    return rows


def _train_and_measure(evaluation: Evaluation, choice: Choice, seed: int) -> Measured | None:
    """None where training diverges."""
    rng = np.random.default_rng(seed)
    network = choice.network(rng)
    try:
        train_autoencoder(network, evaluation.windows, choice.schedule, rng, show_progress=False)
    except DivergedError:
        return None
    manifold = evaluation.manifold(network, choice.schedule.fine_tuning.rescaled)
    hidden = network.encode(evaluation.split.testing.x)
    return evaluation.measure(manifold.project_windows, seed, hidden)


def _checksum(evaluation: Evaluation) -> str:
    windows = evaluation.windows, evaluation.split.testing.x
    return "-".join(f"{zlib.crc32(np.ascontiguousarray(x)):08x}" for x in windows)


def _read(cache: Path | None) -> dict[str, Measured | None]:
    if cache is None or not cache.exists():
        return {}
    try:
        return json.loads(cache.read_text(encoding="utf-8"))
    except ValueError:
        raise ValueError(f"{cache} is damaged: remove it to measure again") from None


def _write(cache: Path | None, known: dict[str, Measured | None]) -> None:
    if cache is not None:
        with atomic_write(cache) as beside:
            beside.write_text(json.dumps(known, indent=1), encoding="utf-8")
