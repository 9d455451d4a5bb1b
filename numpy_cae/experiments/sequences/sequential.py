"""All results of jang2018: the trainings that they need, the tables and the pictures."""

from collections.abc import Sequence
from dataclasses import replace

from numpy_cae.experiments.result import Result
from numpy_cae.experiments.sequences.reconstruction import reconstruction
from numpy_cae.experiments.sequences.regulariser import regulariser
from numpy_cae.experiments.sequences.samples import COLOURS, figure_3, samples
from numpy_cae.experiments.sequences.study import Action, figure_2, train_study
from numpy_cae.manifold import SequenceManifold
from numpy_cae.training import SequenceSchedule


def sequential(
    actions: Sequence[Action], schedule: SequenceSchedule, seed: int = 0, **options
) -> tuple[dict[str, Result], dict[str, SequenceManifold]]:
    """Train on each action with the regulariser and without.

    The schedule's weight λ is that of the regulariser; `seed` and `options` are those of
    `learn_sequences`. Returns the results by the names of their picture files, and the manifolds
    trained with the regulariser by action.
    """
    free = replace(schedule, weight=0.0)
    studies = [train_study(action, schedule, seed, **options) for action in actions]
    without = [train_study(action, free, seed, **options) for action in actions]
    results = {
        "figure_2": figure_2(studies),
        "reconstruction": reconstruction(studies, seed),
        "samples": samples(studies, seed),
        "regulariser": regulariser(studies, without, seed),
    }
    for study in studies:
        for source in COLOURS:
            results[f"{study.action.name}_{source}"] = figure_3(study, seed, source)
    return results, {study.action.name: study.manifold for study in studies}
