"""Typical mistakes, made in answers other than the key, have a name in the report."""

from inspect import getsource

import numpy as np
import pytest

from numpy_cae.course.catalogue import CATALOGUE, EXERCISES
from numpy_cae.verify.operations.counterexample import failing_case
from numpy_cae.verify.operations.trial import try_property
from tools.right_answers import RIGHT_ANSWERS

UP = "range(len(layers) - 1, -1, -1)"
FORWARD = "for i in range(len(layers))"
MISTAKES = [
    (
        ("encode_layer", 0, "The pullbacks are not called in the reverse order"),
        {"back_a(back_p(dy * (1 - y * y)))": "(1 - y**2) * back_p(back_a(dy))"},
    ),
    (
        ("encode_layer", 1, "The pullbacks are not called in the reverse order"),
        {"back_t(back_p(dy))": "dy", "back_a(da)": "back_p(back_a(back_t(da)))"},
    ),
    (
        ("encode_layer", 0, "Pooling is missing"),
        {"p, back_p = max_pool(a)": "p, back_p = a, lambda d: d"},
    ),
    (
        ("project_layer", 1, "The gradient for b from encoding is subtracted"),
        {"np.add(h[2], g[2])": "np.subtract(g[2], h[2])"},
    ),
    (
        ("train_layer", 0, "The first epoch has the rate itself"),
        {"decay**epoch": "decay**(epoch + 1)"},
    ),
    (
        ("train_layer", 0, "weights has those from before each epoch"),
        {
            "        weights.append((w, b))\n": "",
            "        total = []": "        weights.append((w, b))\n        total = []",
        },
    ),
    (
        ("stack_loss", 0, "Decoding begins with the lowest layer"),
        {
            f"in {UP}": "in range(len(layers))",
            f"{FORWARD}:\n        d, dw[i]": f"for i in {UP}:\n        d, dw[i]",
        },
    ),
    (
        ("stack_loss", 0, "The gradients of decoding are added to the wrong layers"),
        {
            "d, dw[i], db[i] = downs[i](d)": "d, dw[-1 - i], db[-1 - i] = downs[i](d)",
            "back(), {}, {}": "back(), [0] * len(layers), [0] * len(layers)",
        },
    ),
    (
        ("frames_seen", 1, "It is K doubled for each layer but one"),
        {"2**layers + (taps - 1) * (2**layers - 1)": "taps * 2 ** (layers - 1)"},
    ),
    (
        ("adam_step", 0, "The steps are counted from 0 in the correction"),
        {"**step)": "**(step + 1))"},
    ),
    (
        ("adam_step", 0, "The correction divides by 1 - β^(step - 1)"),
        {
            "(1 - b1**step)": "np.subtract(1, b1**(step - 1))",
            "(1 - b2**step)": "np.subtract(1, b2**(step - 1))",
        },
    ),
    (
        ("complete", 0, "What the projection misses is added at the known values alone"),
        {"interpolate(x - p, known)": "np.where(known, x - p, 0)"},
    ),
    (
        ("read_clips", 0, "z is made of the mean of the states"),
        {"z = y[:, -1] @": "z = y.mean(axis=1) @"},
    ),
    (
        ("to_features", 1, "The velocity is in metres a second"),
        {"-theta[:-1])[:, 0][:, ::2]": "-theta[:-1])[:, 0][:, ::2] * 30"},
    ),
]


def wrong_answer(name: str, number: int, replacements: dict[str, str]):
    """A right answer in which pieces of the text are replaced."""
    source = getsource(getattr(RIGHT_ANSWERS[number], name))
    for old, new in replacements.items():
        assert old in source, old
        source = source.replace(old, new)
    space = {"np": np, **{key: exercise.solution for key, exercise in CATALOGUE.items()}}
    exec(source, space)
    return space[name]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # one divides by 0
@pytest.mark.parametrize(("answer", "replacements"), MISTAKES, ids=[m[0][2][:40] for m in MISTAKES])
def test_a_typical_mistake_is_named(answer, replacements):
    name, number, sentence = answer
    function = wrong_answer(name, number, replacements)
    for stated in EXERCISES[name].properties:
        if failing_case(stated, function) is not None:
            outcome = try_property(stated, function)
            assert outcome.mistake.startswith(sentence), f"{outcome.problem}: {outcome.mistake}"
            return
    raise AssertionError("it holds")


def test_an_unknown_mistake_is_told_with_few_calls(monkeypatch):
    calls = []

    def stack_loss(x, corrupted, layers, bound):
        calls.append(1)
        loss, gradients = EXERCISES["stack_loss"].solution(x, corrupted, layers, bound)
        return loss + 0.1, gradients

    stated = EXERCISES["stack_loss"].properties[0]
    try_property(stated, EXERCISES["stack_loss"].solution)
    try_property(stated, stack_loss)
    assert len(calls) < 3 * len(stated.cases())
