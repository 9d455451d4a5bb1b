"""The result of a study: what it measured; and results as text in Markdown's form, JSON and PNG."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy_cae.atomic_write import atomic_write
from numpy_cae.evaluation.tables import Table
from numpy_cae.viz import save_viewer

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from numpy_cae.viz.actor import Actor, Motions


STATEMENTS: dict[str, dict[str, Any]] = {
    statement["key"]: statement
    for statement in json.loads(Path(__file__).with_name("statements.json").read_text("utf-8"))
}
"""The statements that studies test, of the papers in their order and of this project: key to
sentence, source, when it is confirmed, opponents, takes, seeds and spread. "without network" is
true of those that say nothing of a network."""


CONFIRMED = "confirmed"
REFUTED = "refuted"
NO_DIFFERENCE = "no difference"
NOT_DISTINCTIVE = "not distinctive"
BY_CONSTRUCTION = "by construction"
VERDICTS = {
    CONFIRMED: "the rule is fulfilled, and by no opponent",
    REFUTED: "the rule is not fulfilled",
    NO_DIFFERENCE: "the takes or the seeds do not decide: the bound is within the spread",
    NOT_DISTINCTIVE: "an untrained network or a method of ten lines fulfils the rule too",
    BY_CONSTRUCTION: "it follows from how the network is computed: a test, no finding",
}
"""Verdict to what it says."""


@dataclass(frozen=True)
class Claim:
    """One of `STATEMENTS`, and whether the measurement fulfils its rule.

    Parameters
    ----------
    key : str
        Of the statement.
    fulfilled : bool or None
        Whether the rule is fulfilled; None where the spread over takes or seeds does not decide.
    figures : str
        The measured figures that decide, in a sentence.
    of : str
        Of what it was measured, such as a source of motion, where there are several.
    opponent : str
        The same figures of the strongest simple opponent, in a sentence.
    fulfilled_by : str
        The opponent that fulfils the rule too, where there is one.
    seeds : str
        The number of seeds, or the verdict of each where they differ.
    """

    key: str
    fulfilled: bool | None
    figures: str
    of: str = ""
    opponent: str = ""
    fulfilled_by: str = ""
    seeds: str = ""

    @property
    def verdict(self) -> str:
        """One of `VERDICTS`."""
        if self.fulfilled is None:
            return NO_DIFFERENCE
        if not self.fulfilled:
            return REFUTED
        if STATEMENTS[self.key].get("by construction"):
            return BY_CONSTRUCTION
        return NOT_DISTINCTIVE if self.fulfilled_by else CONFIRMED

    @property
    def statement(self) -> str:
        """The statement with its source, and what it was measured of."""
        statement = STATEMENTS[self.key]
        of = self.of and f": {self.of}"
        return f"{statement['sentence']} ({statement['source']}){of}"

    @property
    def sentence(self) -> str:
        """The statement with its source and when it is confirmed."""
        statement = STATEMENTS[self.key]
        rule = statement["confirmed if"] and f"; confirmed if {statement['confirmed if']}"
        of = self.of and f": {self.of}"
        return f"{statement['sentence']} ({statement['source']}{rule}){of}."

    @property
    def circumstances(self) -> str:
        """The opponents, takes, seeds and spread of the statement, as far as it has them."""
        statement = STATEMENTS[self.key]
        parts = []
        for name in ("opponents", "takes", "seeds", "spread"):
            if statement[name]:
                parts.append(f"{name.capitalize()}: {statement[name]}.")
        return " ".join(parts)


@dataclass(frozen=True)
class Picture:
    """A figure of a result, which is drawn when it is requested, and motions for the viewer, or the
    HTML of a page of its own."""

    draw: Callable[[], Figure]
    actors: Sequence[Actor] = ()
    rate: float = 0.0
    page: Callable[[], str] | None = None


def moving(motions: Motions, rate: float, azimuth: float = 40.0) -> Picture:
    """Motions as strips, seen from `azimuth`, in degrees, and moving, `rate` frames a second."""
    from numpy_cae.viz import strip_figure
    from numpy_cae.viz.actor import local_actors, world_actors

    def draw() -> Figure:
        return strip_figure(local_actors(motions), rate, azimuth=azimuth)

    return Picture(draw, world_actors(motions), rate)


@dataclass(frozen=True)
class Result:
    """What a study measured.

    Parameters
    ----------
    title : str
    tables : sequence of Table
    claims : sequence of Claim
    figures : mapping of str to Picture
        Name of each figure's file to the figure.
    note : str
        What is to be known of this measurement.
    about : str
        What the study measures, and how.
    provenance : mapping of str to str
        What must be known to repeat the measurements: data, minutes, seed, settings, versions.
    """

    title: str
    tables: Sequence[Table]
    claims: Sequence[Claim] = ()
    figures: Mapping[str, Picture] = field(default_factory=dict)
    note: str = ""
    about: str = ""
    provenance: Mapping[str, str] = field(default_factory=dict)


def combined(title: str, parts: Sequence[Result], note: str = "") -> Result:
    """The tables, claims and figures of several measurements as one result."""
    tables: list[Table] = []
    claims: list[Claim] = []
    figures: dict[str, Picture] = {}
    for part in parts:
        tables += part.tables
        claims += part.claims
        figures |= part.figures
    return Result(title, tables, claims, figures, note)


def text(result: Result) -> str:
    """The title, the tables in Markdown's form, the note, the claims and the provenance."""
    claims = []
    for claim in result.claims:
        judged = f"{claim.verdict}: {claim.sentence} Measured: {measured(claim)}"
        claims.append(f"{judged} {claim.circumstances}".strip())
    tables = [table.text() for table in result.tables]
    provenance = [f"{name}: {value}" for name, value in result.provenance.items()]
    parts = [result.title, result.about, *tables, result.note]
    parts += ["\n".join(claims), "\n".join(provenance)]
    return "\n\n".join(part for part in parts if part)


