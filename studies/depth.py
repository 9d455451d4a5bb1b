"""Are a deep stack and filters over time justified? holden2015, sections 7 and 8.

    python -m studies depth --data bandai --test '*_005.bvh'

"We also wish to […] justify the effectiveness of using a deep architecture." Stacks of 1, 2 and 3
layers, each with as many hidden numbers, are trained by the paper's schedule with fewer epochs and
with Adam on all layers at once, three seeds of each.

"The position of a single joint is not just linked to the position of other joints in the same
pose - but to the position of other joints in separate frames." A stack of three layers whose
filters have one frame instead of 15 is trained with Adam. A linear map of 15 frames, and a Gaussian
of 15 frames that is given the mask, are the simplest manifolds that link joints in other frames.
"""

import numpy as np

from numpy_cae.evaluation.tables import GAUSSIAN, LINEAR
from numpy_cae.training import recipe
from studies.shared.judging import all_of, seeds_below
from studies.shared.material import Material
from studies.shared.result import Claim, Result, Table
from studies.shared.small_networks import (
    EPOCHS,
    FILTERS,
    SEEDS,
    Errors,
    SmallNetworks,
    mean_and_range,
)
from studies.shared.trained import Trainer
from studies.training_choices import shortened

ADAM_EPOCHS = 3
"""With Adam all layers learn at once, for this many times as many epochs."""
SGD = "the paper's schedule"
ADAM = "Adam"
ONE_FRAME = "Adam, filters of one frame"


def run(
    material: Material,
    seed: int = 0,
    trainer: Trainer | None = None,
    epochs: int = EPOCHS,
    seeds: int = SEEDS,
) -> Result:
    """Train the stacks on the training takes, and repair the test takes with each."""
    networks = SmallNetworks.of(material, trainer, seed, seeds)
    schedules = {
        SGD: shortened(recipe("paper"), epochs),
        ADAM: shortened(recipe("fast"), ADAM_EPOCHS * epochs),
    }
    errors: dict[str, list[Errors]] = {}
    for name, schedule in schedules.items():
        for layers in range(1, len(FILTERS) + 1):
            manifolds = networks.learn(schedule, filters=FILTERS[:layers])
            errors[_named(name, layers)] = networks.errors(manifolds)
    of_one_frame = networks.learn(schedules[ADAM], taps=1)
    errors[ONE_FRAME] = networks.errors(of_one_frame)
    completions = {
        DEEP: networks.completion_errors(networks.learn(schedules[ADAM])),
        ONE_FRAME: networks.completion_errors(of_one_frame),
    }
    rows: list[list[object]] = []
    for name, of_seeds in errors.items():
        columns = [mean_and_range(column) for column in zip(*of_seeds, strict=True)]
        completed = mean_and_range(completions[name]) if name in completions else None
        rows.append([name, *columns, completed])
    linear = networks.error_of_linear_map()
    gaussian = networks.error_of_gaussian()
    rows.append([LINEAR, None, f"{linear:.3f}", None])
    rows.append([GAUSSIAN, None, None, f"{gaussian:.3f}"])
    caption = f"{epochs} epochs of each stage, mean of {seeds} seeds ± half of the range:"
    table = Table(caption, ["stack", *Errors.HEADER, "half removed, mask given, cm"], rows)
    claims = [
        _claim_of_depth(errors, linear),
        _claim_of_time(errors, completions, linear, gaussian),
    ]
    return Result("Depth of the stack, and filters over time", [table], claims)


def _named(schedule: str, layers: int) -> str:
    return f"{schedule}, {layers} of {len(FILTERS)} layers"


DEEP = _named(ADAM, len(FILTERS))


def _claim_of_depth(errors: dict[str, list[Errors]], linear: float) -> Claim:
    """Whether three layers repair better than two and one, by both schedules."""
    fulfilled = []
    figures = []
    for schedule in (SGD, ADAM):
        repairs = []
        for layers in range(1, len(FILTERS) + 1):
            repairs.append([of_seed.repair for of_seed in errors[_named(schedule, layers)]])
        first, second, third = repairs
        fulfilled += [seeds_below(third, first), seeds_below(third, second)]
        listed = ", ".join(f"{np.mean(of_layers):.2f}" for of_layers in repairs)
        figures.append(f"{schedule}: one, two and three layers {listed} cm")
    return Claim(
        "deep_justified",
        all_of(*fulfilled),
        f"half removed, {'; '.join(figures)};",
        opponent=f"{LINEAR} {linear:.2f} cm.",
    )


def _claim_of_time(
    errors: dict[str, list[Errors]],
    completions: dict[str, list[float]],
    linear: float,
    gaussian: float,
) -> Claim:
    """Whether filters of 15 frames have a lower error than filters of one frame, as the simplest
    methods that look at 15 frames may have too."""
    names = (DEEP, ONE_FRAME)
    repair = [[of_seed.repair for of_seed in errors[name]] for name in names]
    completion = [completions[name] for name in names]
    is_as_good = linear < min(repair[1]) and gaussian < min(completion[1])
    return Claim(
        "temporal_filters",
        all_of(seeds_below(*repair), seeds_below(*completion)),
        f"half removed, {mean_and_range(repair[0])} cm, "
        f"mask given {mean_and_range(completion[0])};",
        opponent=f"filters of one frame {mean_and_range(repair[1])} cm, "
        f"{mean_and_range(completion[1])}; {LINEAR} {linear:.3f} cm, {GAUSSIAN} {gaussian:.3f}.",
        fulfilled_by=f"{LINEAR} and {GAUSSIAN}" if is_as_good else "",
    )
