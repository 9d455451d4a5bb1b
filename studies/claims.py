"""Every statement of both papers that can be measured, in one table.

    python -m studies claims --quick
    python -m studies claims --data bandai --test '*_005.bvh' -o claims

Each statement has a rule, opponents, takes, seeds and a spread, which are written in
`studies/shared/statements.json` before they are measured. holden2015 is judged with the network and
the schedule of the paper, trained on takes of the source that is measured, and with that of
`--recipe best`, some seeds of each; choices of training and depth with smaller networks; press-ups
with a network that learned press-ups. Networks are kept in the folder of --cache; --network judges
that of a file alone. Without --data the takes are synthetic. jang2018 is judged by the studies
`sequences`, as it is by default, and `sequence_choices`; each paper takes most of an hour of
processor time, and --papers names one. --quick has fewer of all: one network of `--recipe fast`,
one seed, few takes and steps; it shows that every statement can be judged, in about two minutes
of processor time, and its verdicts say little.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from data_synth import KINDS, plan_takes, write_series
from numpy_cae.manifold import MotionManifold, load_manifold
from numpy_cae.training import SEQUENCE_RECIPES, recipe
from studies import interpolation, sequence_choices, sequences
from studies.jang2018.actions import ACTIONS, synthetic_action
from studies.jang2018.samples import REPEATS
from studies.jang2018.training import CURVE_POINTS
from studies.shared.judging import agreed
from studies.shared.material import Material, evenly, read_material
from studies.shared.messages import note
from studies.shared.result import STATEMENTS, VERDICTS, Claim, Result, Table
from studies.shared.trained import Trainer
from studies.training_choices import shortened

STUDIES: dict[str, dict[str, Any]] = {
    "kinds_of_motion": {},
    "representation": {},
    "sampling": {},
    "repair_sweep": {"shares": (0.5,)},
    "kinect": {},
    "wrist": {},
    "stepped_keys": {},
    "interpolation": {},
    "comparison": {},
}
"""Studies of a manifold, in the order of holden2015, and their own arguments."""
WITH_MOTION = ("kinds_of_motion", "repair_sweep")
"""Those of which much needs no network: `measure_motion` is run once, `judge` with each network."""
SMALL_STUDIES = ("training_choices", "depth", "scaling")
"""Studies that train smaller networks themselves."""
RATE = 30.0
SEEDS = 3
MINUTES = {False: 20.0, True: 4.0}
"""Minutes of the synthetic takes, every fifth of which is measured, and with --quick."""
PRESS_UP_MINUTES = {False: 20.0, True: 2.0}
"""Minutes of the synthetic takes with press-ups, and with --quick."""
PRESS_UPS = ("press_ups", "walk", "confident_walk")
"""Kinds of the takes from which the network of press-ups learns."""
SEQUENCE_MINUTES = {False: 30.0, True: 0.5}
"""Minutes of each action of jang2018 to train on, and as many to test on, and with --quick."""
QUICK_ACTIONS = ("walking", "waiting")
"""Actions of jang2018 with --quick: one that repeats itself and one that does not."""
QUICK_STEPS = 20
"""Steps of training of jang2018 with --quick."""
QUICK_POINTS = 2
"""Points of the curve of a training of jang2018 with --quick."""
QUICK_REPEATS = 1
"""Measurements of a discrepancy with --quick."""
QUICK_CHOICES: dict[str, Any] = {"steps": 10, "minutes": 0.5, "names": QUICK_ACTIONS}
"""Steps, minutes and actions of the choices of jang2018 with --quick."""
HOLDEN2015 = "holden2015"
JANG2018 = "jang2018"
QUICK_EPOCHS = 20
"""Epochs of the network with --quick."""
QUICK_TAKES = 2
QUICK_FRAMES = 160
"""So many test takes are measured with --quick, and so many frames of each, a window; but not by
studies `OF_LABELS`."""
OF_LABELS = ("kinds_of_motion", "interpolation", "comparison")
"""Studies that need test takes of several labels."""
PAPER = "the paper's"
BEST = "best"
QUICK = "fast, few epochs"
BOTH = ""
"""In place of the name of a network, where all networks take part in a claim, or none."""
HEADER = ("statement", "network", "measured", "strongest simple opponent", "verdict", "seeds")


@dataclass(frozen=True)
class JudgedClaim:
    """A claim of each seed, and the network that was judged, such as `PAPER`, or `BOTH`."""

    network: str
    of_seeds: Sequence[Claim]

    def merged(self) -> Claim:
        """The claim of all seeds: undecided where they differ."""
        first = self.of_seeds[0]
        fulfilled = agreed([claim.fulfilled for claim in self.of_seeds])
        also = first.fulfilled_by
        if not all(claim.fulfilled_by for claim in self.of_seeds):
            also = ""
        return replace(first, fulfilled=fulfilled, fulfilled_by=also, seeds=self.seeds())

    def seeds(self) -> str:
        """How many seeds there are, or the verdict of each where they differ."""
        verdicts = [of_seed.verdict for of_seed in self.of_seeds]
        return str(len(verdicts)) if len(set(verdicts)) == 1 else ", ".join(verdicts)

    def row(self) -> list[object]:
        """The row of the table; figures are those of the first seed."""
        claim = self.merged()
        figures = [claim.statement, self.network, claim.figures, claim.opponent]
        return [*figures, claim.verdict, claim.seeds]

    def named(self) -> Claim:
        """The claim, which says of which network it is."""
        claim = self.merged()
        subjects = [subject for subject in (self.network, claim.of) if subject]
        return replace(claim, of=", ".join(subjects))


def run(
    material: Material | None = None,
    seed: int = 0,
    trainer: Trainer | None = None,
    network: Path | None = None,
    quick: bool = False,
    seeds: int = SEEDS,
    papers: tuple[str, ...] = (HOLDEN2015, JANG2018),
) -> Result:
    """Judge all statements of the papers.

    A study that this source has no takes for is left out, which the note of the result says.
    """
    for paper in papers:
        if paper not in (HOLDEN2015, JANG2018):
            raise ValueError(f"--papers is {paper}, expected {HOLDEN2015} or {JANG2018}")
    notes: list[str] = []
    trainer = trainer or Trainer()
    seeds = 1 if quick else seeds
    judged: list[JudgedClaim] = []
    if HOLDEN2015 in papers:
        judged += judge_holden2015(material, seed, trainer, network, quick, seeds, notes)
    if JANG2018 in papers:
        judged += judge_sequences(seed, trainer, quick, seeds)
    judged = in_order_of_statements(judged)
    caption = "Statements of both papers and of this project's tests of them:"
    table = Table(caption, HEADER, [judged_claim.row() for judged_claim in judged])
    claims = [judged_claim.named() for judged_claim in judged]
    tables = [count_verdicts(claims), table]
    return Result("Statements of both papers", tables, claims, note="\n".join(notes))


def judge_holden2015(
    material: Material | None,
    seed: int,
    trainer: Trainer,
    network: Path | None,
    quick: bool,
    seeds: int,
    notes: list[str],
) -> list[JudgedClaim]:
    """The claims of holden2015."""
    with TemporaryDirectory() as folder:
        if material is None:
            material = make_material(Path(folder), MINUTES[quick], seed)
        judged: list[JudgedClaim] = []
        named = dict(networks_to_judge(material, seed, trainer, network, quick, seeds))
        for study in STUDIES:
            is_few = quick and study not in OF_LABELS
            measured = few_tests(material) if is_few else material
            judged += judge_networks(study, named, measured, notes)
        judged = keep_once(judged)
        judged += judge_small_networks(material, seed, trainer, quick, notes)
        if not has_press_ups(material):
            judged += judge_press_ups(Path(folder) / "press_ups", seed, trainer, quick)
    return judged


def keep_once(judged: Sequence[JudgedClaim]) -> list[JudgedClaim]:
    """The claims; one of a statement that says nothing of a network is listed once, not for each
    network."""
    kept = []
    listed = set()
    for judged_claim in judged:
        claim = judged_claim.of_seeds[0]
        if not STATEMENTS[claim.key].get("without network"):
            kept.append(judged_claim)
        elif (claim.key, claim.of) not in listed:
            kept.append(JudgedClaim(BOTH, [claim]))
            listed.add((claim.key, claim.of))
    return kept


def count_verdicts(claims: Sequence[Claim]) -> Table:
    """How many claims have each verdict."""
    rows = []
    for verdict, meaning in VERDICTS.items():
        rows.append([verdict, sum(claim.verdict == verdict for claim in claims), meaning])
    return Table("Verdicts:", ["verdict", "claims", "meaning"], rows)


def in_order_of_statements(judged: list[JudgedClaim]) -> list[JudgedClaim]:
    """The claims of each statement together, the statements in the order of `STATEMENTS`."""
    ordered = []
    for key in STATEMENTS:
        ordered += [claim for claim in judged if claim.of_seeds[0].key == key]
    return ordered


def make_material(
    folder: Path, minutes: float, seed: int, motion_kinds: Sequence[str] = KINDS
) -> Material:
    """Synthetic takes in files, for testing every fifth; of few kinds every fifth of each, from the
    first on, so that each kind is tested."""
    plans = plan_takes(minutes, seed, motion_kinds)
    note(f"{len(plans)} takes are made")
    write_series(plans, folder, rate=RATE)
    testing = plans[4::5]
    if len(motion_kinds) < len(KINDS):
        testing = []
        for kind in motion_kinds:
            testing += [plan for plan in plans if plan.kind == kind][::5]
    return read_material([folder], [f"{plan.name}.bvh" for plan in testing])


def networks_to_judge(
    material: Material,
    seed: int,
    trainer: Trainer,
    network: Path | None,
    quick: bool,
    seeds: int,
) -> Iterator[tuple[str, list[MotionManifold]]]:
    """Name of each network that is judged, and those of its seeds: that of the file, or those of
    the recipes, trained first unless they are kept."""
    if network is not None:
        manifold = load_manifold(network)
        if not isinstance(manifold, MotionManifold):
            raise ValueError(f"{network}: not a convolutional, but a sequential manifold")
        yield network.stem, [manifold]
        return
    schedules = {PAPER: recipe("paper"), BEST: recipe("best")}
    if quick:
        schedules = {QUICK: shortened(recipe("fast"), QUICK_EPOCHS)}
    takes = [take.positions for take in material.training]
    for name, schedule in schedules.items():
        networks = []
        for number in range(seed, seed + seeds):
            note(f"the network is trained or read: {name}, seed {number}")
            networks.append(trainer.learn(takes, schedule, number))
        yield name, networks


def judge_networks(
    study: str,
    named: Mapping[str, Sequence[MotionManifold]],
    material: Material,
    notes: list[str],
) -> list[JudgedClaim]:
    """The claims of a study of a manifold, of each network by name, with those of all its seeds."""
    first, *_ = next(iter(named.values()))
    run_study = study_of_networks(study, first, material)
    judged = []
    for name, networks in named.items():
        of_networks = []
        for number, manifold in enumerate(networks):
            note(f"{study}, {name}, network {number + 1} of {len(networks)}")
            claims = run_if_possible(run_study, f"{study}, {name}", notes, manifold=manifold)
            if claims:
                of_networks.append(claims)
        for of_claim in zip(*of_networks, strict=True):
            judged.append(JudgedClaim(name, of_claim))
    return judged


def study_of_networks(
    study: str, first: MotionManifold, material: Material
) -> Callable[..., Result]:
    """The study of this material with its own arguments, as a function of the manifold.

    What needs no network is measured once, with the features of the first one: all networks that
    are judged together learned from the same takes.
    """
    module = import_module(f"studies.{study}")
    if study not in WITH_MOTION:
        return partial(module.run, material=material, **STUDIES[study])
    measure_once = cache(partial(module.measure_motion, first, material, **STUDIES[study]))
    return lambda manifold: module.judge(manifold, material, measure_once())


def run_if_possible(
    run_study: Callable[..., Result], name: str, notes: list[str], **arguments: Any
) -> list[Claim]:
    """The claims of a study; none where it cannot be run, which a note then says."""
    try:
        return list(run_study(**arguments).claims)
    except ValueError as error:
        text = f"{name}: could not be run: {error}."
        if text not in notes:
            notes.append(text)
        note(text)
        return []


def judge_small_networks(
    material: Material, seed: int, trainer: Trainer, quick: bool, notes: list[str]
) -> list[JudgedClaim]:
    """The claims of the studies that train smaller networks themselves."""
    judged = []
    for study in SMALL_STUDIES:
        note(study)
        arguments: dict[str, Any] = {"material": material, "seed": seed, "trainer": trainer}
        if quick:
            arguments |= {"material": few_tests(material), "epochs": 1, "seeds": 1}
        claims = run_if_possible(import_module(f"studies.{study}").run, study, notes, **arguments)
        judged += [JudgedClaim(BOTH, [claim]) for claim in claims]
    return judged


def few_tests(material: Material) -> Material:
    """The material with the first `QUICK_FRAMES` of `QUICK_TAKES` test takes."""
    testing = []
    for take in evenly(material.testing, QUICK_TAKES):
        testing.append(replace(take, positions=take.positions[:QUICK_FRAMES]))
    return replace(material, testing=testing)


def has_press_ups(material: Material) -> bool:
    """Whether there are press-ups to test with."""
    return any("press_up" in take.content for take in material.testing)


def judge_press_ups(folder: Path, seed: int, trainer: Trainer, quick: bool) -> list[JudgedClaim]:
    """The claims of the interpolation of press-ups and a walk, by a network that learned them from
    synthetic takes."""
    note("interpolation of press-ups")
    material = make_material(folder, PRESS_UP_MINUTES[quick], seed, PRESS_UPS)
    takes = [take.positions for take in material.training]
    schedule = recipe("fast")
    if quick:
        schedule = shortened(schedule, QUICK_EPOCHS)
    manifold = trainer.learn(takes, schedule, seed)
    judged = []
    for claim in interpolation.run(manifold, material).claims:
        if claim.of == interpolation.PRESS_UPS:
            judged.append(JudgedClaim("fast, synthetic", [claim]))
    return judged


def judge_sequences(seed: int, trainer: Trainer, quick: bool, seeds: int) -> list[JudgedClaim]:
    """The claims of jang2018 on synthetic actions."""
    schedule = SEQUENCE_RECIPES["fast"]
    points = CURVE_POINTS
    repeats = REPEATS
    names = QUICK_ACTIONS if quick else ACTIONS
    if quick:
        schedule = replace(schedule, epochs=10, steps=QUICK_STEPS // 10)
        points = QUICK_POINTS
        repeats = QUICK_REPEATS
    of_seeds = []
    for number in range(seed, seed + seeds):
        note(f"sequences, seed {number}")
        actions = [synthetic_action(kind, SEQUENCE_MINUTES[quick], number) for kind in names]
        result = sequences.run(actions, schedule, {}, number, trainer, points, repeats)
        of_seeds.append(result.claims)
    judged = [JudgedClaim(BOTH, of_claim) for of_claim in zip(*of_seeds, strict=True)]
    choices = sequence_choices.run(seed, seeds, **(QUICK_CHOICES if quick else {}))
    return judged + [JudgedClaim(BOTH, [claim]) for claim in choices.claims]
