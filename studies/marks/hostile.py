"""Pieces of files that disturb their grading."""

IMPORTS = "import atexit, builtins, ctypes, json, os, socket, subprocess, sys, threading, time\n"
IMPORTS += "import warnings\nimport numpy as np\n"

CHEAT = """
class Cheat(np.ndarray):
    __sub__ = __rsub__ = lambda self, other: np.zeros(self.shape)
    __abs__ = __eq__ = __sub__
right = tanh
def tanh(x):
    y, pullback = right(x)
    return y.view(Cheat), lambda dy: pullback(dy).view(Cheat)
"""

FILLS = "[open(str(n), 'wb').write(bytes(2**23)) for n in range(16)]; time.sleep(60)"

REPLACES_MODULES = """
warnings.simplefilter('error'); np.seterr(all='raise')
np.abs = np.sum = np.asarray = np.random = np.linalg = None
builtins.len = builtins.isinstance = builtins.AssertionError = None
json.dumps = json.dump = os.write = os._exit = time.monotonic = None
sys.stdout = sys.stderr = sys.excepthook = None
"""

REPLACES_TESTS = """
np.testing.assert_allclose = np.allclose = np.array_equal = lambda *a, **k: True
builtins.all = builtins.AssertionError = builtins.max = lambda *a: True
json.dumps = lambda *a, **k: '{"properties": []}'
"""

WAITS = """
atexit.register(time.sleep, 100)
try:
    threading.Thread(target=time.sleep, args=(100,)).start()
except RuntimeError:
    pass
"""
