"""C++ functions of Simbody's libraries that OpenSim's Python package does not have."""

import ctypes
from pathlib import Path
from typing import Any

import opensim


def function(library: str, name: str, arguments: tuple[Any, ...], result: Any = None) -> Any | None:
    """Return a C++ function from a library of the package, which is loaded already; None if there is none.

    Parameters
    ----------
    library, name
        The name of the library without its ending, and that of the function as the compiler spells it.
    arguments, result
        The types of the arguments and of the result, as `ctypes` has them.
    """
    files = sorted(Path(opensim.__file__).parent.glob(f"{library}.*"))
    try:
        library_function = getattr(ctypes.CDLL(str(files[0])), name)
    except (IndexError, OSError, AttributeError):
        return None
    library_function.argtypes, library_function.restype = arguments, result
    return library_function
