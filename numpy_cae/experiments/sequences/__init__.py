"""The experiments of jang2018: training on one action each, measurements on held-out motions."""
