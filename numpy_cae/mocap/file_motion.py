"""A motion that was read from a file, and how it is saved: with the text of its file, or as BVH."""

import filecmp
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.errors import FileError
from numpy_cae.mocap.formats.amc import find_skeleton
from numpy_cae.mocap.formats.rewriting import rewrite_numbers
from numpy_cae.mocap.formats.write_bvh import write_bvh
from numpy_cae.mocap.rigs.rigs import RiggedMotion
from numpy_cae.motion import Motion

KEPT_SUFFIXES = (".bvh", ".amc")
"""In these formats `FileMotion.save` keeps the text of what did not change."""


@dataclass(frozen=True, repr=False, kw_only=True, eq=False)
class FileMotion(RiggedMotion):
    """A motion that was read from a file, and everything made of it by `dataclasses.replace`.

    Parameters
    ----------
    source : path
        The file.
    reload : callable
        Reads the whole file again, as this motion was read.
    """

    source: Path
    reload: Callable[[], Motion]

    def save(self, path: str | Path, before: Motion | None = None) -> None:
        """Write the motion to a file.

        In the format of its own file (.bvh, .amc) the text of everything that did not change is
        kept, byte for byte, also where frames were cut off, and a missing .asf
        skeleton is copied beside an .amc file. A motion of another format, at another rate, or with
        more frames is written as BVH.

        Parameters
        ----------
        path : path
            The file to write: .bvh, or .amc if the source is one. It may be the source.
        before : Motion, optional
            The motion as it was read; the file is read again where None.

        Raises
        ------
        ValueError, FileError
            If the suffix is another, or values are not finite; if the file cannot be written, or
            an .amc file would be read with another skeleton there.
        """
        path = Path(path)
        suffix = path.suffix.lower()
        if suffix not in KEPT_SUFFIXES or suffix != self.source.suffix.lower():
            write_bvh(self, path)
            return
        if before is None:
            before = self.reload()
        if before.rate != self.rate or len(before) < len(self):
            write_bvh(self, path)
            return
        if suffix == ".amc":
            _copy_skeleton(find_skeleton(self.source), path)
        rewrite_numbers(self.source, before, self, path)

    def save_with_continuous_angles(self, path: str | Path) -> None:
        """Write the motion to a file as `save` does, with angles that continue those of the frame
        before: an angle never jumps by a whole turn, nor do three of them to others of the same
        rotation. The motion is the same.

        Parameters
        ----------
        path : path
            The file to write: .bvh, or .amc if the source is one.
        """
        # q and -q are one rotation: so every angle is written again.
        self.save(path, replace(self, rotations=-self.rotations))


def save(motion: Motion, path: str | Path) -> None:
    """Write any motion to a file, one that was made in memory too.

    Parameters
    ----------
    motion : Motion
        One that was loaded, or made of a loaded one, is written by `FileMotion.save`, which keeps
        the text of everything that did not change. Any other is written by `write_bvh`.
    path : path
        The file to write: .bvh, or .amc if the motion was loaded from one.

    Raises
    ------
    ValueError, FileError
        If the suffix is another, or values are not finite; if the file cannot be written.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import load_motion
    >>> save(make_take("walk", 0, seconds=1.0, rate=30.0).motion, "walk.bvh")
    >>> save(load_motion("walk.bvh").resampled(15), "slower.bvh")
    >>> len(load_motion("slower.bvh"))
    15
    """
    if isinstance(motion, FileMotion):
        motion.save(path)
    else:
        write_bvh(motion, path)


def _copy_skeleton(skeleton: Path, path: Path) -> None:
    """Copy the skeleton of an .amc file beside `path`, where it is not there; FileError unless the
    motion at `path` is then read with it."""
    copy = path.with_name(skeleton.name)
    if not copy.exists():
        with atomic_write(copy) as temporary:
            shutil.copyfile(skeleton, temporary)
    its_skeleton = find_skeleton(path)
    if not filecmp.cmp(its_skeleton, skeleton, shallow=False):
        problem = f"would be read with another skeleton, {its_skeleton}, not with {skeleton}"
        raise FileError(path, None, f"{problem}; write it into another folder")
