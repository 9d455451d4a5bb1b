"""What `repair` and `fill` share: their arguments, and what is written and printed of each file.

A command is a loop: load, change, write, print. Its pages show before and after of one file, and an
index of several.
"""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import make_folder, replacing
from numpy_cae.cleanup import Repaired, write_findings
from numpy_cae.cleanup.events import rows_of_events
from numpy_cae.cleanup.words import count
from numpy_cae.cli.shared import arguments, files
from numpy_cae.cli.shared.index_page import Row, write_index
from numpy_cae.cli.shared.summary import Numbers, Summary, details_in_words, measures_in_line
from numpy_cae.errors import NumpyCaeError
from numpy_cae.mocap import UnknownRigError, rig_of
from numpy_cae.mocap.file_motion import FileMotion
from numpy_cae.motion import Motion
from numpy_cae.viz import before_and_after, save_viewer
from numpy_cae.viz.figures import strip_svg


class Outcome:
    """What became of the files of a command, and which of them could not be used."""

    def __init__(self, args: argparse.Namespace):
        """Raises ValueError if a file cannot be written, as `files.targets_of`."""
        self.args = args
        self.targets = files.targets_of(args)
        self.is_single = files.is_single(args)
        findings = getattr(args, "findings", None)
        if self.is_single and not args.dry_run:
            page = args.output.with_suffix(".html") if args.html else None
            arguments.require_different({"--findings": findings, "-o": args.output, "--html": page})
        self.findings: dict[Path, Path] = {}
        """The file of findings of each motion, if --findings is given."""
        if findings and self.is_single:
            self.findings = dict.fromkeys(self.targets, findings)
        elif findings:
            names = files.named_files(args.files)
            self.findings = {path: findings / names[path].with_suffix(".json") for path in names}
            files.require_one_target_each(self.findings)
        self.rows: list[Row] = []
        self.unusable: list[str] = []

    @property
    def title(self) -> str:
        """The file, or how many there are."""
        return str(self.args.files[0]) if self.is_single else count(len(self.targets), "file")

    def progress_of(
        self,
        number: int,
        reading_share: float,
        repair_share: float,
        is_done: Callable[[float], None],
    ) -> Callable[[float], None]:
        """A function that takes the share of the repair of a file that is done, which comes after
        its reading and before its writing; it tells `is_done` the share of the work on all files.
        """

        def progress(share: float) -> None:
            of_file = reading_share + repair_share * share
            is_done((number + of_file) / len(self.targets))

        return progress

    @contextmanager
    def of_file(self, source: Path) -> Iterator[None]:
        """Within this block, an error of a file ends the command if the file is the only one; else
        it is listed at the end."""
        try:
            yield
        except BrokenPipeError:  # no error of the file
            raise
        except (NumpyCaeError, ValueError, OSError) as error:
            where = f"{source}: " if isinstance(error, UnknownRigError) else ""
            if self.is_single:
                raise ValueError(f"{where}{error}") from None
            self.unusable.append(f"{where}{error}")

    def end(self) -> int:
        """Print the sums of several files, write their index, and list those that could not be
        used.

        Returns the exit status: 0 if all files could be used, 1 if some, 2 if none; of one file in
        which nothing was changed `summary.UNCHANGED` or `UNLIKE`.
        """
        if self.is_single:
            return self.rows[0].status
        if self.rows:
            columns = zip(*[row.numbers for row in self.rows], strict=True)
            sums = Numbers(*map(sum, columns))
            clean = sum(row.is_clean for row in self.rows)
            if clean:
                print(f"{count(clean, 'file')} without a finding, not changed")
            print(f"{count(len(self.rows), 'file')}: {sums}")
            if self.args.html and not self.args.dry_run:
                index = self.args.output / "index.html"
                write_index(index, self.rows, self.unusable)
                print(f"{index}: all of them; open it in a browser")
        if self.unusable:
            number = f"{len(self.unusable)} of {len(self.targets)}"
            print(f"\n{number} files could not be used:", *self.unusable, sep="\n")
        if not self.rows:
            return 2 if self.unusable else 1
        return 1 if self.unusable else 0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model, the output and the page."""
    add = parser.add_argument
    named = "motion files, or folders that are searched with their subfolders"
    add("files", type=Path, nargs="+", metavar="FILE_OR_FOLDER", help=named)
    output = "for one motion the file to write: in the same format, where unchanged text is kept, "
    output += "or .bvh. For several motions a folder, created if it does not exist"
    add("-o", "--output", type=Path, help=output)
    add("--dry-run", **arguments.FLAG, help="print what would be changed and write nothing")
    arguments.add_shared(parser, "overwrite html")
    files.add_model_arguments(parser)


def write_motion(
    outcome: Outcome, source: Path, motion: Motion, repaired: Repaired
) -> dict[Path, str]:
    """Write the motion to its target, if it has one; what was written, in words, by its file."""
    target = outcome.targets[source]
    if target is None:
        return {}
    _make_folder(outcome, target)
    assert isinstance(repaired.motion, FileMotion)  # made of the motion that was loaded
    args = outcome.args
    with replacing(args.overwrite or not target.exists() or files.is_version(target, source)):
        repaired.motion.save(target, motion)
    return {target: str(repaired.motion)}


def write_page(
    outcome: Outcome, source: Path, motion: Motion, repaired: Repaired, summary: Summary
) -> tuple[dict[Path, str], Row]:
    """Write the page of a motion before and after, if one is asked for and something was changed or
    found; what was written, and the row of the file in the index."""
    target = outcome.targets[source]
    row = Row(source, summary.numbers, summary.status)
    if target is None or not outcome.args.html:
        return {}, row
    page = target.with_suffix(".html")
    is_anything_shown = any(finding.status != "kept" for finding in repaired.listed())
    if summary.status and not is_anything_shown:
        return {page: "not written, since nothing was changed"}, row
    _make_folder(outcome, page)
    actors = before_and_after(motion, repaired.motion, rig_of(motion).joints)
    save_viewer(
        actors,
        page,
        motion.rate,
        overlaid=True,
        findings=rows_of_events(repaired.events()),
        summary=summary.sentences,
        measures=summary.measures,
        title=summary.title,
        command=summary.command,
    )
    changed = np.flatnonzero(repaired.touched.any(axis=1)) + len(motion) - len(repaired.motion)
    row = row._replace(page=page, strip=strip_svg(actors, changed))
    return {page: "before and after; open it in a browser"}, row


def _make_folder(outcome: Outcome, path: Path) -> None:
    """Make the folder of a file to write, if the command writes a folder."""
    if not outcome.is_single:
        make_folder(path.parent)


def write_file_of_findings(outcome: Outcome, source: Path, repaired: Repaired) -> dict[Path, str]:
    """Write the file of --findings, or one in its folder, if it is asked for; what was written."""
    path = outcome.findings.get(source)
    if path is None:
        return {}
    _make_folder(outcome, path)
    write_findings(path, repaired.listed())
    unchanged = f"{len(repaired.proposed)} not changed"
    return {path: f"{count(len(repaired.findings), 'finding')}, {unchanged}"}


def print_summary(
    outcome: Outcome,
    source: Path,
    motion: Motion,
    repaired: Repaired,
    summary: Summary,
    written: dict[Path, str],
) -> None:
    """Print what was changed in a file: of several files its numbers, unless it is clean, which
    `Outcome.end` says."""
    if not outcome.is_single:
        if not Row(source, summary.numbers, summary.status).is_clean:
            print(f"{source}: {summary.numbers}")
        return
    lines = list(summary.sentences)
    if summary.measures:
        lines.insert(2, measures_in_line(summary.measures))
    lines += details_in_words(repaired)
    print(f"{source}: {len(motion)} frames, {motion.note}", *lines, sep="\n  ")
    for path, content in written.items():
        print(f"{path}: {content}")
