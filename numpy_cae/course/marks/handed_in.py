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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from numpy_cae.course.catalogue import ASSIGNMENTS
from numpy_cae.course.copies import lesson_names
from numpy_cae.course.submitted_file import COPY, lesson_of_name
from numpy_cae.verify.grading.submission import SUFFIXES

ZIP = ".zip"
MINE = "mine.py"
"""The file of all solved functions, which lies beside the notebooks and belongs to no lesson."""


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
    prefix : str
        The beginning of the name that Moodle or Canvas gave, by which each of them knows whose
        feedback a file is; "" for other files.
    """

    path: Path
    student: str
    names: tuple[str, ...]
    lesson: str = ""
    is_late: bool = False
    fault: str = ""
    prefix: str = ""


@dataclass(frozen=True)
class ListedFile:
    """A file, its place in the folder of the class, and what is wrong with it, or "".

    `is_document` says that it is of a kind that is never graded, such as a page or a PDF.
    """

    path: Path
    place: PurePosixPath
    fault: str = ""
    is_document: bool = False


def find_files(path: Path, unpacked: Path) -> Iterator[HandedIn]:
    """The files below a path; what is in a zip file is written to the folder `unpacked`."""
    if not path.is_dir() and path.suffix != ZIP:
        place = _as_place(path.name)
        fault = ""
        if path.exists() and path.suffix not in SUFFIXES:
            fault = _why_not_graded(place)
        yield hand_in_by_place(path, place, fault=fault)
        return
    files = list(_files_inside(path, unpacked))
    student = ""
    if any(len(file.place.parts) == 1 and _is_lesson(file.place.stem) for file in files):
        student = _as_place(path.stem).name  # the folder is of one student
    handed_in = []
    documents = []
    for file in files:
        fault = file.fault
        if not fault and file.path.is_symlink():
            fault = "it is a link to another file"
        if file.is_document:
            documents.append(hand_in_by_place(file.path, file.place, student, fault))
        else:
            handed_in.append(hand_in_by_place(file.path, file.place, student, fault))
    yield from handed_in
    yield from _only_files(documents, {file.student for file in handed_in})


def _only_files(documents: Sequence[HandedIn], with_notebooks: set[str]) -> Iterator[HandedIn]:
    """Of each student without a file to grade, one of the files that cannot be graded."""
    students = set(with_notebooks)
    for document in documents:
        if document.student not in students:
            students.add(document.student)
            yield document


MOODLE = re.compile(
    r"(?P<prefix>(?P<name>.+?)_(?P<number>\d+)_assignsubmission_[a-z]+)_?(?P<file>.*)"
)
CANVAS = re.compile(r"(?P<prefix>(?P<name>[^_]+)_(?P<late>LATE_)?(?P<number>\d+)_\d+)_(?P<file>.+)")


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
        lesson = lesson_of_name(name, ASSIGNMENTS)
        is_late = bool(parts.get("late"))
        return HandedIn(file, student, names, lesson, is_late, fault, parts["prefix"])
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


DEEPEST = 2
"""A zip file in a zip file is opened, and none in that."""


def _files_inside(path: Path, unpacked: Path, depth: int = 0) -> Iterator[ListedFile]:
    """Each file in a folder or a zip file that is graded or to be named, none in hidden folders."""
    folder = path
    skipped: list[Path] = []
    too_large: list[Path] = []
    if not path.is_dir():
        folder = Path(tempfile.mkdtemp(dir=unpacked))
        try:
            skipped, too_large = _unzip(path, folder)
        except Exception as error:  # zipfile raises many types, and zlib's own
            fault = f"the zip file is not opened: {error}"
            yield ListedFile(path, _as_place(path.name), fault)
            return
    for file in sorted([*folder.rglob("*"), *skipped, *too_large]):
        place = _as_place(file.relative_to(folder))
        if any(part.startswith((".", "__")) for part in place.parts):
            continue
        if file in too_large:
            yield ListedFile(file, place, TOO_LARGE)
        elif place.suffix == ZIP and depth < DEEPEST:
            for inner in _files_inside(file, unpacked, depth + 1):
                yield ListedFile(inner.path, place.with_suffix("") / inner.place, inner.fault)
        elif place.suffix in SUFFIXES and place.name != MINE:
            yield ListedFile(file, place)
        elif _is_document(place) and not file.is_dir():
            yield ListedFile(file, place, _why_not_graded(place), is_document=True)


DOCUMENTS = {".html", ".htm", ".pdf", ".docx", ".odt", ".rar", ".7z", ".tar", ".gz", ".tgz"}
"""What students hand in in place of a notebook. Of these, one file is named for each student who
has handed in nothing that can be graded; in a download of Moodle or Canvas, a file of any kind."""


def _is_document(place: PurePosixPath) -> bool:
    """Whether a file that cannot be graded may be what a student has handed in."""
    if place.name == MINE or place.suffix.lower() in DOCUMENTS:
        return True
    return any(MOODLE.fullmatch(part) or CANVAS.fullmatch(part) for part in place.parts)


def _why_not_graded(place: PurePosixPath) -> str:
    """What to say of a file of a kind that is not graded."""
    advice = "hand in the notebook of the lesson (.ipynb)"
    if place.name.endswith(MINE):
        return f"{place.name} is handed in without a lesson's notebook, and not graded: {advice}"
    kind = place.suffix or "file without an ending"
    return f"{place.name} is handed in, and a {kind} cannot be graded: {advice}"


MOST_FILES = 2000
"""A zip file may hold at most this many files."""
MOST_BYTES = 2**28
"""The files of a zip file may have at most this many bytes together, unpacked."""
TOO_LARGE = (
    f"it is too large: the files of a zip file have at most {MOST_BYTES // 2**20} MB together"
)
"""Said of the largest files of a zip file, which are not unpacked; the others are graded."""
UNPACKED = {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}
"""Other methods may unpack a small entry at once to more than the memory holds."""


def _unzip(path: Path, folder: Path) -> tuple[list[Path], list[Path]]:
    """Write the files of a zip file that are graded, the smallest first.

    No entry unpacks to more bytes than it declares, and those that are deflated do so bit by bit.

    Returns
    -------
    skipped : list of Path
        Where files of other kinds would be.
    too_large : list of Path
        Where the files would be that are too large together with all smaller ones.

    Raises
    ------
    Exception
        If the zip file is damaged, holds too many files, or they are packed in another way.
    """
    if not path.is_file():  # a pipe would be waited for, a device has no end
        raise ValueError("it is no file")
    with zipfile.ZipFile(path) as packed:
        entries = [entry for entry in packed.infolist() if not entry.is_dir()]
        if len(entries) > MOST_FILES:
            raise ValueError(f"it holds more than {MOST_FILES} files")
        needed = [entry for entry in entries if Path(entry.filename).suffix in (*SUFFIXES, ZIP)]
        if {entry.compress_type for entry in needed} - UNPACKED:
            raise ValueError("only files that are stored or deflated are unpacked")
        skipped: list[Path] = []
        for entry in entries:
            if entry not in needed:
                skipped += _place_of(entry, folder)
        too_large: list[Path] = []
        total = 0
        for entry in sorted(needed, key=lambda entry: entry.file_size):
            total += entry.file_size
            if total > MOST_BYTES:
                too_large += _place_of(entry, folder)
                continue
            name = entry.filename.replace("\\", "/").encode("utf-8", "surrogateescape")
            entry.filename = os.fsdecode(name)
            packed.extract(entry, folder)
    return skipped, too_large


def _place_of(entry: zipfile.ZipInfo, folder: Path) -> list[Path]:
    """Where an entry would be in a folder; nowhere, if it would be outside."""
    place = PurePosixPath(entry.filename.replace("\\", "/"))
    if ".." in place.parts or place.is_absolute():
        return []
    return [folder / os.fsdecode(str(place).encode("utf-8", "surrogateescape"))]