def measured(claim: Claim) -> str:
    """The figures, those of the opponent, and the opponent that fulfils the rule too."""
    parts = [claim.figures, claim.opponent]
    if claim.fulfilled and claim.fulfilled_by:
        parts.append(f"The rule is also fulfilled by {claim.fulfilled_by}.")
    return " ".join(part for part in parts if part)


def data(result: Result) -> dict:
    """Everything but the pictures, in the types of JSON and NumPy's numbers."""
    tables = []
    for table in result.tables:
        rows = [[_in_json(cell) for cell in row] for row in table.rows]
        kept = {"caption": table.caption, "header": table.header, "rows": rows}
        tables.append(kept | {"formats": table.formats})
    claims = []
    for claim in result.claims:
        claims.append(vars(claim) | {"verdict": claim.verdict, "sentence": claim.sentence})
    texts = {name: getattr(result, name) for name in ("title", "about", "note")}
    return texts | {"tables": tables, "claims": claims, "provenance": dict(result.provenance)}


def _in_json(cell: object) -> object:
    """JSON has no NaN, the mark of an empty cell."""
    is_nan = cell != cell
    return None if is_nan else cell


def png(picture: Picture) -> bytes:
    """The figure as PNG."""
    file = io.BytesIO()
    picture.draw().savefig(file, format="png", dpi=110, facecolor="white")
    return file.getvalue()


def write_moving(picture: Picture, path: Path) -> None:
    """Write the page of a picture that has motions, or a page of its own."""
    if picture.page:
        with atomic_write(path) as temporary:
            temporary.write_text(picture.page(), "utf-8")
    elif picture.actors:
        save_viewer(picture.actors, path, picture.rate)


def report(results: Mapping[str, Result]) -> str:
    """All results in Markdown, with their pictures and moving pages, which are files beside it."""
    parts = []
    for result in results.values():
        parts.append(f"# {text(result)}")
        for name, picture in result.figures.items():
            parts.append(f"![{result.title}: {name}]({name}.png)")
            if picture.actors or picture.page:
                parts.append(f"[The same, moving]({name}.html)")
    return "\n\n".join(parts) + "\n"
