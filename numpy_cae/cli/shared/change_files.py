"""What `repair` and `fill` share: which files they read and write, and the report about them."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from shlex import quote
from textwrap import indent

from numpy_cae.cli.shared import arguments, one_motion
from numpy_cae.cli.shared.output import require_one_target_each, with_progress, working
from numpy_cae.errors import NumpyCaeError
from numpy_cae.mocap import UnknownRigError
from numpy_cae.mocap.formats.write import require_bvh
from numpy_cae.mocap.load import KEPT, FileMotion, find_motion_files, load_motion
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import Motion
from numpy_cae.repair import Repaired, write_findings
from numpy_cae.repair.repaired import count
from numpy_cae.repair.summary import measures, sentences
from numpy_cae.viz import before_and_after, save_viewer

READING = 1 / 4
"""READING: the share of the time of a repair that reading takes (docs/lab_book/hard_use.md)."""

UNCHANGED, UNLIKE = 3, 4
"""UNCHANGED, UNLIKE: exit statuses of one file in which nothing was changed; of one that is also
unlike what the model knows."""
NOT_REPEATED = "command run files output dry_run overwrite html findings only".split()
"""NOT_REPEATED: what the command of one finding does not repeat."""
TRY = (
    "nothing was changed. Are the up axis (--up) and the joints (`numpy-cae rig`) right? Name what "
    "is damaged (--joint, --frames), or where the motion is from (--from)"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model, the output and the page."""
    add = parser.add_argument
    files = "motion files, or folders that are searched with their subfolders"
    add("files", type=Path, nargs="+", metavar="FILE_OR_FOLDER", help=files)
    output = "for one motion the file to write: in the same format, where unchanged text is kept, "
    output += "or .bvh. For several motions a folder, created if it does not exist"
    add("-o", "--output", type=Path, help=output)
    add("--dry-run", **arguments.FLAG, help="print what would be changed and write nothing")
    add(
        "--overwrite",
        **arguments.FLAG,
        help="replace files that exist, also the file or the folder that is read",
    )
    arguments.add_shared(parser, "html")
    one_motion.add_model_arguments(parser)


