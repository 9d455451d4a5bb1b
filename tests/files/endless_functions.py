"""Functions that never return, or end their process."""


def sigmoid(x):
    raise KeyboardInterrupt


def max_pool(x):
    while True:
        pass


def linear(x, w, b):
    import os

    os._exit(0)
