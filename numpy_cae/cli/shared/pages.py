"""The pages of `repair` and `fill`: before and after of one file, and an index of several."""

import argparse
import os
import urllib.parse
from collections.abc import Sequence
from html import escape
from pathlib import Path
from shlex import quote
from string import Template
from typing import NamedTuple

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import Motion
from numpy_cae.repair import Repaired
from numpy_cae.repair.repaired import Measures, count, filled
from numpy_cae.visible import visible
from numpy_cae.viz import before_and_after, save_viewer, strip_svg
from numpy_cae.viz.viewer import page_text

NOT_REPEATED = "command run files output dry_run overwrite html findings only".split()
"""NOT_REPEATED: what the command of one finding does not repeat."""


class Row(NamedTuple):
    """What became of one file, for its line in the terminal and its row in the index.

    The numbers are: findings, seconds that were changed, seconds, frames with a jump before and
    after.
    """

    source: Path
    numbers: tuple[float, ...]
    status: int
    page: Path | None = None
    strip: str = ""


def numbers_of(repaired: Repaired, values: Measures) -> tuple[float, ...]:
    """The numbers of a row."""
    motion = repaired.motion
    changed = np.count_nonzero(repaired.touched.any(axis=1)) / motion.rate
    return (len(repaired.findings), changed, motion.seconds, *values[0][1:])


def in_words(numbers: tuple[float, ...]) -> str:
    """The numbers of a row, or the sums of several; no findings where all was asked for."""
    findings, changed, seconds, before, after = numbers
    found = "" if changed and not findings else f"{count(int(findings), 'finding')}, "
    return (
        f"{found}{changed:.1f} of {seconds:.1f} s changed, "
        f"frames with a jump {before:.0f} → {after:.0f}"
    )


def write_page(
    args: argparse.Namespace,
    files: tuple[Path, Path],
    motion: Motion,
    repaired: Repaired,
    said: list[str],
    values: Measures,
) -> str:
    """Write the page of two files, the source and the target; the strip of the index's row."""
    source, target = files
    is_fill = args.command == "fill"
    title = f"{source.name}, {filled(repaired)}" if is_fill else f"{source.name}: before and after"
    own = target.with_stem(f"{target.stem}_finding_0")
    command = "" if is_fill else command_of(args, source, own)
    actors = before_and_after(motion, repaired.motion, rig_of(motion).joints)
    entries = [finding.to_json() for finding in repaired.listed()]
    page = target.with_suffix(".html")
    shown = {"overlaid": True, "findings": entries, "command": command}
    save_viewer(actors, page, motion.rate, title, said, values, **shown)
    changed = np.flatnonzero(repaired.touched.any(axis=1)) + len(motion) - len(repaired.motion)
    return strip_svg(actors, changed)


def write_index(folder: Path, rows: Sequence[Row]) -> Path:
    """Write the page that lists all files, those with most frames that jump first."""
    lines = []
    for row in sorted(rows, key=lambda row: row.numbers[::-1], reverse=True):
        name = escape(visible(row.source.name))
        if row.page:
            address = os.fsencode(row.page.relative_to(folder).as_posix())
            name = f'<a href="{urllib.parse.quote(address)}">{name}</a>'
        said = "".join(f"<td>{escape(cell)}</td>" for cell in in_words(row.numbers).split(", "))
        lines.append(f"<tr><th scope=row>{name}</th><td>{row.strip}</td>{said}</tr>")
    title = f"{count(len(rows), 'file')}: before and after"
    text = Template(page_text("index.html")).substitute(title=title, rows="\n".join(lines))
    page = folder / "index.html"
    with atomic_write(page) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return page


def command_of(args: argparse.Namespace, source: Path, target: Path) -> str:
    """This command for one file, into a file `target`, with every option that changes the result;
    the page writes the number of a finding in its name, and adds --only."""
    words = ["numpy-cae", "repair", source, "-o", target]
    for name, value in vars(args).items():
        if name in NOT_REPEATED or value in (None, False, []):
            continue
        option = "--from" if name == "source" else f"--{name}"
        each = value if isinstance(value, list) else [value]
        if value is True:
            words.append(option)
        elif len(each) > 1 and name != "mapping":
            words += [option, *each]
        else:  # --mapping is repeated
            words += [f"{option}={one}" for one in each]
    return " ".join(quote(str(word)) for word in words)
