"""Two processes that call functions of each other, and share nothing but what they send.

A message is a JSON text with bytes behind it. It can hold numbers, texts, lists, tuples, dicts,
arrays of numbers, and references to functions. Nothing is unpickled, so that a process can read
what an untrusted one sends.

An array that one process sends has a copy in the other. Before each message a process looks which
of these arrays were changed in place, and sends their contents: a function that alters its
arguments, or overwrites a result that it returned before, is seen to do so.
"""

import builtins
import ctypes
import inspect
import json
import os
import struct
import traceback
import weakref
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NoReturn

import numpy as np

try:
    from numpy.lib.array_utils import byte_bounds
except ImportError:  # before NumPy 2
    from numpy import byte_bounds  # type: ignore[attr-defined, no-redef]

LARGEST_MESSAGE = 2**29
"""A message may have at most so many bytes."""
HEAD = struct.Struct("<QQ")
"""The number of bytes of a message's JSON text, and of its arrays."""
BLOCK = 2**16
"""At least so many bytes are asked for at once, as many as a pipe holds."""
MOST_SPARSE = 16
"""An array whose memory has more than so many times its bytes is sent without its layout."""
KINDS_OF_ARRAYS = "biufcUS"
"""Arrays of these kinds of entries are sent: booleans, numbers and texts."""
LONGEST_NAME = 200
"""The name of a type or of a file has at most so many characters."""
MOST_FRAMES = 50
"""So many of the last frames of a traceback are sent."""

Node = Any
"""A thing as JSON can hold it: a number, a text, or a list that begins with a kind."""
Read = Callable[[int], bytes]
"""(number) -> so many bytes that the other process has sent."""
Write = Callable[[bytes | memoryview], None]


class MessageError(BaseException):
    """What the other process sent is no message.

    It is no Exception, so that no check takes it for one that a function raised.
    """


class RemoteError(Exception):
    """An exception of the other process, of a class that has the name of its class.

    `remote_frames` are the files and lines of its traceback.
    """

    remote_frames: tuple[tuple[str, int], ...] = ()
    text: str | None = None

    def __init__(self) -> None:  # some classes of exceptions need arguments
        pass

    def __str__(self) -> str:
        if self.text is None:
            raise ValueError("the other process could not print it")
        return self.text


class _Unreadable:
    """In place of a thing that cannot be sent; its type has the name of the thing's type."""


@dataclass(eq=False)
class _Outgoing:
    """What is sent with a message besides its text."""

    blocks: list = field(default_factory=list)
    arrays: list = field(default_factory=list)  # rows that describe new arrays


