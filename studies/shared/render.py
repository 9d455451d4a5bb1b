"""Results as text in Markdown's form, JSON and PNG."""

import io
from collections.abc import Mapping

from studies.shared.result import Claim, Picture, Result


def text(result: Result) -> str:
    """The title, the tables in Markdown's form, the note, the claims and the provenance."""
    claims = []
    for claim in result.claims:
        verdict = "confirmed" if claim.confirmed else "not confirmed"
        claims.append(f"{verdict}: {claim.sentence} Measured: {measured(claim)}")
    made = [f"{name}: {value}" for name, value in result.provenance.items()]
    parts = [result.title, result.about, *(t.text() for t in result.tables), result.note]
    return "\n\n".join(filter(None, [*parts, "\n".join(claims), "\n".join(made)]))


def measured(claim: Claim) -> str:
    """The figures, and those of the opponent."""
    return claim.figures + (f" {claim.opponent}" if claim.opponent else "")


def data(result: Result) -> dict:
    """Everything but the pictures and the formats, in the types of JSON and NumPy's numbers."""
    tables = [
        {
            "caption": table.caption,
            "header": table.header,
            # JSON has no NaN, the mark of an empty cell.
            "rows": [[None if cell != cell else cell for cell in row] for row in table.rows],
        }
        for table in result.tables
    ]
    claims = [vars(claim) | {"sentence": claim.sentence} for claim in result.claims]
    texts = {name: getattr(result, name) for name in ("title", "about", "note")}
    return texts | {"tables": tables, "claims": claims, "provenance": dict(result.provenance)}


def png(picture: Picture) -> bytes:
    """The figure as PNG."""
    file = io.BytesIO()
    picture.draw().savefig(file, format="png", dpi=110, facecolor="white")
    return file.getvalue()


def report(results: Mapping[str, Result]) -> str:
    """All results in Markdown, with their pictures and moving pages, which are files beside it."""
    parts = []
    for result in results.values():
        parts.append(f"# {text(result)}")
        for name, picture in result.figures.items():
            parts.append(f"![{result.title}: {name}]({name}.png)")
            if picture.actors:
                parts.append(f"[The same, moving]({name}.html)")
    return "\n\n".join(parts) + "\n"
