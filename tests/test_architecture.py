"""The structure: imports point to earlier layers, the map is complete."""

import ast
import importlib
import inspect
import re
from configparser import ConfigParser
from functools import cache
from pathlib import Path
from pkgutil import resolve_name

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "numpy_cae"

LAYERS = [
    *({"ops"}, {"models"}, {"training"}, {"motion", "confined"}, {"fast", "verify"}, {"manifold"}),
    *({"viz", "mocap"}, {"cleanup"}, {"evaluation"}, {"course", "download"}),
    {"public", "notebook", "pytest_plugin"},
    *({"cli"}, {"__main__"}, {"__init__"}),
]
"""A package imports those before it, and itself; modules of the root are below all of them."""
PACKAGES = set().union(*LAYERS)
ROOT_LAYER = -1


@cache
def tree_of(path: Path) -> ast.Module:
    """The syntax tree of a file, parsed once."""
    return ast.parse(path.read_text(encoding="utf-8"))


def python_files(*folders: str) -> list[Path]:
    paths = []
    for folder in folders:
        paths += sorted((ROOT / folder).rglob("*.py"))
    return paths


def imported_modules(path: Path) -> set[str]:
    """Dotted names of this project that a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            if node.module == "numpy_cae":
                found |= {f"numpy_cae.{alias.name}" for alias in node.names}
            else:
                found.add(node.module)
    return {name for name in found if name.split(".")[0] in ("numpy_cae", "data_synth")}


def layer_of(module: str) -> int:
    """The number of the layer in which a module such as numpy_cae.ops.gru is."""
    part = [*module.split("."), "__init__"][1]
    return next((n for n, layer in enumerate(LAYERS) if part in layer), ROOT_LAYER)


def test_every_package_has_a_layer():
    assert {path.parent.name for path in PACKAGE.glob("*/__init__.py")} <= PACKAGES


@pytest.mark.parametrize("part", sorted(PACKAGES))
def test_imports_point_to_earlier_layers(part):
    folder = PACKAGE / part
    wrong = set()
    for path in sorted(folder.rglob("*.py")) if folder.is_dir() else [PACKAGE / f"{part}.py"]:
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for name in imported_modules(path):
            own = name.split(".")[1:2] == [part] or name == "numpy_cae.__version__"
            if name.startswith("numpy_cae") and not own and layer_of(name) >= layer_of(module):
                wrong.add((module, name))
            if name.startswith("data_synth") and part != "cli":
                wrong.add((module, name))
    assert not wrong


def test_the_root_imports_nothing_of_the_packages():
    for path in PACKAGE.glob("*.py"):
        if path.stem not in PACKAGES:
            assert {layer_of(name) for name in imported_modules(path)} <= {ROOT_LAYER}, path


def test_data_synth_needs_arrays_only_and_writes_files_in_one_module():
    for path in python_files("data_synth"):
        used = {name.split(".")[1] for name in imported_modules(path) if "numpy_cae." in name}
        more = {
            "write_series.py": {"mocap", "atomic_write"},
            "__main__.py": {"progress", "atomic_write"},
        }
        assert used <= {"motion"} | more.get(path.name, set()), path


def test_studies_import_nothing_of_the_commands():
    for path in python_files("studies"):
        assert not any(name.startswith("numpy_cae.cli") for name in imported_modules(path)), path


def test_tests_import_no_tests():
    for path in python_files("tests"):
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.ImportFrom) and node.module:
                assert not node.module.startswith("test_"), path


def test_only_the_safe_reader_loads_array_files():
    loading = {
        path.name
        for path in python_files("numpy_cae", "data_synth")
        for node in ast.walk(tree_of(path))
        if isinstance(node, ast.Attribute) and ast.unparse(node) in ("np.load", "pickle.load")
    }
    assert loading == {"array_file.py"}


MAP = (ROOT / "docs" / "map.md").read_text(encoding="utf-8")
MAP_NAMES = sorted(set(re.findall(r"`(numpy_cae[\w.]+)`", MAP)))


@pytest.mark.parametrize("name", MAP_NAMES)
def test_a_name_in_the_map_exists(name):
    assert resolve_name(name) is not None


@pytest.mark.parametrize(
    "package", ["ops", "models", "training", "motion", "manifold", "mocap", "cleanup"]
)
def test_every_public_name_is_in_the_map(package):
    module = importlib.import_module(f"numpy_cae.{package}")
    public = {name for name in module.__all__ if not inspect.ismodule(getattr(module, name))}
    assert sorted(public - set(re.findall(r"\w+", MAP))) == []


@pytest.mark.parametrize("equation", ["eq. 1", "eq. 2", "eq. 3", "eq. 4"])
def test_every_equation_is_in_the_map(equation):
    assert any(equation in row and "`numpy_cae." in row for row in MAP.splitlines())


def test_the_files_of_the_reading_list_exist():
    reading = MAP.split("## An afternoon's reading")[1].split("\n## ")[0]
    files = re.findall(r"^\d+\. `(numpy_cae/[\w/]+\.py)`", reading, re.MULTILINE)
    assert 1 <= len(files) <= 12
    assert all((ROOT / file).is_file() for file in files)


def test_the_wheel_has_every_data_file():
    """A clone that is installed editable does not show that a file is missing in setup.cfg."""
    config = ConfigParser()
    config.read(ROOT / "setup.cfg", encoding="utf-8")
    named: set[Path] = set()
    for package, patterns in config["options.package_data"].items():
        for pattern in patterns.split():
            files = set((ROOT / package.replace(".", "/")).glob(pattern))
            assert files, f"no file of {package} is {pattern}"
            named |= files
    data = {path for path in PACKAGE.rglob("*.*") if path.suffix in {".json", ".toml", ".txt"}}
    data |= {path for path in PACKAGE.rglob("*.*") if path.suffix in {".npz", ".ipynb", ".js"}}
    assert sorted(data - named) == []


def test_no_licence_takes_the_place_of_another_in_the_wheel():
    """Files of one name are one file in the folder of the metadata."""
    setup = ConfigParser()
    setup.read(ROOT / "setup.cfg", encoding="utf-8")
    paths = setup["metadata"]["license_files"].split()
    assert all((ROOT / path).is_file() for path in paths)
    assert len({Path(path).name for path in paths}) == len(paths) == 2
