"""Draw the charts of docs/results.md from what studies measured.

    python -m studies damage --data bandai --test '*_005.bvh' -o damage
    python -m tools.result_figures damage/report.json

keeps the tables of the report in docs/tables/damage.json, and draws docs/pictures/damage.png and
holes.png from them. Without a report the charts are drawn again from the tables that are kept.
"""

import json
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from numpy_cae.atomic_write import atomic_write
from studies.damage import DAMAGED, ERROR, GIVEN, RATIO, UNKNOWN
from studies.shared.charts import (
    draw_damage_and_repair,
    draw_errors_by_share,
    draw_ratios_by_length,
    draw_speed,
)
from studies.shared.result import Table

DOCS = Path(__file__).parents[1] / "docs"
STUDIES = ("sources", "damage", "speed")
"""The studies that have charts."""
TABLES_ONLY = ("real_bugs",)
"""The studies whose tables are kept and not drawn."""
DPI = 150


def charts(study: str, tables: list[Table]) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """Name of a picture and what draws it, of the tables of a study."""
    if study == "sources":
        yield "sources", partial(draw_errors_by_share, tables)
    if study == "damage":
        (errors,) = [table for table in tables if ERROR in table.caption]
        (ratios,) = [table for table in tables if RATIO in table.caption]
        yield "damage", partial(draw_damage_and_repair, errors, DAMAGED, UNKNOWN, GIVEN)
        yield "holes", partial(draw_ratios_by_length, ratios)
    if study == "speed":
        yield "speed", partial(draw_speed, tables[:2])


def tables_of(result: dict) -> list[Table]:
    """The tables of one study in report.json."""
    return [Table(table["caption"], table["header"], table["rows"]) for table in result["tables"]]


def keep(report: Path) -> None:
    """Write the tables and the provenance of each study of a report to docs/tables."""
    for study, result in json.loads(report.read_text(encoding="utf-8")).items():
        if study not in STUDIES + TABLES_ONLY:
            raise ValueError(
                f"{report}: {study} has no chart; those of {', '.join(STUDIES)} have"
            )
        kept = {name: result[name] for name in ("title", "tables", "provenance")}
        text = json.dumps(kept, indent=1, ensure_ascii=False)
        (DOCS / "tables" / f"{study}.json").write_text(text + "\n", encoding="utf-8")


def draw_all() -> None:
    """Draw every chart whose tables are kept."""
    for study in STUDIES:
        path = DOCS / "tables" / f"{study}.json"
        if not path.exists():
            continue
        tables = tables_of(json.loads(path.read_text(encoding="utf-8")))
        for name, draw in charts(study, tables):
            with atomic_write(DOCS / "pictures" / f"{name}.png") as temporary:
                draw().savefig(temporary, format="png", dpi=DPI)
            print(f"docs/pictures/{name}.png")


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        keep(Path(argument))
    draw_all()
