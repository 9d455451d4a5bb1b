"""Known mistakes in the exercises: each is wrong, recognised, and not confused with others."""

from dataclasses import replace
from functools import cache

import pytest

from numpy_cae import course
from numpy_cae.course.catalogue import EXERCISES
from numpy_cae.course.likely_mistakes import diagnose_exercise, patches_of, wrong_function
from numpy_cae.course.suspects import SUSPECTS, Suspect
from numpy_cae.verify.grading.report import report
from numpy_cae.verify.operations.counterexample import failing_case
from numpy_cae.verify.operations.operation_catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.operations.patch import bugs_of

OWN = [name for name in EXERCISES if name not in {*OPERATIONS, "accuse"}]
SAME_VALUE = {("rescale", "naive")}  # the first property that fails does not tell it from another


@pytest.mark.parametrize("name", OWN)
def test_every_known_mistake_is_wrong_in_the_property_that_it_names(name):
    stated = {prop.name: prop for prop in EXERCISES[name].properties}
    assert len(patches_of(name)) >= 3
    for patch in patches_of(name):
        wrong = wrong_function(patch, EXERCISES[name].solution)
        assert failing_case(stated[patch.caught_by], wrong) is not None, patch.name
    same = replace(patch, replacements=()).applied_to(EXERCISES[name].solution)
    for caught_by in {patch.caught_by for patch in patches_of(name)}:
        assert failing_case(replace(stated[caught_by], examples=2), same) is None, caught_by


@pytest.mark.lessons
@pytest.mark.parametrize("name", OWN)
def test_every_known_mistake_is_recognised(name):
    exercise = EXERCISES[name]
    property_named = {prop.name: prop for prop in exercise.properties}
    diagnose = diagnose_exercise(exercise)
    for patch in patches_of(name):
        wrong = wrong_function(patch, exercise.solution)
        named = diagnose(property_named[patch.caught_by], wrong)
        assert named == patch.sentence or (name, patch.name) in SAME_VALUE, (patch.name, named)


def test_a_mistake_is_named_and_two_at_once_are_not():
    def speeds(positions, rate):
        return ((positions[1:] - positions[:-1]) ** 2).sum(axis=-1)  # no root, no rate

    assert course.report("speeds", speeds).outcomes[0].mistake == ""
    rooted = course.report("speeds", lambda positions, rate: speeds(positions, rate) ** 0.5)
    assert "likely:   The distance is not multiplied by the frames a second." in str(rooted)
    assert all(bugs_of(name) for name in EXERCISES if name in OPERATIONS)


@pytest.mark.parametrize(
    ("name", "of_gradients", "said"),
    [
        ("conv1d", lambda dx, dw, db: (dw, dx, db), "The gradient for x is returned as that for w"),
        ("encode_layer", lambda dx, dw, db: (dw, dx, db), "the order is x, w, b."),
        ("encode_layer", lambda dx, dw, db: (dx, dw[::-1], db), "expected: [[["),
        ("conv1d", lambda *gradients: None, "the pullback returns None: is a return missing?"),
    ],
)
def test_gradients_in_another_order_and_a_missing_return_are_named(name, of_gradients, said):
    def changed(*arguments):
        value, pullback = EXERCISES[name].solution(*arguments)
        return value, lambda dy: of_gradients(*pullback(dy))

    few = tuple(replace(p, examples=4) for p in EXERCISES[name].properties[:3])
    first = replace(EXERCISES[name], properties=few)
    assert said in " ".join(str(report(first, changed)).split())


@pytest.mark.parametrize("answer", ["special inputs", "gradient for x", "value", "purity", None])
def test_no_answer_is_right_for_every_suspect(answer, monkeypatch):
    monkeypatch.setattr(Suspect, "objection", cache(Suspect.objection))  # for all cases and twice
    accused = course.report("accuse", lambda suspect: answer)
    assert accused.points <= 3
    verdicts = [suspect.verdict(answer) for suspect in SUSPECTS]
    assert sum(verdict.startswith("not yet: ") for verdict in verdicts) >= 5
    assert not hasattr(SUSPECTS[0], "caught_by")
    assert "tried" not in str(accused) and SUSPECTS[5].objection("purity") == ""