class Channel:
    """One end of the connection between two processes.

    Parameters
    ----------
    read, write : callable
        Receive so many bytes, and send bytes.
    trusted : bool
        Whether this is the process that does not run code of others. Its arrays are sent with
        their memory layout and forgotten when nobody uses them; the other process keeps its
        arrays until then. Functions and arrays of the trusted process have even numbers.
    """

    def __init__(self, read: Read, write: Write, trusted: bool) -> None:
        self._read = read
        self._write = write
        self._trusted = trusted
        self._next = 2 if trusted else 1
        self._arrays: dict[int, Any] = {}  # by number; weak references in the trusted process
        self._snapshots: dict[int, bytes] = {}
        self._number_of_array: dict[int, int] = {}
        self._functions: dict[int, Callable] = {}  # those of this process
        self._number_of_function: dict[int, int] = {}
        self._proxies: dict[int, weakref.ref] = {}  # for functions of the other process
        self._dropped_arrays: list[int] = []
        self._dropped_functions: list[int] = []
        self._held: list = []

    def publish(self, function: Callable) -> None:
        """Let the other process call a function by the number 0."""
        self._functions[0] = function

    def call_published(self, *arguments: Any) -> Any:
        """Call the function that the other process has published."""
        return self._call(0, arguments, {})

    def serve(self) -> None:
        """Answer calls until the connection ends."""
        while True:
            message, things = self._receive()
            self._answer(message, things)

    def _call(self, number: int, arguments: tuple, named: dict[str, Any]) -> Any:
        """Call a function of the other process; calls that it makes meanwhile are answered."""
        self._send({"call": number}, [arguments, named])
        while True:
            message, things = self._receive()
            if "call" in message:
                self._answer(message, things)
            elif "error" in message:
                raise _rebuild_error(message["error"])
            else:
                return things

    def _answer(self, message: dict[str, Any], things: Any) -> None:
        """Call the function of this process that a message names, and send what it returns."""
        caught: type[BaseException] = Exception if self._trusted else BaseException
        try:
            function = self._functions[message["call"]]
            arguments, named = things
        except (KeyError, TypeError, ValueError):
            raise MessageError("a call of no function") from None
        try:
            result = function(*arguments, **named)
            self._send({}, result)
        except MessageError:
            raise
        except caught as error:
            self._send({"error": _describe_error(error)}, None)

    def _send(self, message: dict[str, Any], thing: Any) -> None:
        outgoing = _Outgoing()
        try:
            message["thing"] = self._encode(thing, outgoing)
        except BaseException:
            for number, *_ in outgoing.arrays:  # the other process will not get them
                self._drop_array(number)
            raise
        message["changed"] = self._changes(outgoing)
        message["arrays"] = outgoing.arrays
        message["dropped"] = [self._dropped_arrays, self._dropped_functions]
        self._dropped_arrays = []
        self._dropped_functions = []
        text = json.dumps(message).encode()
        data = b"".join(outgoing.blocks)
        # Nothing that the other process may refer to ends before its next message is read.
        self._held = [thing]
        if self._trusted:  # the other keeps its arrays
            self._held += map(self._array, list(self._arrays))
        self._held += [proxy() for proxy in list(self._proxies.values())]
        self._write(HEAD.pack(len(text), len(data)) + text + data)

    def _receive(self) -> tuple[dict[str, Any], Any]:
        """The next message, and the thing that it holds."""
        text_size, data_size = HEAD.unpack(self._read(HEAD.size))
        if text_size + data_size > LARGEST_MESSAGE:
            raise MessageError("it is too large")
        text = self._read(text_size)
        data = memoryview(self._read(data_size))
        try:
            message = json.loads(text.decode())
            dropped_arrays, dropped_functions = message["dropped"]
            for number in dropped_functions:
                self._drop_function(number)
            for number in dropped_arrays:
                self._drop_array(number)
            place = 0
            received = []  # holds the arrays until the thing that they are in is decoded
            for number, *description, size in message["arrays"]:
                if self._trusted and description[2] is not None:
                    raise MessageError("an array with strides")
                contents = bytes(data[place : place + size])
                array = _array_from(description, contents)
                received.append(array)
                self._track(number, array, contents if description[2] is None else array.tobytes())
                place += size
            for number in message["changed"]:
                place += self._change(number, data[place:])
            things = self._decode(message["thing"])
        except MessageError:
            raise
        except (ValueError, TypeError, KeyError, IndexError, AttributeError) as error:
            raise MessageError(f"it cannot be read: {error}") from None
        except (RecursionError, MemoryError, OverflowError) as error:
            raise MessageError(f"it cannot be read: {type(error).__name__}") from None
        self._held = []
        return message, things

    def _encode(self, thing: Any, outgoing: _Outgoing) -> Node:
        """A thing as JSON can hold it."""
        kind = type(thing)
        if thing is None or kind in (bool, int, float, str):
            return thing
        if isinstance(thing, list | tuple):
            name = "list" if isinstance(thing, list) else "tuple"
            return [name, *(self._encode(part, outgoing) for part in thing)]
        if isinstance(thing, dict):
            pairs = []
            for key, part in thing.items():
                pairs.append([self._encode(key, outgoing), self._encode(part, outgoing)])
            return ["dict", *pairs]
        if isinstance(thing, np.generic) and thing.dtype.kind in KINDS_OF_ARRAYS:
            return ["scalar", thing.dtype.str, thing.tobytes().hex()]
        if isinstance(thing, np.ndarray) and thing.dtype.kind in KINDS_OF_ARRAYS:
            number = self._number_for(thing, outgoing)
            return ["array", number, "" if kind is np.ndarray else kind.__name__]
        if isinstance(thing, complex):
            return ["complex", thing.real, thing.imag]
        if isinstance(thing, bytes):
            return ["bytes", thing.hex()]
        if isinstance(thing, int | float | str):  # of a subclass
            base = next(base for base in (int, float, str) if isinstance(thing, base))
            return base(thing)
        if isinstance(thing, np.random.Generator) and self._trusted:
            generator = thing.bit_generator
            state = self._encode(generator.state, outgoing)
            return ["generator", type(generator).__name__, state]
        if callable(thing):
            return self._encode_function(thing)
        return ["unreadable", kind.__name__[:LONGEST_NAME]]

    def _encode_function(self, function: Callable) -> Node:
        remote = getattr(function, "remote_number", None)
        if remote is not None and getattr(function, "remote_channel", None) is self:
            return ["yours", remote]
        number = self._number_of_function.get(id(function))
        if number is None:
            number = self._new_number()
            self._functions[number] = function
            self._number_of_function[id(function)] = number
        return ["function", number, _file_of(function)]

    def _decode(self, node: Node) -> Any:
        """The thing that a node describes."""
        if not isinstance(node, list):
            if isinstance(node, dict):
                raise MessageError("a dict")
            return node
        kind, *parts = node
        match kind:
            case "list":
                return [self._decode(part) for part in parts]
            case "tuple":
                return tuple([self._decode(part) for part in parts])
            case "dict":
                return {self._decode(key): self._decode(part) for key, part in parts}
            case "scalar":
                return np.frombuffer(bytes.fromhex(parts[1]), _dtype(parts[0]))[0]
            case "array":
                array = self._array(parts[0])
                return _as_subclass(array, parts[1]) if parts[1] else array
            case "complex":
                return complex(*parts)
            case "bytes":
                return bytes.fromhex(parts[0])
            case "generator" if not self._trusted:
                generator = getattr(np.random, parts[0])()
                generator.state = self._decode(parts[1])
                return np.random.Generator(generator)
            case "function":
                return self._proxy(int(parts[0]), str(parts[1])[:LONGEST_NAME])
            case "yours":
                return self._functions[parts[0]]
            case "unreadable":
                return type(_type_name(parts[0]), (_Unreadable,), {})()
        raise MessageError("an unknown kind of thing")

    def _new_number(self) -> int:
        number = self._next
        self._next += 2
        return number

    def _number_for(self, array: np.ndarray, outgoing: _Outgoing) -> int:
        """The number of an array, which is sent with the message if it is new."""
        number = self._number_of_array.get(id(array))
        if number is None:
            number = self._new_number()
            contents = array.tobytes()
            self._track(number, array, contents)
            layout: list = [None, 0, array.flags.writeable]
            data = contents
            if self._trusted and not array.flags.c_contiguous:
                layout, data = _describe_memory(array)
            outgoing.blocks.append(data)
            outgoing.arrays.append([number, array.dtype.str, array.shape, *layout, len(data)])
        return number

    def _track(self, number: int, array: np.ndarray, contents: bytes) -> None:
        """Look from now on whether an array is changed in place."""
        key = id(array)
        self._arrays[number] = array
        if self._trusted:
            self._arrays[number] = weakref.ref(array, partial(self._forget_array, number, key))
        self._number_of_array[key] = number
        self._snapshots[number] = contents

    def _array(self, number: int) -> Any:
        """The array with a number."""
        array = self._arrays.get(number)
        return array() if isinstance(array, weakref.ref) else array

    def _forget_array(self, number: int, key: int, reference: object) -> None:
        """Tell the other process with the next message that nobody uses an array any more."""
        self._arrays.pop(number, None)
        self._snapshots.pop(number, None)
        self._number_of_array.pop(key, None)
        self._dropped_arrays.append(number)

    def _drop_array(self, number: int) -> None:
        """Forget an array that the other process does not use any more."""
        array = self._array(number)
        self._arrays.pop(number, None)
        self._snapshots.pop(number, None)
        self._number_of_array.pop(id(array), None)

    def _drop_function(self, number: int) -> None:
        """Forget a function that the other process does not use any more."""
        function = self._functions.pop(number, None)
        self._number_of_function.pop(id(function), None)

    def _changes(self, outgoing: _Outgoing) -> list[int]:
        """The numbers of the arrays that were changed since the last message."""
        changed = []
        for number in list(self._arrays):
            array = self._array(number)
            if array is None:
                continue
            contents = array.tobytes()
            if contents != self._snapshots[number]:
                self._snapshots[number] = contents
                changed.append(number)
                outgoing.blocks.append(contents)
        return changed

    def _change(self, number: int, data: memoryview) -> int:
        """Give an array the contents that it has in the other process; returns their size."""
        array = self._array(number)
        if array is None:
            return len(self._snapshots.get(number, b""))
        changed = np.ndarray(array.shape, array.dtype, bytes(data[: array.nbytes]))
        if array.flags.writeable:
            array[...] = changed
        self._snapshots[number] = array.tobytes()
        return array.nbytes

    def _proxy(self, number: int, file: str) -> Callable:
        """A function that calls one of the other process."""
        existing = self._proxies.get(number)
        proxy = existing() if existing is not None else None
        if proxy is None:

            def call(*arguments: Any, **named: Any) -> Any:
                return self._call(number, arguments, named)

            call.remote_number = number  # type: ignore[attr-defined]
            call.remote_channel = self  # type: ignore[attr-defined]
            call.remote_file = file  # type: ignore[attr-defined]
            proxy = call
            self._proxies[number] = weakref.ref(call, partial(self._forget_proxy, number))
        return proxy

    def _forget_proxy(self, number: int, reference: object) -> None:
        """Tell the other process with the next message that nobody calls a function any more."""
        self._proxies.pop(number, None)
        self._dropped_functions.append(number)


