"""Draw the charts and write the tables of documents from what studies measured.

    python -m studies damage --data bandai --test '*_005.bvh' -o damage
    python -m tools.result_figures damage/report.json

keeps the tables of the report in docs/tables/damage.json, draws docs/pictures/damage.png from them,
and writes them into docs/results.md and the lab book, between lines such as

    <!-- table damage 0 -->
    <!-- end of table -->

or, with its rows as columns, <!-- table damage 0 transposed -->. With --name NAME a report of one
study is kept in docs/tables/NAME.json: speed_haswell of another machine, claims_jang2018 of one
paper. The statements of both papers, with the claims that are kept of the studies `claims`,
`sequences` and `sequence_choices`, are written between

    <!-- statements -->
    <!-- end of statements -->

and the ratios of the study `speed` on all machines that are kept, with one thread, between

    <!-- ratios on 1 thread -->
    <!-- end of ratios -->

Without a report the charts and tables are made again from what is kept.
"""

import argparse
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from numpy_cae.atomic_write import atomic_write
from studies.damage import DAMAGED, ERROR, GIVEN, UNKNOWN
from studies.holes import RATIO
from studies.shared.charts import (
    draw_damage_and_repair,
    draw_errors_by_share,
    draw_ratios_by_length,
    draw_speed,
)
from studies.shared.result import STATEMENTS, Claim, Table, measured

DOCS = Path(__file__).parents[1] / "docs"
TABLE = re.compile(
    r"(<!-- table (\w+) (\d+)( transposed)? -->\n).*?(<!-- end of table -->)", re.DOTALL
)
"""Where a document has a table: the study, the number of the table among its tables, from 0, and
whether its rows are columns."""
STATEMENTS_PLACE = re.compile(r"(<!-- statements -->\n).*?(<!-- end of statements -->)", re.DOTALL)
"""Where a document has the statements of both papers."""
JUDGES = ("claims", "claims_holden2015", "claims_jang2018", "sequences", "sequence_choices")
"""Reports whose claims are listed: a statement has those of the first one that judges it."""
RATIOS_PLACE = re.compile(
    r"(<!-- ratios on (\d+) threads? -->\n).*?(<!-- end of ratios -->)", re.DOTALL
)
"""Where a document has the ratios of speed on several machines, with so many threads."""
MACHINES = {
    "speed": "AMD EPYC",
    "speed_intel": "Intel Xeon",
    "speed_haswell": "Intel Xeon, for Haswell",
}
"""Reports of the study `speed`, and what the columns of their ratios are called."""
DPI = 150


def charts(study: str, tables: list[Table]) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """Name of a picture and what draws it, of the tables of a study."""
    if study == "sources":
        yield "sources", partial(draw_errors_by_share, tables)
    if study == "damage":
        (errors,) = [table for table in tables if ERROR in table.caption]
        yield "damage", partial(draw_damage_and_repair, errors, DAMAGED, UNKNOWN, GIVEN)
    if study == "holes":
        yield "holes", partial(draw_ratios_by_length, tables[0], RATIO)
    if study == "speed":
        yield "speed", partial(draw_speed, tables[:2])


def kept_tables(study: str) -> list[Table]:
    """The tables of a study that are kept in docs/tables."""
    kept = json.loads((DOCS / "tables" / f"{study}.json").read_text(encoding="utf-8"))
    return [Table(**table) for table in kept["tables"]]


def keep(report: Path, file_name: str = "") -> None:
    """Write the tables and the provenance of each study of a report to docs/tables, in a file that
    has the name of the study unless one is given."""
    for study, result in json.loads(report.read_text(encoding="utf-8")).items():
        kept = {name: result[name] for name in ("title", "tables", "provenance")}
        name = file_name or study
        if name in JUDGES:
            kept["claims"] = result["claims"]
        text = json.dumps(kept, indent=1, ensure_ascii=False)
        (DOCS / "tables" / f"{name}.json").write_text(text + "\n", encoding="utf-8")


def draw_all() -> None:
    """Draw every chart whose tables are kept."""
    for path in sorted((DOCS / "tables").glob("*.json")):
        for name, draw in charts(path.stem, kept_tables(path.stem)):
            with atomic_write(DOCS / "pictures" / f"{name}.png") as temporary:
                draw().savefig(temporary, format="png", dpi=DPI)
            print(f"docs/pictures/{name}.png")


