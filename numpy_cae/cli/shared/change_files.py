"""What `repair` and `fill` share: each file is loaded, changed, written and reported.

Their pages show before and after of one file, and an index of several.
"""

import argparse
import os
import urllib.parse
from collections.abc import Callable, Sequence
from dataclasses import replace
from html import escape
from pathlib import Path
from shlex import quote
from string import Template
from typing import Any, NamedTuple

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cleanup import Repaired, write_findings
from numpy_cae.cleanup import repaired as report
from numpy_cae.cli.shared import arguments, files
from numpy_cae.cli.shared.output import working
from numpy_cae.errors import NumpyCaeError
from numpy_cae.mocap import UnknownRigError, rig_of
from numpy_cae.mocap.load import FileMotion, load_motion
from numpy_cae.motion import Motion
from numpy_cae.visible import visible
from numpy_cae.viz import before_and_after, save_viewer
from numpy_cae.viz.figures import strip_svg
from numpy_cae.viz.viewer import page_text


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


def write_page(page: Path, motion: Motion, repaired: Repaired, **shown: Any) -> str:
    """Write the page of a motion before and after, with `shown` as in `save_viewer`; return the
    strip of its row in the index."""
    actors = before_and_after(motion, repaired.motion, rig_of(motion).joints)
    entries = [finding.to_json() for finding in repaired.listed()]
    save_viewer(actors, page, motion.rate, overlaid=True, findings=entries, **shown)
    changed = np.flatnonzero(repaired.touched.any(axis=1)) + len(motion) - len(repaired.motion)
    return strip_svg(actors, changed)


def write_index(page: Path, rows: Sequence[Row]) -> None:
    """Write the page that lists all files, those with most frames that jump first."""
    lines = []
    for row in sorted(rows, key=lambda row: row.numbers[::-1], reverse=True):
        name = escape(visible(row.source.name))
        if row.page:
            address = os.fsencode(row.page.relative_to(page.parent).as_posix())
            name = f'<a href="{urllib.parse.quote(address)}">{name}</a>'
        said = "".join(f"<td>{escape(cell)}</td>" for cell in in_words(row.numbers).split(", "))
        lines.append(f"<tr><th scope=row>{name}</th><td>{row.strip}</td>{said}</tr>")
    title = f"{report.count(len(rows), 'file')}: before and after"
    text = Template(page_text("index.html")).substitute(title=title, rows="\n".join(lines))
    with atomic_write(page) as temporary:
        temporary.write_text(text, encoding="utf-8")


