"""The reply of the process that tests one function: outcomes as JSON, and outcomes again."""

from collections.abc import Sequence

from numpy_cae.verify.grading.report import Report, readable
from numpy_cae.verify.operations.catalogue import Exercise, in_other_conventions
from numpy_cae.verify.operations.property import Outcome, Property

TEXTS = ("problem", "counterexample", "mistake", "kind")


def reply_of(followed: Exercise, outcomes: Sequence[Outcome]) -> dict:
    """The outcomes in plain dicts, lists and texts, and the warnings of the function."""
    notes = dict.fromkeys(note for outcome in outcomes for note in outcome.notes)
    made = [_as_dict(outcome) for outcome in outcomes]
    return {"convention": followed.convention, "outcomes": made, "notes": list(notes)}


def _as_dict(outcome: Outcome) -> dict:
    return {name: getattr(outcome, name) for name in ("held", *TEXTS)}


def report_of(exercise: Exercise, called: str, reply: dict) -> Report:
    """The report from a reply of `reply_of`, or one that says why there is no such reply.

    If the process was ended, the outcomes until then count. Names, statements and points are not
    taken from the reply.
    """
    try:
        problem = readable(reply.get("failed", ""))
        if "outcomes" in reply or not problem:
            every = (exercise, *in_other_conventions(exercise))
            (followed,) = (one for one in every if one.convention == reply["convention"])
            both = zip(followed.properties, reply["outcomes"], strict=not problem)
            outcomes = [
                Outcome(stated, one["held"] is True, *(readable(one[name]) for name in TEXTS))
                for stated, one in both
            ]
            if problem:
                outcomes += _ended(followed.properties[len(outcomes) :], problem, reply["trying"])
            return Report(followed, called, tuple(outcomes))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        problem = f"its process sent no reply: {error}"
    return Report(exercise, called, tuple(Outcome(p, False, problem) for p in exercise.properties))


def _ended(left: Sequence[Property], problem: str, trying: str) -> list[Outcome]:
    """The outcomes of the properties that were left when the process ended."""
    what = f"{problem}\nit was tried with {readable(trying)}; smaller cases were right"
    first, *others = left
    return [Outcome(first, False, what), *(Outcome(stated, False) for stated in others)]
