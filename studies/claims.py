"""Every statement of both papers that can be measured, in one table.

    python -m studies claims --quick
    python -m studies claims --data bandai --test '*_005.bvh' --paper paper.npz --best best.npz

holden2015 is judged with the network and the schedule of the paper, trained on takes of the source
that is measured, and with that of `--recipe best`, each beside the strongest simple opponent. A
network without a file is trained first. Without --data the takes are synthetic. jang2018 is judged
by `python -m studies sequences`, with fewer minutes and steps. --quick has fewer of all.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from data_synth import plan_takes, write_series
from numpy_cae.errors import NumpyCaeError
from numpy_cae.manifold import MotionManifold, learn_manifold, load_manifold
from numpy_cae.training import SEQUENCE_RECIPES, TrainingState, recipe
from studies import depth, sequences
from studies.jang2018.actions import ACTIONS, synthetic_action
from studies.shared.material import Material, read_material
from studies.shared.messages import note
from studies.shared.options import parameters
from studies.shared.result import STATEMENTS, Claim, Result, Table

STUDIES = "representation sampling repair_sweep kinect filling_in interpolation comparison".split()
"""Those of a manifold, in the order of holden2015."""
RATE = 30.0
MINUTES, QUICK_MINUTES = 20.0, 8.0
"""Of the synthetic takes, every fifth of which is measured."""
SEQUENCES = {False: (15.0, 1000), True: (4.0, 200)}
"""Minutes of each action of jang2018 and steps of training, without --quick and with it."""
DEPTH_EPOCHS = 2
"""DEPTH_EPOCHS: those of `depth` with --quick."""
PAPER = "the paper's"
BEST = "best"
BOTH = ""
HEADER = ("statement", "network", "measured", "strongest simple opponent", "confirmed")
Judged = list[tuple[str, Claim]]
"""The network that was judged, and a claim."""


def run(
    material: Material | None = None,
    seed: int = 0,
    paper: Path | None = None,
    best: Path | None = None,
    quick: bool = False,
    progress: Callable[[TrainingState], None] | None = None,
) -> Result:
    """Judge all statements. A study that this source has no takes for is left out and noted."""
    with TemporaryDirectory() as folder:
        if material is None:
            material = _synthetic(Path(folder), QUICK_MINUTES if quick else MINUTES, seed)
        judged = _holden2015(material, seed, {PAPER: paper, BEST: best}, progress)
    epochs = DEPTH_EPOCHS if quick else depth.EPOCHS
    deep = {"material": material, "seed": seed, "epochs": epochs}
    judged += [(BOTH, claim) for claim in _claims("depth", deep)]
    judged += [(BOTH, claim) for claim in _jang2018(quick, seed).claims]
    judged.sort(key=lambda pair: list(STATEMENTS).index(pair[1].key))
    rows = [_row(network, claim) for network, claim in judged]
    caption = "Statements of both papers and of this project's tests of them:"
    claims = [replace(each, of=", ".join(filter(None, (n, each.of)))) for n, each in judged]
    return Result("Statements of both papers", [Table(caption, HEADER, rows)], claims)


def _synthetic(folder: Path, minutes: float, seed: int) -> Material:
    """Synthetic takes in files, every fifth for testing."""
    plans = plan_takes(minutes, seed)
    note(f"{len(plans)} takes are made")
    write_series(plans, folder, rate=RATE)
    return read_material([folder], [f"{plan.name}.bvh" for plan in plans[4::5]])


def _holden2015(
    material: Material, seed: int, files: dict[str, Path | None], progress: Callable | None
) -> Judged:
    judged: Judged = []
    for name, path in files.items():
        manifold = load_manifold(path) if path else _trained(material, name, seed, progress)
        for study in STUDIES:
            given = {"manifold": manifold, "material": material, "seed": seed}
            judged += [(name, claim) for claim in _claims(study, given)]
    return judged


def _trained(material: Material, name: str, seed: int, progress: Callable | None) -> MotionManifold:
    note(f"the network is trained: {name}")
    schedule = recipe("paper" if name == PAPER else "best")
    takes = [take.positions for take in material.training]
    return learn_manifold(takes, schedule, seed, report=progress)


def _claims(name: str, given: dict[str, Any]) -> Sequence[Claim]:
    """The claims of a study, or none where the source has no takes for it."""
    note(name)
    run = import_module(f"studies.{name}").run
    try:
        return run(**{each: given[each] for each in parameters(run)}).claims
    except (NumpyCaeError, ValueError, ArithmeticError) as error:
        note(f"{name} could not be run: {error}")
        return []


def _jang2018(quick: bool, seed: int) -> Result:
    minutes, steps = SEQUENCES[quick]
    actions = [synthetic_action(kind, minutes, seed) for kind in ACTIONS]
    schedule = replace(SEQUENCE_RECIPES["fast"], epochs=10, steps=steps // 10)
    return sequences.run(actions, schedule, {}, seed)


def _row(network: str, claim: Claim) -> list[object]:
    verdict = "yes" if claim.confirmed else "no"
    return [claim.statement, network, claim.figures, claim.opponent, verdict]