Progress = Callable[[float], None]
"""Takes the share of a repair that is done."""
READING = (0.08, 0.02)
"""READING: the share of the time that reading takes, of a plain repair and of one with smoothing or
feet."""
UNCHANGED, UNLIKE = 3, 4
"""UNCHANGED, UNLIKE: exit statuses of one file in which nothing was changed; of one that is also
unlike what the model knows."""
TRY = (
    "nothing was changed. If something is wrong all the same: check the up axis (--up) and the "
    "joints (`numpy-cae rig`), name what is damaged (--joint, --frames), or where the motion is "
    "from (--from)"
)
NOT_REPEATED = "command run files output dry_run overwrite html findings only".split()
"""NOT_REPEATED: what the command of one finding does not repeat."""
ANYWAY = 'to repair some anyway: --findings f.json, add "accept": true to them, then --mask f.json'


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model, the output and the page."""
    add = parser.add_argument
    named = "motion files, or folders that are searched with their subfolders"
    add("files", type=Path, nargs="+", metavar="FILE_OR_FOLDER", help=named)
    output = "for one motion the file to write: in the same format, where unchanged text is kept, "
    output += "or .bvh. For several motions a folder, created if it does not exist"
    add("-o", "--output", type=Path, help=output)
    add("--dry-run", **arguments.FLAG, help="print what would be changed and write nothing")
    add("--overwrite", **arguments.FLAG, help="replace files that exist, also those that are read")
    arguments.add_shared(parser, "html")
    files.add_model_arguments(parser)


def change_files(args: argparse.Namespace, change: Callable[[Motion, Progress], Repaired]) -> int:
    """Load each file, write what `change` makes of it, and print what was changed.

    An error in a single file ends the command. Of several files, those that could not be used are
    listed at the end.

    Returns the exit status: 0 if all files could be used, 1 if some, 2 if none; of one file in
    which nothing was changed `UNCHANGED` or `UNLIKE`.
    """
    targets = files.targets_of(args)
    single = files.is_single(args)
    reading = arguments.reading(args)
    read = READING[_is_slow(args)]
    rows: list[Row] = []
    unusable: list[str] = []
    with working(str(args.files[0]) if single else report.count(len(targets), "file")) as is_done:
        for number, (source, target) in enumerate(targets.items()):
            try:
                motion = load_motion(source, **reading)
                is_done((number + read) / len(targets))

                def done(share: float, before: float = number + read) -> None:
                    is_done((before + (1 - read) * share) / len(targets))

                repaired = change(motion, done)
                rows.append(_changed(args, source, target, motion, repaired))
            except BrokenPipeError:  # no error of the file
                raise
            except (NumpyCaeError, ValueError, OSError) as error:
                where = f"{source}: " if isinstance(error, UnknownRigError) else ""
                if single:
                    raise ValueError(f"{where}{error}") from None
                unusable.append(f"{where}{error}")
    if single:
        return rows[0].status
    if rows:
        together = np.sum([row.numbers for row in rows], axis=0)
        print(f"{report.count(len(rows), 'file')}: {in_words(together)}")
        if args.html and not args.dry_run:
            index = args.output / "index.html"
            write_index(index, rows)
            print(f"{index}: all of them; open it in a browser")
    if unusable:
        print(f"\n{len(unusable)} of {len(targets)} files could not be used:", *unusable, sep="\n")
    return bool(unusable) + (not rows)


def _is_slow(args: argparse.Namespace) -> bool:
    """Whether the user asks for smoothing or feet."""
    return args.command == "repair" and bool(args.source or args.smooth or args.feet)


def _changed(
    args: argparse.Namespace, source: Path, target: Path | None, motion: Motion, repaired: Repaired
) -> Row:
    """Write a changed motion, its page and its findings, and print what was changed."""
    status = _status(args, motion, repaired)
    advised = args.command == "repair" and not _is_slow(args)
    again = command_of(args, source, target or Path("fixed.bvh")) + " --html" * args.html
    said = report.sentences(repaired, again * advised) + [TRY] * (status == UNLIKE)
    values = report.measures(motion, repaired.motion)
    changed = np.count_nonzero(repaired.touched.any(axis=1)) / motion.rate
    numbers = (len(repaired.findings), changed, repaired.motion.seconds, *values[0][1:])
    row = Row(source, numbers, status)
    if args.command == "fill":  # without its number of findings
        said = said[1:]
        values = [each for each in values if round(each[1], 1) != round(each[2], 1)]
    changes = [(name, f"{round(old, 1):.10g}", _after_text(old, new)) for name, old, new in values]
    written = {}
    if target is not None:
        if not files.is_single(args):
            target.parent.mkdir(parents=True, exist_ok=True)
        assert isinstance(repaired.motion, FileMotion)  # made of the motion that was loaded
        repaired.motion.save(target, motion)
        written[target] = str(repaired.motion)
    if target is not None and args.html:
        page = target.with_suffix(".html")
        written[page] = "not written, since nothing was changed"
        if not status or repaired.listed():
            own = _heading(args, source, target, repaired)
            strip = write_page(page, motion, repaired, summary=said, measures=changes, **own)
            row = row._replace(page=page, strip=strip)
            written[page] = "before and after; open it in a browser"
    if getattr(args, "findings", None):
        written |= _write_findings(args, source, repaired)
    if files.is_single(args):
        said[2:2] = ["; ".join(f"{name}: {a} → {b}" for name, a, b in changes)] * bool(changes)
        said += _details(repaired)
        print(f"{source}: {len(motion)} frames, {motion.note}", *said, sep="\n  ")
        for path, content in written.items():
            print(f"{path}: {content}")
    else:
        print(f"{source}: {in_words(row.numbers)}")
    return row


def in_words(numbers: Sequence[float]) -> str:
    """The numbers of a row, or the sums of several; no findings where all was asked for."""
    findings, changed, seconds, before, after = numbers
    found = "" if changed and not findings else f"{report.count(int(findings), 'finding')}, "
    return (
        f"{found}{changed:.1f} of {seconds:.1f} s changed, "
        f"frames with a jump {before:.0f} → {after:.0f}"
    )


def _after_text(before: float, after: float) -> str:
    """The value after, marked if it is worse: larger by more than 1% and 0.1."""
    return f"{round(after, 1):.10g}{' (worse)' if after > 1.01 * before + 0.1 else ''}"


def _heading(
    args: argparse.Namespace, source: Path, target: Path, repaired: Repaired
) -> dict[str, str]:
    """The title of a page, and the command that repairs one finding: the page writes the number of
    the finding in the name of the file, and adds --only."""
    if args.command == "fill":
        return {"title": f"{source.name}, {report.filled(repaired)}"}
    own = target.with_stem(f"{target.stem}_finding_0")
    return {"title": f"{source.name}: before and after", "command": command_of(args, source, own)}


def command_of(args: argparse.Namespace, source: Path, target: Path) -> str:
    """This command for one file, into `target`, with every option that changes the result."""
    words = ["numpy-cae", "repair", source, "-o", target]
    for name, value in vars(args).items():
        if name in NOT_REPEATED or value in (None, False, []):
            continue
        option = "--from" if name == "source" else f"--{name}"
        each = value if isinstance(value, list) else [value] * (value is not True)
        is_repeated = len(each) == 1 or name == "mapping"
        words += [f"{option}={one}" for one in each] if is_repeated else [option, *each]
    return " ".join(quote(str(word)) for word in words)


def _status(args: argparse.Namespace, motion: Motion, repaired: Repaired) -> int:
    """0 if a motion was changed, else `UNCHANGED` or `UNLIKE`; `fill` changes it in any case."""
    if args.command == "fill" or repaired.touched.any() or len(repaired.motion) < len(motion):
        return 0
    return UNCHANGED if repaired.known else UNLIKE


def _details(repaired: Repaired) -> list[str]:
    """The largest findings with their numbers, and what is not changed; without any, the joints."""
    listed = repaired.listed()
    if not listed:
        return repr(repaired).splitlines() if repaired.touched.any() else []
    numbered = enumerate(listed[: len(repaired.findings)], start=1)
    lines = report.few([f"{number}. {each}" for number, each in numbered])
    for status, name in report.NOT_DONE.items():
        # Without the status, whose reason is printed once, above.
        some = [f"  {replace(each, status='repaired')}" for each in listed if each.status == status]
        lines += [f"{name}:", *report.few(some)] if some else []
    return lines + [ANYWAY] * bool(repaired.proposed)


def _write_findings(args: argparse.Namespace, source: Path, repaired: Repaired) -> dict[Path, str]:
    """Write the file of --findings, or one in its folder; what was written, in words."""
    path = args.findings
    if not files.is_single(args):
        path.mkdir(parents=True, exist_ok=True)
        path = path / f"{source.stem}.json"
    write_findings(path, repaired.listed())
    proposals = report.count(len(repaired.proposed), "proposal")
    return {path: f"{report.count(len(repaired.findings), 'finding')}, {proposals}"}
