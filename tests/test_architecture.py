"""The structure: imports point inwards, sizes stay within budgets, the map is complete."""

import ast
import importlib
import inspect
import io
import re
import tokenize
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "numpy_cae"

FOUNDATION = {"errors", "atomic_write", "array_file", "visible"}
"""Modules of the root that every package may import."""

ALLOWED = {
    "ops": set(),
    "models": {"ops"},
    "training": {"ops", "models"},
    "motion": set(),
    "manifold": {"ops", "models", "training", "motion", "fast"},
    "fast": {"ops", "models"},
    "verify": {"ops", "models"},
    "evaluation": {"motion"},
    "viz": {"motion"},
}
RING_1 = {"ops", "models", "training", "motion", "manifold"}
RING_2 = {"fast", "verify", "evaluation", "viz"}
INNER = RING_1 | RING_2
RING_3 = {
    "beyond": INNER,
    "experiments": INNER | {"beyond", "bench"},
    "course": INNER | {"beyond", "experiments", "bench"},
    "download": INNER,
    "bench": INNER,
    "cli": INNER | {"beyond", "experiments", "course", "download", "bench"},
}
ALLOWED |= RING_3
"""What each package may import besides itself and `FOUNDATION`."""


def python_files(*folders: str) -> list[Path]:
    return [path for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]


def imported_modules(path: Path) -> set[str]:
    """Dotted names of this project that a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            if node.module == "numpy_cae":
                found |= {f"numpy_cae.{alias.name}" for alias in node.names}
            else:
                found.add(node.module)
    return {name for name in found if name.split(".")[0] in ("numpy_cae", "data_synth")}


def test_every_package_has_a_ring():
    packages = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    assert packages == set(ALLOWED)


@pytest.mark.parametrize("package", sorted(ALLOWED))
def test_imports_point_inwards(package):
    allowed = ALLOWED[package] | FOUNDATION | {package, "__version__"}
    wrong = defaultdict(set)
    for path in python_files(f"numpy_cae/{package}"):
        for name in imported_modules(path):
            part = name.split(".")[1] if "." in name else name
            if name.startswith("numpy_cae") and part not in allowed:
                wrong[str(path.relative_to(ROOT))].add(name)
            if name.startswith("data_synth") and package not in RING_3:
                wrong[str(path.relative_to(ROOT))].add(name)
    assert not wrong, dict(wrong)


def test_ops_and_foundation_import_nothing_of_the_project_but_themselves():
    for path in python_files("numpy_cae/ops"):
        assert all(name.startswith("numpy_cae.ops") for name in imported_modules(path)), path
    for name in FOUNDATION:
        imported = imported_modules(PACKAGE / f"{name}.py")
        assert imported <= {f"numpy_cae.{other}" for other in FOUNDATION}, (name, imported)


LAYERS = {
    "core": set(),
    "formats": {"core"},
    "retarget": {"core"},
    "read": {"core", "formats", "retarget"},
}
"""What each layer inside `motion` may import besides itself."""


def layer_of(module: str) -> str:
    """The layer of a dotted name such as numpy_cae.motion.formats.bvh."""
    part = [*module.split("."), ""][2]
    return part if part in LAYERS else "core"


@pytest.mark.parametrize("layer", LAYERS)
def test_the_layers_of_motion_import_in_one_direction(layer):
    folder = PACKAGE / "motion" if layer == "core" else PACKAGE / "motion" / layer
    paths = folder.glob("*.py") if layer == "core" else folder.rglob("*.py")
    wrong = {
        (str(path.relative_to(PACKAGE)), name)
        for path in paths
        if path != PACKAGE / "motion" / "__init__.py"  # gathers the public names of all layers
        for name in imported_modules(path)
        if name.startswith("numpy_cae.motion") and layer_of(name) not in LAYERS[layer] | {layer}
    }
    assert not wrong


def test_only_the_safe_reader_loads_array_files():
    loading = {
        path.name
        for path in python_files("numpy_cae", "data_synth")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and ast.unparse(node) in ("np.load", "pickle.load")
    }
    assert loading == {"array_file.py"}


MOST_CODE = {"numpy_cae": 16000, "data_synth": 2250, "tests": 8500}
"""Lines that hold code; docstrings, comments and blank lines are free."""
LAYOUT = {
    *(tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE),
    *(tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER),
}


def code_lines(path: Path) -> int:
    """The lines of a file that hold code."""
    text = path.read_text(encoding="utf-8")
    docstrings = {
        line
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        for line in range(node.lineno, node.end_lineno + 1)
    }
    used = {
        line
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type not in LAYOUT
        for line in range(token.start[0], token.end[0] + 1)
    }
    return len(used - docstrings)


@pytest.mark.parametrize("folder", MOST_CODE)
def test_the_code_keeps_its_budget(folder):
    assert sum(map(code_lines, python_files(folder))) <= MOST_CODE[folder]


MAP = (ROOT / "docs" / "map.md").read_text(encoding="utf-8")
MAP_NAMES = sorted(set(re.findall(r"`(numpy_cae[\w.]+)`", MAP)))


def resolve(name: str) -> object:
    """The object with this dotted name."""
    parts = name.split(".")
    for split in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:split]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[split:]:
            found = getattr(found, attribute)
        return found
    raise ImportError(name)


@pytest.mark.parametrize("name", MAP_NAMES)
def test_a_name_in_the_map_exists(name):
    assert resolve(name) is not None


@pytest.mark.parametrize("package", sorted(RING_1))
def test_every_public_name_of_ring_1_is_in_the_map(package):
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
