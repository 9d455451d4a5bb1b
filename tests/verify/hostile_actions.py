"""What a hostile student's file may try: each text runs before a right `tanh`.

`{outside}` is a folder that the file may not change, with a file `victim`. A text ends by `done()`
where it has done what it should not; what it raises before is the system's refusal.
"""

BEGINNING = '''
import ctypes, gc, os, signal, socket, subprocess, sys, time
import numpy as np

outside = {outside!r}


def done(what="done"):
    raise RuntimeError("DONE: " + what)


def grader():
    """The command that started the grader."""
    parent = os.getppid()
    try:
        return int(open(f"/proc/{{parent}}/stat").read().split()[3])
    except OSError:
        return parent

'''

ACTIONS = {
    "kill the command by a pidfd": """
signal.pidfd_send_signal(os.pidfd_open(os.getppid()), 0)
done()
""",
    "limit the command": """
import resource
resource.prlimit(os.getppid(), resource.RLIMIT_NOFILE)
done()
""",
    "signal the command": """
os.kill(os.getppid(), 0)
done()
""",
    "slow the command": """
os.setpriority(os.PRIO_PROCESS, os.getppid(), 5)
done()
""",
    "pin the command": """
os.sched_setaffinity(os.getppid(), {0})
done()
""",
    "signal by the owner of a pipe": """
import fcntl
r, w = os.pipe()
fcntl.fcntl(r, fcntl.F_SETOWN, os.getppid())
done()
""",
    "delete by dir_fd": """
os.unlink("victim", dir_fd=os.open(outside, os.O_PATH))
done()
""",
    "empty by dir_fd": """
os.open("victim", os.O_TRUNC | os.O_WRONLY, dir_fd=os.open(outside, os.O_PATH))
done()
""",
    "create by dir_fd": """
os.open("new", os.O_CREAT | os.O_WRONLY, dir_fd=os.open(outside, os.O_PATH))
done()
""",
    "rename by dir_fd": """
d = os.open(outside, os.O_PATH)
os.rename("victim", "new", src_dir_fd=d, dst_dir_fd=d)
done()
""",
    "make a folder by dir_fd": """
os.mkdir("new", dir_fd=os.open(outside, os.O_PATH))
done()
""",
    "change the mode": """
os.chmod(outside + "/victim", 0)
done()
""",
    "change the mode of an open file": """
os.fchmod(os.open(outside + "/victim", os.O_RDONLY), 0)
done()
""",
    "change the times": """
os.utime(outside + "/victim", (0, 0))
done()
""",
    "set an attribute": """
os.setxattr(outside + "/victim", "user.x", b"1")
done()
""",
    "make a named pipe": """
os.mkfifo(outside + "/new")
done()
""",
    "make a node": """
import stat
os.mknod(outside + "/new", stat.S_IFREG | 0o600)
done()
""",
    "write by sqlite": """
import sqlite3
sqlite3.connect(outside + "/new").execute("create table t (x)")
done()
""",
    "write by ctypes": """
libc = ctypes.CDLL(None, use_errno=True)
if libc.open((outside + "/new").encode(), os.O_CREAT | os.O_WRONLY, 0o600) < 0:
    raise OSError(ctypes.get_errno(), "refused")
done()
""",
    "read another file": """
open(outside + "/victim").read()
done()
""",
    "shared memory": """
from multiprocessing import shared_memory
shared_memory.SharedMemory(create=True, size=2**20, name=outside.replace("/", "_"))
done()
""",
    "shared memory of System V": """
if ctypes.CDLL(None).shmget(4711, 4096, 0o1600) < 0:
    raise OSError("refused")
done()
""",
    "start a shell by fork_exec": """
import multiprocessing.util
pid = multiprocessing.util.spawnv_passfds(b"/bin/true", [b"true"], ())
done()
""",
    "start a program": """
subprocess.run(["/bin/true"])
done()
""",
    "fork by ctypes": """
if ctypes.CDLL(None).fork() < 0:
    raise OSError("refused")
done()
""",
    "write in a sub-interpreter": """
import _xxsubinterpreters
name = _xxsubinterpreters.create(isolated=False)
_xxsubinterpreters.run_string(name, f"open({outside + '/new'!r}, 'w')")
done()
""",
    "start a program in a sub-interpreter": """
import _xxsubinterpreters
name = _xxsubinterpreters.create(isolated=False)
_xxsubinterpreters.run_string(name, "import os\\nassert os.system('/bin/true') == 0")
done()
""",
    "connect a socket": """
socket.socket()
done()
""",
    "bind a socket of _socket": """
import _socket
_socket.socket()
done()
""",
    "attach to the grader": """
if ctypes.CDLL(None).ptrace(16, os.getppid(), 0, 0) < 0:
    raise OSError("refused")
done()
""",
    "read the solution": """
import importlib.machinery
places = [os.path.join(p, "numpy_cae/ops/activations.py") for p in sys.path]
places += [SOURCE]
for place in places:
    try:
        open(place).read()
    except OSError as error:
        refusal = error
    else:
        done()
raise refusal
""",
    "import the solution by a finder": """
import importlib.machinery, importlib.util
spec = importlib.machinery.PathFinder.find_spec("numpy_cae", [ROOT])
if spec is None:
    raise ImportError("refused")
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
done()
""",
    "find the solution in memory": """
functions = [f for f in gc.get_objects() if type(f) is type(done)]
found = [f for f in functions if f.__module__ == "numpy_cae.ops.activations"]
if not found:
    raise LookupError("not there")
done()
""",
    "find the tests in memory": """
functions = [f for f in gc.get_objects() if type(f) is type(done)]
found = [f for f in functions if f.__qualname__ == "Outcome.__init__"]
if not found:
    raise LookupError("not there")
done()
""",
}
"""Each action by its name."""

PATCHES = {
    "the code of NumPy's all": """
np.all._implementation.__code__ = (lambda *a, **k: True).__code__
""",
    "the code of NumPy's allclose": """
np.allclose.__code__ = (lambda *a, **k: True).__code__
np.array_equal.__code__ = (lambda *a, **k: True).__code__
""",
    "NumPy's functions": """
np.testing.assert_allclose = np.allclose = np.array_equal = np.all = lambda *a, **k: True
np.abs = np.max = lambda *a, **k: 0.0
""",
    "an outcome found in memory": """
for thing in gc.get_objects():
    if getattr(thing, "__name__", "") == "Outcome":
        thing.held = True
""",
    "its own answers": """
import json
json.dumps = lambda *a, **k: '{"thing": null, "changed": [], "arrays": [], "dropped": [[], []]}'
""",
    "a value that equals everything": """
class Cheat(np.ndarray):
    __sub__ = __rsub__ = lambda self, other: np.zeros(self.shape)
    __abs__ = __eq__ = __sub__
""",
}
"""What a file may change in its process, before a wrong `tanh`, by name."""
