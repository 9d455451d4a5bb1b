"""Every result of jang2018: the trainings that they need, the tables, the pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequences.actions import Action
from numpy_cae.experiments.sequences.figure_2 import Figure2, figure_2
from numpy_cae.experiments.sequences.figure_3 import COLOURS, FITTED, Figure3, figure_3
from numpy_cae.experiments.sequences.regulariser import Regulariser, regulariser
from numpy_cae.experiments.sequences.long_takes import SequenceLong, long_enough, long_takes
from numpy_cae.experiments.sequences.reconstruction import (
    SequenceReconstruction,
    reconstruction,
)
from numpy_cae.experiments.sequences.samples import SequenceSamples, samples
from numpy_cae.experiments.sequences.study import study
from numpy_cae.experiments.sequences.uses import SequenceUses, uses
from numpy_cae.experiments.sequences.teacher_forcing import (
    TeacherForced,
    TeacherForcing,
    teacher_forcing,
)
from numpy_cae.manifold import SequenceManifold
from numpy_cae.manifold.sequence_learning import HIDDEN, LATENT
from numpy_cae.motion import CLIP
from numpy_cae.training import SequenceSchedule


@dataclass(frozen=True)
class Sequential:
    """All results of some actions."""

    figure_2: Figure2
    reconstruction: SequenceReconstruction
    samples: SequenceSamples
    regulariser: Regulariser
    forcing: TeacherForcing
    figures_3: list[Figure3]
    manifolds: dict[str, SequenceManifold]
    uses: list[SequenceUses]
    long: list[SequenceLong]
    title: str = "jang2018, measured"

    @property
    def tables(self) -> tuple:
        """The results that have a table and findings, in the order in which they are told."""
        return (
            self.figure_2,
            self.reconstruction,
            self.samples,
            self.regulariser,
            self.forcing,
            *self.uses,
            *self.long,
        )

    def text(self) -> str:
        """All tables."""
        return "\n\n".join(f"{result.title}\n\n{result.text()}" for result in self.tables)

    def findings(self) -> list[Finding]:
        """All claims."""
        return [finding for result in self.tables for finding in result.findings()]

    def save_picture(self, path: str | Path) -> None:
        """Figure 2."""
        self.figure_2.save_picture(path)

    def save_pictures(self, folder: str | Path) -> None:
        """Figure 2, and of each action samples and what is made of clips, as strips and moving."""
        folder = Path(folder)
        self.save_picture(folder / "figure_2.png")
        for figure in self.figures_3:
            for source in COLOURS:
                figure.save_picture(folder / f"{figure.action}_{source}.png", source)
            figure.save_gif(folder / f"{figure.action}_{FITTED}.gif")
        for name, results in (("uses", self.uses), ("long", self.long)):
            for result in results:
                result.save_picture(folder / f"{result.action}_{name}.png")
                result.save_gif(folder / f"{result.action}_{name}.gif")


def sequential(
    actions: Sequence[Action],
    schedule: SequenceSchedule | None = None,
    seed: int = 0,
    hidden: int = HIDDEN,
    latent: int = LATENT,
    frames: int = CLIP,
    show_progress: bool = True,
) -> Sequential:
    """Train on each action with the regulariser and without, on the first teacher-forced too.

    Parameters
    ----------
    actions : sequence of Action
    schedule : SequenceSchedule, optional
        Its weight is that of the trainings with the regulariser.
    seed, hidden, latent, frames, show_progress
        As `learn_sequences` takes them.
    """
    schedule = schedule or SequenceSchedule()
    how = {"seed": seed, "hidden": hidden, "latent": latent, "frames": frames}
    how |= {"show_progress": show_progress}
    studies = [study(action, schedule, **how) for action in actions]
    without = [study(action, replace(schedule, weight=0.0), **how) for action in actions]
    forced = study(actions[0], schedule, network=TeacherForced, **how)
    return Sequential(
        figure_2(studies),
        reconstruction(studies, seed),
        samples(studies, seed),
        regulariser(studies, without, seed),
        teacher_forcing(studies[0], forced),
        [figure_3(each, seed) for each in studies],
        {each.action.name: each.manifold for each in studies},
        [uses(each, seed) for each in studies],
        [long_takes(each) for each in studies if long_enough(each)],
    )
