"""The state of the process that an operation must leave as it is."""

import pickle
import random
import warnings
from collections.abc import Callable

import numpy as np


def call_keeping_state(function: Callable, *arguments: object) -> None:
    """Call a function; raise an AssertionError if it changes what the whole program shares.

    It is called in an unusual state: to set once more what is set already would go unnoticed.
    """
    shared = np.random.get_bit_generator()
    numbers, standard = shared.state, random.getstate()
    shared.random_raw(), random.random()
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
        raise AssertionError(f"it changes {', '.join(changed)}: the whole program shares that")


def _state() -> dict[str, object]:
    return {
        "np.seterr": np.geterr(),
        "np.set_printoptions": np.get_printoptions(),
        "the state of np.random": pickle.dumps(np.random.get_bit_generator().state),
        "the state of random": random.getstate(),
        "the filters of warnings": list(warnings.filters),
    }
