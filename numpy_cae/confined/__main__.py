"""Run a grader, `python -m numpy_cae.confined MODULE`, with a template of its confined processes.

The template is made before the module is imported, so that it has nothing of it in its memory.
"""

import sys
from importlib import import_module

from numpy_cae.confined.template import Template, can_fork


def main() -> None:
    """Call the main function of the module that the command line names, with the template."""
    template = Template() if can_fork() else None
    import_module(sys.argv[1]).main(template)
    if template is not None:
        template.close()


if __name__ == "__main__":
    main()