class ChangedFiles:
    """The files of a command, and what was changed in them.

    A command loads, changes and writes each file under `reported`:

        changed = ChangedFiles(args)
        for source, target in changed.files():
            with changed.reported(source):
                motion = changed.load(source)
                changed.write(motion, repair(motion, manifold), target)
        return changed.status()

    An error in a single file ends the command. Of several files, those that could not be used are
    listed at the end.
    """

    def __init__(self, args: argparse.Namespace):
        self.args = args
        self.mapping, self.coordinates = arguments.reading(args)
        self.single = len(args.files) == 1 and not args.files[0].is_dir()
        self.targets = self._targets()
        self.unusable: list[str] = []
        self.unchanged = 0
        self.is_done: Callable[[float], None] | None = None

    def files(self) -> Iterator[tuple[Path, Path | None]]:
        """Each motion file with the file to write, None in a dry run."""
        return with_progress(self.targets.items(), len(self.targets), "files done")

    @contextmanager
    def reported(self, source: Path) -> Iterator[None]:
        """Of several files, list one that cannot be used instead of ending with its error."""
        try:
            with working(str(source)) if self.single else nullcontext() as is_done:
                self.is_done = is_done
                yield
        except BrokenPipeError:  # no error of the file
            raise
        except (NumpyCaeError, ValueError, OSError) as error:
            where = f"{source}: " if isinstance(error, UnknownRigError) else ""
            if self.single:
                raise ValueError(f"{where}{error}") from None
            self.unusable.append(f"{where}{error}")

    def load(self, source: Path) -> Motion:
        """The motion in a file."""
        motion = load_motion(source, mapping=self.mapping, **vars(self.coordinates))
        if self.is_done:
            self.is_done(READING)
        print(f"{source}: {len(motion)} frames, {motion.note}")
        return motion

    def write(self, motion: Motion, repaired: Repaired, target: Path | None) -> None:
        """Write the changed motion, unless in a dry run, and print what was changed."""
        same = len(repaired.motion) == len(motion) and not repaired.touched.any()
        same = same and self.args.command == "repair"
        if target is not None:
            if not self.single:
                target.parent.mkdir(parents=True, exist_ok=True)
            assert isinstance(repaired.motion, FileMotion)  # made of the motion that was loaded
            repaired.motion.save(target, motion)
            print(f"{target}: {repaired.motion}")
            if self.args.html and same:
                print(f"{target.with_suffix('.html')}: not written, since nothing was changed")
            elif self.args.html:
                self._write_page(motion, repaired, target)
        print(indent(str(repaired), "  "))
        if getattr(self.args, "findings", None):
            self._write_findings(motion, repaired)
        if same:
            self.unchanged = UNCHANGED if repaired.known else UNLIKE
            if not repaired.known:
                print(f"  {TRY}")

    def status(self) -> int:
        """List the files that could not be used; 0 if all could, 1 if some, 2 if none. Of one file
        that is unchanged: `UNCHANGED` or `UNLIKE`."""
        if self.unusable:
            print(f"\n{len(self.unusable)} of {len(self.targets)} files could not be used:")
            print("\n".join(self.unusable))
            return 1 + (len(self.unusable) == len(self.targets))
        return self.unchanged if self.single else 0

    def _targets(self) -> dict[Path, Path | None]:
        args = self.args
        names = {}
        for path in args.files:
            for source in find_motion_files(path) if path.is_dir() else [path]:
                names[source] = source.relative_to(path if path.is_dir() else path.parent)
        if args.dry_run:
            return dict.fromkeys(names)
        if args.output is None:
            raise ValueError("name the file or folder to write with -o, or use --dry-run")
        if self.single and not args.output.is_dir():
            targets = {args.files[0]: args.output}
            if not args.files[0].suffix.lower() == args.output.suffix.lower() in KEPT:
                require_bvh(args.output)
        else:
            if args.output.suffix.lower() in KEPT and not args.output.is_dir():
                problem = "is a file's name, expected a folder for the motions"
                raise ValueError(f"{args.output}: {problem}")
            targets = {
                source: args.output / (name if source.suffix.lower() in KEPT else f"{name}.bvh")
                for source, name in names.items()
            }
            require_one_target_each(targets)
        if args.html:
            pages = {source: target.with_suffix(".html") for source, target in targets.items()}
            require_one_target_each(pages)
        for source, target in targets.items():
            if args.overwrite or not target.exists():
                continue
            if target.samefile(source):
                raise ValueError(f"{target}: is the file that is read; --overwrite allows this")
            if not _is_version(target, source):
                problem = f"exists and is no version of {source}; --overwrite replaces it"
                raise ValueError(f"{target}: {problem}")
        return targets

    def _write_findings(self, motion: Motion, repaired: Repaired) -> None:
        path = self.args.findings
        if not self.single:
            assert isinstance(motion, FileMotion)
            path = path / f"{motion.source.stem}.json"
            path.parent.mkdir(parents=True, exist_ok=True)
        write_findings(path, repaired.listed())
        proposals = count(len(repaired.proposed), "proposal")
        print(f"{path}: {count(len(repaired.findings), 'finding')}, {proposals}")

    def _write_page(self, motion: Motion, repaired: Repaired, target: Path) -> None:
        page = target.with_suffix(".html")
        source = next(source for source, name in self.targets.items() if name == target)
        title = f"{source.name}: before and after"
        command = self._command(source, target) if self.args.command == "repair" else ""
        actors = before_and_after(motion, repaired.motion, rig_of(motion).joints)
        entries = [finding.to_json() for finding in repaired.listed()]
        said, values = sentences(repaired), measures(motion, repaired.motion)
        save_viewer(actors, page, motion.rate, title, True, entries, command, said, values)
        print(f"{page}: before and after; open it in a browser")

    def _command(self, source: Path, target: Path) -> str:
        """This command for one file, into a file of its own, with every option that changes the
        result; the page writes the number of a finding in its name, and adds --only."""
        own = target.with_stem(f"{target.stem}_finding_0")
        words = ["numpy-cae", "repair", source, "-o", own]
        for name, value in vars(self.args).items():
            if name in NOT_REPEATED or value in (None, False, []):
                continue
            option = "--from" if name == "source" else f"--{name}"
            each = value if isinstance(value, list) else [value]
            if name == "mapping":
                words += [word for path in each for word in (option, path)]
            elif value is True:
                words.append(option)
            else:
                words += [option, *each] if len(each) > 1 else [f"{option}={each[0]}"]
        return " ".join(quote(str(word)) for word in words)


def _is_version(path: Path, source: Path) -> bool:
    """Whether most lines of a file are lines of the source, as of an earlier repair of it."""
    own = set(source.read_bytes().splitlines())
    lines = path.read_bytes().splitlines()
    return 2 * sum(line in own for line in lines) > len(lines)
