"""Which imports are refused, found in the text before anything runs."""

import pytest

from numpy_cae.verify.sandbox.refusal import AUTODIFF, is_refused, refused_imports


@pytest.mark.parametrize("library", [*AUTODIFF, "numpy_cae", "numpy_cae.ops.gru", "torch.nn"])
def test_libraries_that_do_the_exercise_are_refused(library):
    assert is_refused(library)
    assert refused_imports(f"x = 1\nimport {library} as help") == [f"line 2: {library}"]


@pytest.mark.parametrize("library", ["numpy", "scipy.signal", "math", "torchlike", "mytorch"])
def test_others_are_not(library):
    assert not is_refused(library)
    assert refused_imports(f"import {library}") == []


@pytest.mark.parametrize(
    "source",
    [
        "def conv1d():\n    from torch import autograd",
        "try:\n    import torch\nexcept ImportError:\n    pass",
        "if True:\n    import torch.nn as nn",
        "class A:\n    import torch",
        "x = __import__('torch')",
        "from importlib import import_module\nx = import_module('torch.nn')",
        "if __name__ == '__main__':\n    pass\nelse:\n    import torch",
    ],
)
def test_imports_are_found_wherever_they_hide(source):
    assert len(refused_imports(source)) == 1


def test_relative_imports_and_comments_are_none_of_ours():
    assert refused_imports("from . import torch\nfrom .torch import x\n# import torch\n") == []
