"""Write a motion to any supported file, chosen by its suffix."""

from pathlib import Path

from numpy_cae.motion.io.bvh_writer import write_bvh
from numpy_cae.motion.io.gltf_writer import write_glb
from numpy_cae.motion.io.table_writers import write_csv, write_npz
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.completed import without_added

WRITERS = {".bvh": write_bvh, ".glb": write_glb, ".npz": write_npz, ".csv": write_csv}


def require_writer(path: str | Path) -> None:
    """Raise ValueError if no writer has the suffix of this path."""
    if Path(path).suffix.lower() not in WRITERS:
        known = "a motion is written as .bvh, .glb (glTF), .npz or .csv (positions)"
        raise ValueError(f"{path}: {known}")


def write_motion(motion: Motion, path: str | Path) -> None:
    """Write a motion as .bvh, .glb, .npz or .csv, atomically.

    BVH has the up axis and the floor of the motion's file; the others are Y up with the floor at 0.
    Raises ValueError if the suffix is another, or the motion has no frames or values that are not
    finite; FileError if the file cannot be written.
    """
    require_writer(path)
    WRITERS[Path(path).suffix.lower()](without_added(motion), path)
