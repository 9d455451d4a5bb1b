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
from numpy_cae.course.copies import lesson_names
from numpy_cae.verify.grading.submission import COPY, SUFFIXES, lesson_of_name

ZIP = ".zip"
MOST_FILES = 2000
"""A zip file may hold so many files."""
MOST_BYTES = 2**28
"""The files of a zip file may have so many bytes together, unpacked."""
DEEPEST = 2
"""A zip file in a zip file is opened, and none in that."""
UNPACKED = {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}
"""Other methods may unpack a small entry at once to more than the memory holds."""
MOODLE = re.compile(r"(?P<name>.+?)_(?P<number>\d+)_assignsubmission_[a-z]+_?(?P<file>.*)")
CANVAS = re.compile(r"(?P<name>[^_]+)_(?P<late>LATE_)?(?P<number>\d+)_\d+_(?P<file>.+)")


@dataclass(frozen=True)
class HandedIn:
    """A file and who handed it in.

    Attributes
    ----------
    path : Path
    student : str
        The student's name in the table of marks if there is no roster.
    names : tuple of str
        All names and numbers that may be the student's.
    lesson : str
        The lesson that the file's name begins or ends with, or "".
    is_late : bool
        Whether Canvas says so in the file's name.
    fault : str
        Why the file cannot be graded, or "".
    """

    path: Path
    student: str
    names: tuple[str, ...]
    lesson: str = ""
    is_late: bool = False
    fault: str = ""


@dataclass(frozen=True)
class ListedFile:
    """A file, its place in the folder of the class, and what is wrong with it, or ""."""

    path: Path
    place: PurePosixPath
    fault: str = ""


def find_files(path: Path, unpacked: Path) -> Iterator[HandedIn]:
    """The files below a path; what is in a zip file is written to the folder `unpacked`."""
    if not path.is_dir() and path.suffix != ZIP:
        yield hand_in_by_place(path, _as_place(path.name))
        return
    files = list(_files_inside(path, unpacked))
    student = ""
    if any(len(file.place.parts) == 1 and _is_lesson(file.place.stem) for file in files):
        student = _as_place(path.stem).name  # the folder is of one student
    for file in files:
        fault = file.fault
        if not fault and file.path.is_symlink():
            fault = "it is a link to another file"
        yield hand_in_by_place(file.path, file.place, student, fault)


def hand_in_by_place(
    file: Path, place: PurePosixPath, student: str = "", fault: str = ""
) -> HandedIn:
    """The file at a place of a class's folder, with who handed it in.

    Parameters
    ----------
    file : Path
    place : PurePosixPath
        The path within the folder of the class.
    student : str, optional
        The student, where the folder is that of one student.
    fault : str, optional
        Why the file cannot be graded.
    """
    folder = place.parts[0]
    name = COPY.sub("", place.stem)
    label = folder if len(place.parts) > 1 else name
    downloaded = MOODLE.fullmatch(label) or CANVAS.fullmatch(label)
    if downloaded and not student:
        parts = downloaded.groupdict()
        name = parts["file"] if label == name else name
        names = (parts["number"], parts["name"])
        student = f"{parts['name']} {parts['number']}"
        return HandedIn(
            file, student, names, lesson_of_name(name, ASSIGNMENTS), bool(parts.get("late")), fault
        )
    if len(place.parts) == 1 and not student:
        if _is_lesson(name):
            student = file.absolute().parent.name
        else:
            student = _without_lesson(name)
    student = student or folder
    return HandedIn(file, student, (student,), lesson_of_name(name, ASSIGNMENTS), fault=fault)


def _without_lesson(name: str) -> str:
    """The name of a file without the number of the lesson: ann of ann_03 and of 03_ann."""
    lesson = lesson_of_name(name, ASSIGNMENTS) or "-"
    return re.sub(rf"^\d\db?_|_{lesson}$", "", name) or name


def _as_place(path: str | Path) -> PurePosixPath:
    """A path as text: names of files are UTF-8 even where the locale has another encoding."""
    text = os.fsencode(path).decode("utf-8", "surrogateescape")
    return PurePosixPath(text.replace(os.sep, "/"))


def _is_lesson(stem: str) -> bool:
    """Whether a file has the name of a lesson, in which there is no student's name."""
    return COPY.sub("", stem) in lesson_names()


def _files_inside(path: Path, unpacked: Path, depth: int = 0) -> Iterator[ListedFile]:
    """Each file in a folder or a zip file; hidden folders and every mine.py are left out."""
    folder = path
    if not path.is_dir():
        folder = Path(tempfile.mkdtemp(dir=unpacked))
        try:
            _unzip(path, folder)
        except Exception as error:  # zipfile raises many types, and zlib's own
            fault = f"the zip file is not opened: {error}"
            yield ListedFile(path, _as_place(path.name), fault)
            return
    for file in sorted(folder.rglob("*")):
        place = _as_place(file.relative_to(folder))
        if any(part.startswith((".", "__")) for part in place.parts):
            continue
        if place.suffix == ZIP and depth < DEEPEST:
            for inner in _files_inside(file, unpacked, depth + 1):
                yield ListedFile(inner.path, place.with_suffix("") / inner.place, inner.fault)
        elif place.suffix in SUFFIXES and place.name != "mine.py":
            yield ListedFile(file, place)


def _unzip(path: Path, folder: Path) -> None:
    """Write the files of a zip file; raise if it is damaged or too large.

    No entry unpacks to more bytes than it declares, and those that are deflated do so bit by bit.
    """
    with zipfile.ZipFile(path) as packed:
        entries = [entry for entry in packed.infolist() if not entry.is_dir()]
        if len(entries) > MOST_FILES:
            raise ValueError(f"it holds more than {MOST_FILES} files")
        needed = [entry for entry in entries if Path(entry.filename).suffix in (*SUFFIXES, ZIP)]
        if sum(entry.file_size for entry in needed) > MOST_BYTES:
            raise ValueError(f"its files are larger than {MOST_BYTES // 2**20} MB")
        if {entry.compress_type for entry in needed} - UNPACKED:
            raise ValueError("only files that are stored or deflated are unpacked")
        for entry in needed:
            name = entry.filename.replace("\\", "/").encode("utf-8", "surrogateescape")
            entry.filename = os.fsdecode(name)
            packed.extract(entry, folder)