def write_tables(document: str) -> str:
    """A document with the tables that are kept."""

    def table(found: re.Match) -> str:
        kept = replace(kept_tables(found[2])[int(found[3])], caption="")
        if found[4]:
            columns = [list(column) for column in zip(kept.header, *kept.rows, strict=True)]
            kept = replace(kept, header=columns[0], rows=columns[1:])
        return found[1] + kept.text() + "\n" + found[5]

    def ratios(found: re.Match) -> str:
        return f"{found[1]}{ratios_on_machines(int(found[2])).text()}\n{found[3]}"

    written = TABLE.sub(table, document)
    written = RATIOS_PLACE.sub(ratios, written)
    if STATEMENTS_PLACE.search(written):
        listed = list_statements(kept_claims())
        written = STATEMENTS_PLACE.sub(lambda place: f"{place[1]}{listed}\n{place[2]}", written)
    return written


def ratios_on_machines(threads: int) -> Table:
    """PyTorch's time by ours, the median of the rounds and in brackets its quartiles, for each case
    of the study `speed` and each machine."""
    ending = f", {threads} {'thread' if threads == 1 else 'threads'}:"
    rows: dict[tuple[str, int], list[str]] = {}
    for name in MACHINES:
        for table in kept_tables(name):
            if not table.caption.endswith(ending):
                continue
            of_clips = "hidden units" in str(table.rows[0][0])
            for row in table.rows:
                case = f"step, {row[0]}" if of_clips else row[0]
                quartiles = row[table.header.index("ratio, quartiles")]
                ratio = f"{row[table.header.index('ratio')]:.2f} ({quartiles})"
                rows.setdefault((case, row[1]), []).append(ratio)
    listed = [[*case, *ratios] for case, ratios in rows.items()]
    return Table("", ["what", "windows or clips", *MACHINES.values()], listed)


def kept_claims() -> dict[str, list[Claim]]:
    """Key of each statement that was judged to the claims that are kept of it."""
    claims: dict[str, list[Claim]] = {}
    fields = list(Claim.__dataclass_fields__)
    for study in JUDGES:
        path = DOCS / "tables" / f"{study}.json"
        if not path.exists():
            continue
        of_study: dict[str, list[Claim]] = {}
        for kept in json.loads(path.read_text(encoding="utf-8"))["claims"]:
            claim = Claim(**{name: kept[name] for name in fields if name in kept})
            of_study.setdefault(claim.key, []).append(claim)
        claims = of_study | claims
    return claims


def list_statements(claims: dict[str, list[Claim]]) -> str:
    """Each statement that was judged, with its rule, and the verdict and figures of each claim."""
    parts = []
    for key, statement in STATEMENTS.items():
        if key not in claims:
            continue
        lines = [f"**{statement['sentence']}** ({statement['source']})", ""]
        rule = f"Confirmed if {statement['confirmed if']}. {claims[key][0].circumstances}"
        lines += [rule.strip(), ""]
        if "doubt" in statement:
            lines += [f"Doubt: {statement['doubt']}.", ""]
        for claim in claims[key]:
            subject = f"{claim.of}: " if claim.of else ""
            seeds = f" (seeds: {claim.seeds})" if claim.seeds not in ("", "1") else ""
            lines.append(f"- {subject}**{claim.verdict}**{seeds}: {measured(claim)}")
        parts.append("\n".join(lines))
    return "\n\n".join(parts)


def write_all() -> None:
    """Write the tables into every document that has marked places for them."""
    for path in sorted(DOCS.glob("*.md")) + sorted(DOCS.glob("lab_book/*.md")):
        document = path.read_text(encoding="utf-8")
        written = write_tables(document)
        if written != document:
            path.write_text(written, encoding="utf-8")
            print(path.relative_to(DOCS.parent))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Keep what studies measured, and show it.")
    parser.add_argument("reports", nargs="*", type=Path, help="report.json of a study")
    parser.add_argument("--name", default="", help="the name under which a report is kept")
    args = parser.parse_args()
    for report in args.reports:
        keep(report, args.name)
    draw_all()
    write_all()
