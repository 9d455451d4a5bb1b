"""The checks of lesson 03, convolution by hand."""

import numpy as np

from numpy_cae.course.exercises.checks import checks


@checks("unfold", "dtype")
def _keeps_float32(function, case, x, taps):
    dtype = np.asarray(function(x.astype(np.float32), taps)).dtype
    if dtype != np.float32:
        raise AssertionError(f"given float32, the rows are {dtype}")