def _describe_memory(array: np.ndarray) -> tuple[list, bytes]:
    """The strides of an array, where it begins in its memory, and the bytes of that memory.

    Without strides, these are its entries in C order.
    """
    first, end = byte_bounds(array)
    if end - first > MOST_SPARSE * array.nbytes:
        return [None, 0, array.flags.writeable], array.tobytes()
    offset = array.__array_interface__["data"][0] - first
    memory = (ctypes.c_uint8 * (end - first)).from_address(first)
    return [list(array.strides), offset, bool(array.flags.writeable)], bytes(memory)


def _array_from(description: list, contents: bytes) -> np.ndarray:
    """An array from the description that the other process sent."""
    dtype_name, shape, strides, offset, is_writeable = description
    dtype = _dtype(dtype_name)
    if strides is None:
        array = np.ndarray(tuple(shape), dtype, contents)
        if array.nbytes != len(contents):
            raise MessageError("an array of another size than its contents")
        array = array.copy()
    else:
        array = np.ndarray(tuple(shape), dtype, bytearray(contents), offset, tuple(strides))
        if array.flags.f_contiguous:
            array = array.copy(order="F")
    if not is_writeable:
        array.flags.writeable = False
    return array


def _dtype(name: str) -> np.dtype:
    """The type of an array's entries; a MessageError if it is not of an allowed kind."""
    if not isinstance(name, str) or len(name) > LONGEST_NAME:
        raise MessageError("a type of entries that is no text")
    dtype = np.dtype(name)
    if dtype.kind not in KINDS_OF_ARRAYS:
        raise MessageError("an array of an unknown kind")
    return dtype


