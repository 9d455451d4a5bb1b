"""The solutions of lesson 04, pooling and its inverses."""

import numpy as np


def pooled_again(y, first):
    """max_pool(unpool_random(y, first)), without either of them."""
    return np.maximum(y, 0)
