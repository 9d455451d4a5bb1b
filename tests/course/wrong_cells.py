"""Wrong answers to two exercises, as the cells of a notebook have them."""


def frames_seen(taps, layers):
    return taps


def conv1d(x, w, b):
    raise ValueError("mine")
