"""Let a file start a program of a session of its own, end the file's process, and look.

Prints whether the program runs before and after. The process is not confined, which would refuse
to start programs.
"""

import os
import sys
from functools import partial
from pathlib import Path

from numpy_cae.confined.channel import Channel, Reader, write_all
from numpy_cae.confined.template import Template

SOURCE = """
import subprocess, sys
sleep = [sys.executable, "-c", "import time; time.sleep(100)"]
program = subprocess.Popen(sleep, start_new_session=True)
open("pid", "w").write(str(program.pid))
"""


def is_running(process: int) -> bool:
    """Whether there is a process of this number."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def raise_at_end():
    """The process has ended."""
    raise EOFError


def main():
    folder = Path(sys.argv[1])
    template = Template()
    fork = template.start(folder)
    reader = Reader(fork.answers, raise_at_end)
    channel = Channel(reader.read, partial(write_all, fork.calls), trusted=True)
    _, run_file = channel.call_published()
    run_file("student.py", [("student.py", SOURCE)], False, [], [])
    program = int((folder / "pid").read_text())
    print(is_running(program))
    fork.end()
    print(is_running(program))
    template.close()


if __name__ == "__main__":
    main()
