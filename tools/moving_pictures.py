"""Pages of the site that play what a study measures on synthetic takes with the starter model.

python -m tools.moving_pictures FOLDER
"""

import sys
from pathlib import Path

from numpy_cae.manifold import starter
from studies import codes
from studies.shared.result import write_moving


def write_moving_pictures(folder: Path) -> None:
    """Write a page NAME.html into the folder for each picture NAME."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, picture in codes.run(starter(), None).figures.items():
        write_moving(picture, folder / f"{name}.html")


if __name__ == "__main__":
    write_moving_pictures(Path(sys.argv[1]))
