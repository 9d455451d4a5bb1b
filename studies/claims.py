"""Every statement of both papers that can be measured, in one table.

    python -m studies claims --quick
    python -m studies claims --data bandai --test '*_005.bvh' --paper paper.npz --best best.npz

holden2015 is judged with the network and the schedule of the paper, trained on takes of the source
that is measured, and with that of `--recipe best`, each beside the strongest simple opponent. A
network without a file is trained first. Without --data the takes are synthetic. jang2018 is judged
by `python -m studies sequences`, with fewer minutes and steps. --quick has fewer of all.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory

from data_synth import plan_takes, write_series
from numpy_cae.manifold import MotionManifold, learn_manifold, load_manifold
from numpy_cae.training import SEQUENCE_RECIPES, TrainingState, recipe
from studies import depth, sequences
from studies.jang2018.actions import ACTIONS, synthetic_action
from studies.shared.material import Material, read_material
from studies.shared.messages import note
from studies.shared.result import STATEMENTS, Claim, Result, Table

STUDIES = "representation sampling repair_sweep kinect filling_in interpolation comparison".split()
"""Those of a manifold, in the order of holden2015."""
RATE = 30.0
MINUTES = 20.0
"""Of the synthetic takes, every fifth of which is measured."""
QUICK_MINUTES = 8.0
"""The same with --quick."""
SEQUENCES = {False: (15.0, 1000), True: (4.0, 200)}
"""Minutes of each action of jang2018 and steps of training, without --quick and with it."""
DEPTH_EPOCHS = 2
"""Epochs of the study `depth` with --quick."""
PAPER = "the paper's"
BEST = "best"
BOTH = ""
HEADER = ("statement", "network", "measured", "strongest simple opponent", "verdict")


@dataclass(frozen=True)
class JudgedClaim:
    """A claim, and the network that was judged by it: `PAPER`, `BEST` or `BOTH`."""

    network: str
    claim: Claim

    def row(self) -> list[object]:
        """The row of the table."""
        claim = self.claim
        return [claim.statement, self.network, claim.figures, claim.opponent, claim.verdict]

    def named(self) -> Claim:
        """The claim, which says of which network it is."""
        if not self.network:
            return self.claim
        subjects = [self.network]
        if self.claim.of:
            subjects.append(self.claim.of)
        return replace(self.claim, of=", ".join(subjects))


def run(
    material: Material | None = None,
    seed: int = 0,
    paper: Path | None = None,
    best: Path | None = None,
    quick: bool = False,
    progress: Callable[[TrainingState], None] | None = None,
) -> Result:
    """Judge all statements.

    A study that this source has no takes for is left out, which the note of the result says.
    """
    notes: list[str] = []
    with TemporaryDirectory() as folder:
        if material is None:
            material = make_material(Path(folder), QUICK_MINUTES if quick else MINUTES, seed)
        judged = judge_network(PAPER, paper, material, seed, progress, notes)
        judged += judge_network(BEST, best, material, seed, progress, notes)
        judged += judge_depth(material, seed, quick, notes)
    for claim in judge_sequences(quick, seed).claims:
        judged.append(JudgedClaim(BOTH, claim))
    judged = in_order_of_statements(judged)
    caption = "Statements of both papers and of this project's tests of them:"
    table = Table(caption, HEADER, [judged_claim.row() for judged_claim in judged])
    claims = [judged_claim.named() for judged_claim in judged]
    return Result("Statements of both papers", [table], claims, note="\n".join(notes))


def in_order_of_statements(judged: list[JudgedClaim]) -> list[JudgedClaim]:
    """The claims of each statement together, the statements in the order of `STATEMENTS`."""
    ordered = []
    for key in STATEMENTS:
        ordered += [judged_claim for judged_claim in judged if judged_claim.claim.key == key]
    return ordered


def make_material(folder: Path, minutes: float, seed: int) -> Material:
    """Synthetic takes in files, every fifth for testing."""
    plans = plan_takes(minutes, seed)
    note(f"{len(plans)} takes are made")
    write_series(plans, folder, rate=RATE)
    return read_material([folder], [f"{plan.name}.bvh" for plan in plans[4::5]])


def judge_network(
    name: str,
    path: Path | None,
    material: Material,
    seed: int,
    progress: Callable[[TrainingState], None] | None,
    notes: list[str],
) -> list[JudgedClaim]:
    """The claims of all studies of a manifold: that of a file, or one that is trained first."""
    if path is None:
        manifold = train(name, material, seed, progress)
    else:
        manifold = load_manifold(path)
    judged = []
    for study in STUDIES:
        run_study = import_module(f"studies.{study}").run
        note(study)
        try:
            claims = run_study(manifold=manifold, material=material, seed=seed).claims
        except ValueError as error:
            notes.append(f"{study}, {name}: could not be run: {error}.")
            note(notes[-1])
        else:
            judged += [JudgedClaim(name, claim) for claim in claims]
    return judged


def train(
    name: str, material: Material, seed: int, progress: Callable[[TrainingState], None] | None
) -> MotionManifold:
    """The network that is trained by the recipe of this name on the training takes."""
    note(f"the network is trained: {name}")
    schedule = recipe("paper" if name == PAPER else "best")
    takes = [take.positions for take in material.training]
    return learn_manifold(takes, schedule, seed, report=progress)


def judge_depth(material: Material, seed: int, quick: bool, notes: list[str]) -> list[JudgedClaim]:
    """The claims of the study `depth`, which trains networks of its own."""
    epochs = DEPTH_EPOCHS if quick else depth.EPOCHS
    note("depth")
    try:
        claims = depth.run(material, seed, epochs).claims
    except ValueError as error:
        notes.append(f"depth: could not be run: {error}.")
        note(notes[-1])
        return []
    return [JudgedClaim(BOTH, claim) for claim in claims]


def judge_sequences(quick: bool, seed: int) -> Result:
    """The study of jang2018 on synthetic actions, with fewer minutes and steps."""
    minutes, steps = SEQUENCES[quick]
    actions = [synthetic_action(kind, minutes, seed) for kind in ACTIONS]
    schedule = replace(SEQUENCE_RECIPES["fast"], epochs=10, steps=steps // 10)
    return sequences.run(actions, schedule, {}, seed)
