"""The computations of `numpy_cae.models`, faster."""
