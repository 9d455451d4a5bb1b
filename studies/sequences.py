"""All results of jang2018: figures 2 and 3, reconstruction, the regulariser.

The network is trained on each action with its regulariser, with MMD instead (`jang2018.mmd`) and
without (λ = 0). Without --data the motions are synthetic, made by `data_synth`. The network writes
a clip in a few numbers. On clips that nothing was trained on it is compared with principal
components of as many numbers, the mean pose, the first pose, and the same network without its
regulariser.
"""

from collections.abc import Sequence
from dataclasses import replace

from numpy_cae.evaluation.tables import (
    BY_PCA,
    NETWORK,
    SQUARED,
    Table,
    compare_reconstructions,
)
from numpy_cae.training import SequenceSchedule
from studies.jang2018 import training
from studies.jang2018.actions import Action
from studies.jang2018.samples import (
    COLOURS,
    MMD,
    NONE,
    REPEATS,
    SLICED,
    figure_3,
    regulariser,
    samples,
)
from studies.jang2018.training import Study, figure_2
from studies.shared.messages import note
from studies.shared.result import Claim, Result, combined
from studies.shared.trained import Trainer

MMD_WEIGHT = 0.1
"""Λ of MMD, as in the authors' later program."""
NOTE = (
    "Synthetic clips are computed by formula (data_synth). The poster trains on Human3.6M, which "
    "may not be redistributed, and states no size, rate, λ or number of steps: those are ours."
)


def run(
    actions: Sequence[Action],
    schedule: SequenceSchedule,
    sizes: dict[str, int],
    seed: int = 0,
    trainer: Trainer | None = None,
    points: int = training.CURVE_POINTS,
    repeats: int = REPEATS,
) -> Result:
    """Train on each action with each regulariser.

    The schedule's weight λ is that of the regulariser. `train_study` is given `seed` and, as
    arguments for the network, `sizes`. The trainer keeps what is trained. The curves have about so
    many points, and a discrepancy is the mean of so many measurements.
    """
    trainer = trainer or Trainer()

    def train(action: Action, weight: float, name: str) -> Study:
        note(f"{action.name}, {name}")
        weighted = replace(schedule, weight=weight)
        mmd = name == MMD
        return training.learn_study(trainer, action, weighted, seed, mmd, points, **sizes)

    weights = {SLICED: schedule.weight, MMD: MMD_WEIGHT, NONE: 0.0}
    trained: dict[str, list[Study]] = {}
    for name, weight in weights.items():
        trained[name] = [train(action, weight, name) for action in actions]
    studies = trained[SLICED]
    parts = [
        figure_2(studies),
        measure_reconstruction(studies, seed),
        samples(studies, seed),
        regulariser(trained, seed, repeats),
    ]
    figures = {}
    for study in studies:
        for source in COLOURS:
            figures[f"{study.action.name}_{source}"] = figure_3(study, seed, source)
    title = "jang2018: Latent Motion Manifold with Sequential Auto-Encoders"
    parts.append(Result("", [], figures=figures))
    provenance = _provenance(studies[0], actions, schedule)
    return replace(combined(title, parts, NOTE), provenance=provenance)


def _provenance(
    study: Study, actions: Sequence[Action], schedule: SequenceSchedule
) -> dict[str, str]:
    model = study.manifold.network
    network = f"{model.hidden} hidden units, {model.latent} latent variables, burn-in of "
    network += f"{model.burn_in} steps, clips of {study.manifold.frames} frames"
    data = {f"data, {action.name}": action.described() for action in actions}
    return data | {"network": network, "schedule": str(schedule), "weight of MMD": str(MMD_WEIGHT)}


def measure_reconstruction(studies: Sequence[Study], seed: int = 0) -> Result:
    """Measure each study's network on its held-out clips; z has one size in all of them."""
    tables = []
    claims = []
    for study in studies:
        action = study.action
        table = compare_reconstructions(
            action.name, study.manifold, action.training, action.testing, seed
        )
        tables.append(table)
        network = table.value(f"{action.name}: {NETWORK}", SQUARED)
        linear = table.value(f"{action.name}: {BY_PCA}", SQUARED)
        latent = study.manifold.network.latent
        figures = f"{network:.3f} of unit variance, PCA with {latent} numbers {linear:.3f}."
        claims.append(Claim("reconstructs", network < linear, figures, action.name))
    rows: list[list] = []
    for table in tables:
        rows += table.rows
    caption = "Reconstruction of held-out clips by the network and by simpler methods:"
    table = Table(caption, tables[0].header, rows, tables[0].formats)
    return Result("Reconstruction", [table], claims)
