"""C++ functions of Simbody's libraries that OpenSim's Python package does not have."""

import ctypes
from pathlib import Path
from typing import Any

import opensim


def function(library: str, name: str, arguments: tuple[Any, ...], result: Any = None) -> Any | None:
    """Return a C++ function from a library of the package, which is already loaded; None if the library lacks the function.

    Parameters
    ----------
    library, name
        The name of the library without its ending, and the mangled name of the function.
    arguments, result
        The `ctypes` types of the arguments and of the result.
    """
    files = sorted(Path(opensim.__file__).parent.glob(f"{library}.*"))
    try:
        library_function = getattr(ctypes.CDLL(str(files[0])), name)
    except (IndexError, OSError, AttributeError):
        return None
    library_function.argtypes, library_function.restype = arguments, result
    return library_function
