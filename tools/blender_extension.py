"""The extension for Blender as a zip that Blender installs, with the wheels that it needs.

    python -m tools.blender_extension dist/                                 for this system
    python -m tools.blender_extension dist/ --platform windows-x64 --python 3.13

The zip has the add-on of `integrations/blender`, the wheel of this clone and that of SciPy, which
is compiled for one system and one Python. Blender 4.5 and 5.0 have Python 3.11, Blender 5.1 and
later 3.13; a distribution may build it with another one, as Debian does with 3.14. NumPy is in
Blender.
"""

import argparse
import platform
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "integrations" / "blender"
SCIPY = "scipy==1.16.3"
"""It runs with NumPy 1.26 of Blender 4.5 and 5.0, and with later ones."""
WHEEL_PLATFORMS = {
    "linux-x64": ("manylinux2014_x86_64",),
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_12_0_arm64",),
    "macos-x64": ("macosx_10_14_x86_64",),
}
"""For each of Blender's platforms the tags of wheels."""
BLENDER_VERSIONS = {
    "3.11": ("4.5.0", "5.1.0"),
    "3.13": ("5.1.0", None),
    "3.14": ("5.1.0", None),
}
"""For each Python the first version of Blender that has it, and the first that has it no more."""


def this_platform() -> str:
    """Blender's name of this system."""
    system = {"Linux": "linux", "Windows": "windows", "Darwin": "macos"}[platform.system()]
    machine = "arm64" if platform.machine() in ("arm64", "aarch64") else "x64"
    return f"{system}-{machine}"


def get_wheels(folder: Path, name: str, python: str) -> list[Path]:
    """Build the wheel of this clone and download that of SciPy into a folder."""
    pip = [sys.executable, "-m", "pip", "--quiet"]
    wanted = []
    for tag in WHEEL_PLATFORMS[name]:
        wanted += ["--platform", tag]
    build = [*pip, "wheel", "--no-deps", "--wheel-dir", str(folder), str(ROOT)]
    download = [*pip, "download", "--no-deps", "--only-binary", ":all:", "--dest", str(folder)]
    subprocess.run(build, check=True)
    subprocess.run([*download, "--python-version", python, *wanted, SCIPY], check=True)
    return sorted(folder.glob("*.whl"))


def manifest(wheels: list[Path], name: str, python: str) -> str:
    """The manifest of an extension with wheels."""
    first, end = BLENDER_VERSIONS[python]
    lines = [(FOLDER / "blender_manifest.toml").read_text(encoding="utf-8").split("\n", 1)[1]]
    lines.append(f'platforms = ["{name}"]')
    lines.append(f'blender_version_min = "{first}"')
    if end:
        lines.append(f'blender_version_max = "{end}"')
    lines.append("wheels = [")
    lines += [f'  "./wheels/{wheel.name}",' for wheel in wheels]
    lines.append("]")
    return "\n".join(lines) + "\n"


def pack(wheels: list[Path], name: str, python: str, folder: Path) -> Path:
    """Write the zip of the extension into a folder, and return its path."""
    text = manifest(wheels, name, python)
    version = re.search(r'^version = "(.+)"$', text, re.MULTILINE)[1]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"numpy_cae_blender-{version}-{name}-py{python.replace('.', '')}.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("blender_manifest.toml", text)
        packed.write(FOLDER / "__init__.py", "__init__.py")
        packed.write(ROOT / "LICENSE", "LICENSE")
        for wheel in wheels:
            packed.write(wheel, f"wheels/{wheel.name}", zipfile.ZIP_STORED)
    return path


def main() -> None:
    """Write the zip that the arguments ask for."""
    parser = argparse.ArgumentParser(prog="python -m tools.blender_extension")
    parser.add_argument("folder", type=Path, help="the folder of the zip")
    parser.add_argument("--platform", choices=sorted(WHEEL_PLATFORMS), default=this_platform())
    parser.add_argument("--python", choices=sorted(BLENDER_VERSIONS), default="3.11")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        wheels = get_wheels(Path(scratch), arguments.platform, arguments.python)
        path = pack(wheels, arguments.platform, arguments.python, arguments.folder)
    print(path)


if __name__ == "__main__":
    main()
