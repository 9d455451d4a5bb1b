"""The example of the site: a walk that is damaged, and what `numpy-cae repair` makes of the file.

The walk is that of the picture in README.md. The command runs when the site is built, so that the
pages show what it prints and the motion that it writes.
"""

import subprocess
import sys
from pathlib import Path

from data_synth import make_take
from numpy_cae.mocap import load_motion, write_bvh
from numpy_cae.motion import RATE, Motion
from numpy_cae.viz import motion_actor
from numpy_cae.viz.viewer import fragment, head
from tools.readme_picture import COLOURS, SECONDS, damaged_walk

COMMAND = "numpy-cae repair damaged_walk.bvh -o repaired_walk.bvh --html"
DROP = """
<div class="drop"><label for="drop-file">Drop a .bvh file of your own anywhere on this page, or
choose one:</label> <input type="file" id="drop-file" accept=".bvh"><p id="drop-said" role="status">
The file plays in your browser. Nothing is uploaded; repairing is done by the installed command.</p>
</div>
"""


def write_example(folder: Path, scripts: Path) -> None:
    """Write the damaged walk and its repair, what the command prints, and the first page's viewer.

    Parameters
    ----------
    folder : path
        Receives `damaged_walk.bvh`, `repaired_walk.bvh`, `page/repaired_walk.html`, `printed.txt`
        and `hero.html`.
    scripts : path
        Folder of `drop.js` and of the loader that it uses.
    """
    truth = make_take("walk", seed=7001, seconds=SECONDS, rate=RATE).motion
    (folder / "page").mkdir(parents=True, exist_ok=True)
    write_bvh(damaged_walk(truth), folder / "damaged_walk.bvh", unit=0.01)
    words = [sys.executable, "-m", *COMMAND.replace("-", "_", 1).split()]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=True)
    (folder / "printed.txt").write_text(f"$ {COMMAND}\n{done.stdout}", encoding="utf-8")
    (folder / "repaired_walk.html").replace(folder / "page" / "repaired_walk.html")
    walks = {name: load_motion(folder / f"{name}_walk.bvh") for name in ("damaged", "repaired")}
    loader = (scripts / "BVHLoader.js").read_text(encoding="utf-8")
    drop = (scripts / "drop.js").read_text(encoding="utf-8")
    hero = f'<div class="hero" id="hero">{_side_by_side(walks | {"true walk": truth})}</div>'
    page = "\n".join([hero, DROP, head(bvhloader=loader, drop=drop)])
    (folder / "hero.html").write_text(page, encoding="utf-8")


def _side_by_side(walks: dict[str, Motion]) -> str:
    actors = [motion_actor(walk, name, COLOURS[name]) for name, walk in walks.items()]
    return fragment(actors, RATE)
