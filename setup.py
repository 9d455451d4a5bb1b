"""Build the package; setup.cfg has all settings.

The students' notebooks are made of the notebooks in `lessons` when the package is built. An
editable installation has none: there `numpy-cae lessons` makes them when it writes them.
"""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from setuptools import setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).parent
COURSE = "numpy_cae/course"


def load_notebooks_module() -> ModuleType:
    """The module that makes students' copies, without the package, which needs NumPy."""
    spec = spec_from_file_location("notebooks", HERE / COURSE / "notebooks.py")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class BuildWithNotebooks(build_py):
    """Build the modules of the package, and the students' notebooks beside them."""

    notebook_paths = ()

    def run(self):
        super().run()
        if not self.editable_mode:
            folder = Path(self.build_lib) / COURSE / "notebooks"
            written = load_notebooks_module().write_student_copies(HERE / "lessons", folder)
            self.notebook_paths = [str(path) for path in written]

    def get_outputs(self, include_bytecode=1):
        return [*super().get_outputs(include_bytecode), *self.notebook_paths]


setup(cmdclass={"build_py": BuildWithNotebooks})
