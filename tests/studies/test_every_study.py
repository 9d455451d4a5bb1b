"""Every study of takes runs and returns a result of which text and pictures can be made."""

from html import escape

import pytest

from studies.shared.render import measured, page, png, text

NAMES = "repair_sweep filling_in interpolation comparison damage sampling "
NAMES += "constrained_projection representation kinect depth"


@pytest.mark.parametrize("name", NAMES.split())
def test_the_result_is_well_formed(result_of, name):
    result = result_of(name)
    assert result.tables and result.claims
    for table in result.tables:
        assert table.rows
        assert {len(cells) for cells in table.cells()} == {len(table.header)}
        assert all(isinstance(row[0], str) for row in table.rows)
    for claim in result.claims:
        assert claim.sentence.endswith(".") and measured(claim).endswith(".")
        assert "nan" not in claim.figures
    pictures = list(result.figures.values())
    assert all(len(png(picture)) > 5000 for picture in pictures)
    html = page({name: result})
    assert result.tables[0].header[-1] in text(result) and escape(result.title) in html
    assert html.count("<img ") == len(pictures)
    assert html.count('class="viewer-data') == sum(bool(each.actors) for each in pictures)
    assert html.count("<table>") == len(result.tables)
