"""What the whole program shares, and an implementation must leave alone: `call_keeping_state`."""

import pickle
import random
import warnings
from collections.abc import Callable

import numpy as np

from numpy_cae.verify.checks.mismatch import STATE, Mismatch


def call_keeping_state(function: Callable, *arguments: object) -> None:
    """Call a function; raise a Mismatch if it changes global state.

    Before the call the state is made unusual, so that setting the usual state again is noticed.
    """
    shared = np.random.get_bit_generator()
    numbers = shared.state
    standard = random.getstate()
    shared.random_raw()
    random.random()
    quiet = np.errstate(all="call", call=lambda *error: None)
    try:
        with warnings.catch_warnings(), np.printoptions(precision=17), quiet:
            warnings.simplefilter("default", ImportWarning)
            before = _state()
            function(*arguments)
            changed = [what for what, now in _state().items() if now != before[what]]
    finally:
        shared.state = numbers
        random.setstate(standard)
    if changed:
        what = ", ".join(changed)
        raise Mismatch(STATE, what, f"it changes {what}: the whole program shares that")


def _state() -> dict[str, object]:
    return {
        "np.seterr": np.geterr(),
        "np.set_printoptions": np.get_printoptions(),
        "the state of np.random": pickle.dumps(np.random.get_bit_generator().state),
        "the state of random": random.getstate(),
        "the filters of warnings": list(warnings.filters),
    }
