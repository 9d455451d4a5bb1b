"""What an implementation was seen to do, so that others can be asked whether they do the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

CALLS_REMEMBERED = 400
CALLS_COMPARED = 40


@dataclass
class Deed:
    """One call of the operation, or of a pullback that an earlier call returned."""

    of_call: int
    given: tuple
    given_afterwards: tuple = ()
    returned: object = None
    raised: type | None = None
    is_pull: bool = False


@dataclass
class Witness:
    """An implementation, and a record of what it was given and what came of it."""

    implementation: Callable
    deeds: list[Deed] = field(default_factory=list)
    calls: int = 0

    def __call__(self, *arguments):
        number, self.calls = self.calls, self.calls + 1
        returned = self._watched(Deed(number, _kept(arguments)), self.implementation, arguments)
        if not (isinstance(returned, tuple) and len(returned) == 2 and callable(returned[1])):
            return returned
        value, pullback = returned

        def watched_pullback(*upstream):
            return self._watched(Deed(number, _kept(upstream), is_pull=True), pullback, upstream)

        return value, watched_pullback

    def _watched(self, deed: Deed, function: Callable, arguments: tuple):
        if len(self.deeds) < CALLS_REMEMBERED:
            self.deeds.append(deed)
        try:
            returned = function(*arguments)
        except Exception as error:
            deed.raised = type(error)
            raise
        deed.given_afterwards = _kept(arguments)
        deed.returned = _kept(_numbers(returned, deed.is_pull))
        return returned

    def would_see_the_same(self, other: Callable, only: int | None = None) -> bool:
        """Whether another implementation, given the same, does the same.

        Parameters
        ----------
        other : callable
        only : int, optional
            Look at this one of the gradients alone.
        """
        pulled = {deed.of_call for deed in self.deeds if deed.is_pull}
        seen = pulled | set(range(CALLS_COMPARED))
        pullbacks: dict[int, Callable] = {}
        for deed in self.deeds:
            if deed.of_call not in seen:
                continue
            given = _kept(deed.given)
            try:
                function = pullbacks[deed.of_call] if deed.is_pull else other
                with np.errstate(all="ignore"):
                    returned = function(*given)
            except Exception as error:
                return deed.raised is type(error)
            if deed.raised:
                return False
            if not deed.is_pull:
                pullbacks[deed.of_call] = returned[1]
            ours, theirs = deed.returned, _numbers(returned, deed.is_pull)
            if deed.is_pull and only is not None:
                ours, theirs = ours[only : only + 1], theirs[only : only + 1]
            if not _alike(ours, theirs) or not _alike(deed.given_afterwards, given):
                return False
        return bool(self.deeds)


def _numbers(returned, is_pull: bool) -> tuple:
    """The gradients that a pullback returned, or the value that a call did."""
    if is_pull:
        return tuple(returned) if isinstance(returned, tuple | list) else (returned,)
    return (returned[0],) if isinstance(returned, tuple) and returned else (returned,)


def _kept(arguments: tuple) -> tuple:
    return tuple(a.copy(order="K") if isinstance(a, np.ndarray) else a for a in arguments)


def _alike(ours: tuple, theirs: tuple) -> bool:
    if len(ours) != len(theirs):
        return False
    for one, other in zip(map(np.asarray, ours), map(np.asarray, theirs), strict=True):
        if one.shape != other.shape or one.dtype != other.dtype:
            return False
        if one.dtype == object or not np.allclose(
            one, other, rtol=1e-9, atol=1e-13, equal_nan=True
        ):
            return False
    return True
