"""Every experiment runs and returns a result of which text and pictures can be made."""

from html import escape

import pytest

from numpy_cae.experiments.page import page
from numpy_cae.experiments.registry import EXPERIMENTS

SCRIPTS = ("damage", "samples_of_priors", "constrained_projection")


@pytest.mark.parametrize(
    "name", [*EXPERIMENTS, "damage", "samples_of_priors", "constrained_projection"]
)
def test_the_result_is_well_formed(result_of, name):
    result = result_of(name)
    assert result.tables and result.claims
    for table in result.tables:
        assert table.rows
        assert {len(cells) for cells in table.cells()} == {len(table.header)}
        assert all(isinstance(row[0], str) for row in table.rows)
    for claim in result.claims:
        assert claim.sentence.endswith(".") and claim.figures.endswith(".")
        assert "nan" not in claim.figures
    picture = result.png()
    assert picture.startswith(b"\x89PNG") and len(picture) > 5000
    text, html = result.text(), page({name: result}, {})
    assert result.tables[0].header[-1] in text and escape(result.title) in html
    assert html.count("<img ") == 1
    assert html.count('class="viewer-data') == bool(result.animation)
    assert html.count("<table>") == len(result.tables)
