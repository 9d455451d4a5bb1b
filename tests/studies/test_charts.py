"""The charts of docs/results.md are drawn from the tables that are kept."""

import json
from dataclasses import replace

import pytest

from studies.holes import RATIO
from studies.shared.charts import number_in
from studies.shared.result import Claim, Result, Table, data
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


def test_statements_are_listed_with_their_rule_and_verdicts(tmp_path, monkeypatch):
    monkeypatch.setattr(result_figures, "DOCS", tmp_path)
    (tmp_path / "tables").mkdir()
    claim = Claim("uniform_prior", False, "15 cm;", "best", "replayed: 1 cm.", seeds="3")
    own = Claim("prior_matched", True, "1.5 times that distance.")
    report = tmp_path / "report.json"
    for study, claims in (("claims", [claim]), ("sequences", [own, replace(claim, of="")])):
        result = {study: data(Result("Statements", [], claims))}
        report.write_text(json.dumps(result), encoding="utf-8")
        result_figures.keep(report)
    written = write_tables("<!-- statements -->\nstale\n<!-- end of statements -->")
    assert "stale" not in written and "Confirmed if bones, sliding" in written
    assert "- best: **refuted** (seeds: 3): 15 cm; replayed: 1 cm." in written
    assert written.count("refuted") == 1  # the first study that judges a statement is listed
    assert "- **confirmed**: 1.5 times that distance." in written


@pytest.mark.parametrize("path", sorted(DOCS.rglob("*.md")), ids=lambda path: path.stem)
def test_tables_of_documents_are_those_that_are_kept(path):
    document = path.read_text(encoding="utf-8")
    assert write_tables(document) == document
