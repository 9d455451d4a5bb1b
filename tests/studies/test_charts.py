"""The charts of docs/results.md are drawn from the tables that are kept."""

import json
from pathlib import Path

import pytest

from studies.shared.charts import number_in
from tools.result_figures import DOCS, STUDIES, charts, keep, tables_of


def kept(study):
    result = json.loads((DOCS / "tables" / f"{study}.json").read_text(encoding="utf-8"))
    assert result["provenance"]["command" if "command" in result["provenance"] else "data"]
    return tables_of(result)


def test_a_cell_is_read_up_to_its_spread():
    assert number_in("3.78 ± 0.04") == 3.78
    with pytest.raises(ValueError, match="no number in 'none'"):
        number_in("none")


@pytest.mark.parametrize("study", STUDIES)
def test_charts_have_the_figures_of_the_tables(study):
    for name, draw in charts(study, kept(study)):
        heights = set()
        for axes in draw().axes:
            for line in axes.lines:
                values = line.get_xdata() if name == "damage" else line.get_ydata()
                heights |= {round(float(value), 3) for value in values}
            heights |= {round(float(patch.get_height()), 3) for patch in axes.patches}
        table = kept(study)[1 if name == "holes" else 0]
        shown = {round(number_in(row[-1]), 3) for row in table.rows if row[-1] is not None}
        assert shown & heights, name
        assert (DOCS / "pictures" / f"{name}.png").is_file()


def test_a_report_of_a_study_without_a_chart_is_refused(tmp_path):
    report = Path(tmp_path) / "report.json"
    report.write_text(json.dumps({"kinect": {}}), encoding="utf-8")
    with pytest.raises(ValueError, match="kinect has no chart"):
        keep(report)
