"""Every study of takes runs and returns a result of which text and pictures can be made."""

import pytest

from studies.shared.result import measured, png, report, text

NAMES = "repair_sweep filling_in interpolation comparison holes sampling "
NAMES += "representation kinect depth wrist stepped_keys training_choices scaling "
NAMES += "kinds_of_motion"
WITHOUT_CLAIMS = ("filling_in",)


@pytest.mark.parametrize("name", NAMES.split())
def test_the_result_is_well_formed(result_of, name):
    result = result_of(name)
    assert result.tables
    assert bool(result.claims) == (name not in WITHOUT_CLAIMS)
    for table in result.tables:
        assert table.rows
        assert {len(row) for row in table.rows} == {len(table.header)}
        assert all(isinstance(row[0], str) for row in table.rows)
    for claim in result.claims:
        assert claim.sentence.endswith(".") and measured(claim).endswith(".")
        assert "nan" not in claim.figures
    pictures = list(result.figures.values())
    assert all(len(png(picture)) > 5000 for picture in pictures)
    written = report({name: result})
    assert text(result) in written and written.count("![") == len(pictures)
    assert written.count(".html)") == sum(bool(each.actors) for each in pictures)
