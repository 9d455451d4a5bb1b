"""Take the pictures of docs/features.md: run its commands on synthetic motions.

    python -m tools.features              (needs the extra `browser`, and Chromium)
    python -m tools.features Compare      only these commands, by their headings
    python -m tools.features --check      write nothing, and name the pictures that have aged

A picture shows a page at one frame, a picture that the command itself wrote, or what it printed.
"""

import io
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image
from playwright.sync_api import Page, sync_playwright

from data_synth import make_take
from numpy_cae.atomic_write import atomic_write
from numpy_cae.mocap import write_bvh
from tools.readme_picture import damaged_walk

DOCS = Path(__file__).parents[1] / "docs"
WIDTH = 1000
HEIGHT = 720
COLOURS = 128
MOST_DIFFERENCE = 3.0
"""A picture has aged if its grey values, of 255, differ by more than this in the mean."""
FRAME = 50
"""The frame that is shown of a page that plays motions; of a page with findings it is the
middle of the chosen one."""
FEATURE = re.compile(
    r"## (?P<heading>.*)\n[^#]*?```sh\n(?P<command>.*)\n```\n\n"
    r"(`(?P<file>.*)`:\n\n)?!\[.*\]\((?P<picture>.*)\)"
)
"""A section of docs/features.md: its heading, the command, the file that the picture shows, or
nothing where the picture shows what was printed, and the picture."""
WRONG = """import numpy as np


def transpose_filters(w):
    turned = w.transpose(0, 2, 1)  # not reversed in time
    return turned, lambda dy: dy.transpose(0, 2, 1)
"""
TERMINAL = (
    "<body style='margin: 0; width: max-content'><pre style='margin: 0; padding: 16px; background: "
    "#1d2733; color: #e3e8ee; font: 14px/1.4 monospace'>$ {}</pre>"
)


def write_motions(folder: Path) -> None:
    """What the commands read: takes of five kinds, a damaged walk and a wrong function."""
    (folder / "takes").mkdir()
    for kind in ("walk", "run", "kick", "squats", "old_mans_walk"):
        for seed in range(3):
            motion = make_take(kind, seed, seconds=6.0, rate=30.0).motion
            write_bvh(motion, folder / "takes" / f"{kind}_{seed}.bvh", unit=0.01)
    for kind in ("walk", "run"):
        shutil.copy(folder / "takes" / f"{kind}_0.bvh", folder / f"{kind}.bvh")
    damaged = damaged_walk(make_take("walk", 7001, seconds=6.0, rate=30.0).motion)
    write_bvh(damaged, folder / "damaged.bvh", unit=0.01)
    shutil.copy(folder / "damaged.bvh", folder / "takes")
    (folder / "conv.py").write_text(WRONG, encoding="utf-8")


def picture_of(page: Page, file: Path, printed: str) -> bytes:
    """The PNG of a page, of a picture, or of what was printed."""
    if file.suffix == ".png":
        return file.read_bytes()
    if file.suffix != ".html":
        page.set_content(TERMINAL.format(escape(printed)))
        return page.locator("pre").screenshot()
    page.goto(file.as_uri())
    if page.locator("script.viewer-data, .viewer").count():
        page.wait_for_function("window.motionViewers?.()[0]?.stage", timeout=60_000)
        page.evaluate(
            "frame => { const [viewer] = motionViewers(); viewer.redraw(false); "
            "const [first, last] = viewer.loop ?? [frame, frame]; "
            "viewer.scrub(Math.round((first + last) / 2)); viewer.stage.draw(); }",
            FRAME,
        )
    return page.screenshot()


def write_small(picture: bytes, path: Path) -> None:
    """Write a PNG with at most `WIDTH` pixels across and `COLOURS` colours."""
    with Image.open(io.BytesIO(picture)) as full:
        small = full.convert("RGB")
    small.thumbnail((WIDTH, 2 * HEIGHT), Image.Resampling.LANCZOS)
    with atomic_write(path) as temporary:
        small.quantize(COLOURS).save(temporary, "PNG", optimize=True)


def take_pictures(
    folder: Path, chosen: Sequence[str], picture: Callable[[Path, str], bytes]
) -> Iterator[tuple[str, bytes]]:
    """Run the chosen commands of the page, by default all: the name of each picture, and the
    picture."""
    for feature in FEATURE.finditer((DOCS / "features.md").read_text(encoding="utf-8")):
        if chosen and feature["heading"] not in chosen:
            continue
        command = feature["command"]
        words = f"{sys.executable} -m {command.replace('-', '_', 1)}"
        done = subprocess.run(words, shell=True, cwd=folder, capture_output=True, text=True)
        print(f"{command}: {done.returncode} {done.stderr[-200:]}", flush=True)
        file = folder / (feature["file"] or "")
        yield feature["picture"], picture(file, f"{command}\n{done.stdout}")


def has_aged(picture: bytes, path: Path) -> bool:
    """Whether a picture differs from the one that is stored."""
    with Image.open(io.BytesIO(picture)) as full, Image.open(path) as stored:
        size = (WIDTH // 4, HEIGHT // 4)
        new, old = (np.asarray(image.convert("L").resize(size), float) for image in (full, stored))
    return bool(np.abs(new - old).mean() > MOST_DIFFERENCE)


def main(arguments: Sequence[str]) -> int:
    """Write the pictures; with --check, name those that differ from what is stored."""
    is_check = "--check" in arguments
    chosen = [argument for argument in arguments if argument != "--check"]
    aged = []
    with TemporaryDirectory() as temporary, sync_playwright() as playwright:
        folder = Path(temporary)
        write_motions(folder)
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        for name, picture in take_pictures(folder, chosen, partial(picture_of, page)):
            if not is_check:
                write_small(picture, DOCS / name)
            elif has_aged(picture, DOCS / name):
                aged.append(name)
    for name in aged:
        print(f"docs/{name} has aged; `python -m tools.features` takes it again")
    return 1 if aged else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
