"""A suspect is shown whole, but neither its name nor its sentence."""

from __future__ import annotations

import ast

import pytest

from numpy_cae.verify.zoo import BUGS
from numpy_cae.verify.zoo.blind import blind_source


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.name)
def test_the_source_without_what_gives_it_away(bug):
    source = blind_source(bug)
    (function,) = ast.parse(source).body
    assert function.name == "suspect" and not function.decorator_list
    assert ast.get_docstring(function) is None and bug.name not in source
    whole = ast.parse(source).body[0].body
    assert isinstance(whole[-1], ast.Return)
