"""The files of students in a folder or a zip file, as Moodle, Canvas and nbgrader lay them out.

submitted/Ann Lee_12345_assignsubmission_file/03_convolution_by_hand.ipynb      Moodle
submitted/leeann_LATE_12345_67890_03_convolution_by_hand.ipynb                  Canvas
submitted/ann/week3/03_convolution_by_hand.ipynb                                nbgrader
submitted/ann_03.ipynb, 03_ann.ipynb, ann.ipynb
"""

import os
import re
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from numpy_cae.course.catalogue import ASSIGNMENTS
from numpy_cae.course.copies import PACKAGED

SUFFIXES = (".py", ".ipynb")
ZIP = ".zip"
MOST_FILES = 2000
"""MOST_FILES: a zip file may hold so many files."""
MOST_BYTES = 2**28
"""MOST_BYTES: the files of a zip file may have so many bytes together, unpacked."""
DEEPEST = 2
"""DEEPEST: a zip file in a zip file is opened, and none in that."""
UNPACKED = {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}
"""UNPACKED: other methods may unpack a small entry at once to more than the memory holds."""
MOODLE = re.compile(r"(?P<name>.+?)_(?P<number>\d+)_assignsubmission_[a-z]+_?(?P<file>.*)")
CANVAS = re.compile(r"(?P<name>[^_]+)_(?P<late>LATE_)?(?P<number>\d+)_\d+_(?P<file>.+)")
COPY = re.compile(r"(-Copy\d+|-\d+| ?\(\d+\))+$")
"""COPY: what Jupyter, Canvas and browsers add to the name of a file that exists."""
OWN_NAMES = frozenset(path.stem for path in PACKAGED.glob("*.ipynb"))
"""OWN_NAMES: the names of the lessons' files, in which there is no student's name."""

Found = tuple[Path, PurePosixPath, str]
"""A file, its place in the folder of the class, and what is wrong with it."""


@dataclass(frozen=True)
class HandedIn:
    """A file and who handed it in; `called` are all names and numbers that may be the student's.

    `fault` says why a file cannot be graded.
    """

    path: Path
    student: str
    called: tuple[str, ...]
    lesson: str = ""
    is_late: bool = False
    fault: str = ""


def find_files(path: Path, unpacked: Path) -> Iterator[HandedIn]:
    """The files below a path; what is in a zip file is written to the folder `unpacked`."""
    is_class = path.is_dir() or path.suffix == ZIP
    found = list(_inside(path, unpacked)) if is_class else [(path, _place(path.name), "")]
    of_one = any(len(place.parts) == 1 and _is_lesson(place.stem) for _, place, _ in found)
    for file, place, fault in found:
        is_linked = is_class and file.is_symlink()
        fault = fault or "it is a link to another file" * is_linked
        yield handed_in(file, place, _place(path.stem).name if of_one and is_class else "", fault)


def handed_in(file: Path, place: PurePosixPath, student: str = "", fault: str = "") -> HandedIn:
    """The file at a place of a class's folder; `student` is given where the folder is of one."""
    folder = place.parts[0]
    name = COPY.sub("", place.stem)
    label = folder if len(place.parts) > 1 else name
    known = MOODLE.fullmatch(label) or CANVAS.fullmatch(label)
    if known and not student:
        parts = known.groupdict()
        name = parts["file"] if label == name else name
        called = (parts["number"], parts["name"])
        whose = f"{parts['name']} {parts['number']}"
        return HandedIn(file, whose, called, _lesson(name), bool(parts.get("late")), fault)
    if len(place.parts) == 1 and not student:
        label = re.sub(rf"^\d\db?_|_{_lesson(name) or '-'}$", "", name) or name
        student = file.absolute().parent.name if _is_lesson(name) else label
    student = student or folder
    return HandedIn(file, student, (student,), _lesson(name), fault=fault)


def _place(path: str | Path) -> PurePosixPath:
    """A path as text: names of files are UTF-8 even where the locale has another encoding."""
    text = os.fsencode(path).decode("utf-8", "surrogateescape")
    return PurePosixPath(text.replace(os.sep, "/"))


def _is_lesson(stem: str) -> bool:
    return COPY.sub("", stem) in OWN_NAMES


def _lesson(name: str) -> str:
    """The lesson at the beginning or the end of a name, or ""."""
    parts = name.split("_")
    return next((each for each in (parts[0], parts[-1]) if each in ASSIGNMENTS), "")


def _inside(path: Path, unpacked: Path, depth: int = 0) -> Iterator[Found]:
    """Each file in a folder or a zip file; hidden folders and every mine.py are left out."""
    folder = path
    if not path.is_dir():
        folder = Path(tempfile.mkdtemp(dir=unpacked))
        try:
            _unzip(path, folder)
        except Exception as error:  # zipfile raises many types, and zlib's own
            yield path, _place(path.name), f"the zip file is not opened: {error}"
            return
    for file in sorted(folder.rglob("*")):
        place = _place(file.relative_to(folder))
        hidden = any(part.startswith((".", "__")) for part in place.parts)
        if place.suffix == ZIP and not hidden and depth < DEEPEST:
            for inner, below, fault in _inside(file, unpacked, depth + 1):
                yield inner, place.with_suffix("") / below, fault
        elif place.suffix in SUFFIXES and place.name != "mine.py" and not hidden:
            yield file, place, ""


def _unzip(path: Path, folder: Path) -> None:
    """Write the files of a zip file; raise if it is damaged or too large.

    No entry unpacks to more bytes than it declares, and those that are deflated do so bit by bit.
    """
    with zipfile.ZipFile(path) as packed:
        entries = [each for each in packed.infolist() if not each.is_dir()]
        if len(entries) > MOST_FILES:
            raise ValueError(f"it holds more than {MOST_FILES} files")
        kept = [each for each in entries if Path(each.filename).suffix in (*SUFFIXES, ZIP)]
        if sum(each.file_size for each in kept) > MOST_BYTES:
            raise ValueError(f"its files are larger than {MOST_BYTES // 2**20} MB")
        if {each.compress_type for each in kept} - UNPACKED:
            raise ValueError("only files that are stored or deflated are unpacked")
        for entry in kept:
            name = entry.filename.replace("\\", "/").encode("utf-8", "surrogateescape")
            entry.filename = os.fsdecode(name)
            packed.extract(entry, folder)
