"""The charts of docs/results.md are drawn from the tables that are kept."""

import json

import pytest

from studies.holes import RATIO
from studies.shared.charts import number_in
from studies.shared.result import Result, Table, data
from tools import result_figures
from tools.result_figures import DOCS, charts, kept_tables, write_tables

CHARTS = ("sources", "damage", "holes", "speed")


def test_a_cell_is_read_up_to_its_spread():
    assert number_in("3.78 ± 0.04") == 3.78
    with pytest.raises(ValueError, match="no number in 'none'"):
        number_in("none")


@pytest.mark.parametrize("study", CHARTS)
def test_charts_have_the_figures_of_the_tables(study):
    for name, draw in charts(study, kept_tables(study)):
        heights = set()
        for axes in draw().axes:
            for line in axes.lines:
                values = line.get_xdata() if name == "damage" else line.get_ydata()
                heights |= {round(float(value), 3) for value in values}
            heights |= {round(float(patch.get_height()), 3) for patch in axes.patches}
        table = kept_tables(study)[0]
        column = list(table.header).index(RATIO) if name == "holes" else -1
        cells = [row[column] for row in table.rows if row[column] is not None]
        shown = {round(number_in(cell), 3) for cell in cells}
        assert shown & heights, name
        assert (DOCS / "pictures" / f"{name}.png").is_file()


def test_a_report_is_kept_and_its_tables_are_written(tmp_path, monkeypatch):
    monkeypatch.setattr(result_figures, "DOCS", tmp_path)
    (tmp_path / "tables").mkdir()
    result = Result("Kinect", [Table("Errors:", ["method", "cm"], [["network", 1.256]], ".1f")])
    report = tmp_path / "report.json"
    report.write_text(json.dumps({"kinect": data(result)}), encoding="utf-8")
    result_figures.keep(report)
    document = "before\n<!-- table kinect 0 -->\n| old |\n<!-- end of table -->\nafter"
    written = write_tables(document)
    assert "| network | 1.3 |" in written and "old" not in written
    assert written.startswith("before") and written.endswith("after")


@pytest.mark.parametrize("path", sorted(DOCS.rglob("*.md")), ids=lambda path: path.stem)
def test_tables_of_documents_are_those_that_are_kept(path):
    document = path.read_text(encoding="utf-8")
    assert write_tables(document) == document