def _as_subclass(array: np.ndarray, name: str) -> np.ndarray:
    """An array of a class with this name, which is none of NumPy's."""
    return array.view(type(_type_name(name), (np.ndarray,), {}))


def _type_name(name: str) -> str:
    """A name that a class may have."""
    if not isinstance(name, str):
        raise MessageError("a type's name that is no text")
    return name[:LONGEST_NAME].replace("\0", "")


def _file_of(function: Callable) -> str:
    """The file in which a function is written, or "" where this is unknown."""
    try:
        return str(inspect.unwrap(function).__code__.co_filename)[:LONGEST_NAME]
    except Exception:  # an object of a student's class may answer anything
        return ""


def _describe_error(error: BaseException) -> dict[str, Any]:
    """The class, message and traceback of an exception, even if its __str__ raises."""
    try:
        text = str(error)
    except BaseException:
        text = None
    frames = []
    for frame, line in list(traceback.walk_tb(error.__traceback__))[-MOST_FRAMES:]:
        frames.append([str(frame.f_code.co_filename)[:LONGEST_NAME], line])
    bases = [base.__name__ for base in type(error).__mro__ if base.__module__ == "builtins"]
    return {"type": type(error).__name__, "bases": bases, "text": text, "frames": frames}


def _rebuild_error(described: Any) -> BaseException:
    """The exception that another process describes, as far as a class of Python has its name."""
    try:
        name = _type_name(described["type"])
        base: Any = next(filter(None, map(_exception_class, described["bases"])), Exception)
        frames = tuple((str(file), int(line)) for file, line in described["frames"])
        kind = type(name, (RemoteError, base), {})
        error: Any = kind()
        error.remote_frames = frames
        error.text = described["text"]
    except (ValueError, TypeError, KeyError, AttributeError) as problem:
        raise MessageError(f"an error that cannot be read: {problem}") from None
    return error


def _exception_class(name: object) -> type | None:
    """The class of Python's exceptions with this name that a check may catch, or None."""
    named = getattr(builtins, name, None) if isinstance(name, str) else None
    if isinstance(named, type) and issubclass(named, Exception | SystemExit):
        return named
    return None


class Reader:
    """Reads what comes through a pipe.

    `at_end` is called when no more comes; it must raise.
    """

    def __init__(self, descriptor: int, at_end: Callable[[], NoReturn]) -> None:
        self._descriptor = descriptor
        self._at_end = at_end
        self._rest = b""

    def read(self, size: int) -> bytes:
        """The next so many bytes."""
        parts = [self._rest]
        missing = size - len(self._rest)
        while missing > 0:
            part = os.read(self._descriptor, max(missing, BLOCK))
            if not part:
                self._at_end()
            parts.append(part)
            missing -= len(part)
        data = b"".join(parts)
        self._rest = data[size:]
        return data[:size]


def write_all(descriptor: int, data: bytes | memoryview) -> None:
    """Write all bytes to a pipe."""
    rest = memoryview(data)
    while rest:
        rest = rest[os.write(descriptor, rest) :]
