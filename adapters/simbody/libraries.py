"""C++ functions of Simbody's libraries that OpenSim's Python package does not have."""

import ctypes
from pathlib import Path
from typing import Any

import opensim

#: The library of Simbody's integrators, and C++ functions of the class `Integrator`, by their names in it: the accuracy in use,
#: and the numbers of steps taken, of steps attempted, and of realizations, which are evaluations of the accelerations.
LIBRARY = "libSimTKmath"
ACCURACY_IN_USE = "_ZNK5SimTK10Integrator16getAccuracyInUseEv"
STEPS_TAKEN = "_ZNK5SimTK10Integrator16getNumStepsTakenEv"
STEPS_ATTEMPTED = "_ZNK5SimTK10Integrator20getNumStepsAttemptedEv"
REALIZATIONS = "_ZNK5SimTK10Integrator18getNumRealizationsEv"


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


#: Whether Simbody's library has all of these functions.
COUNTS = all(function(LIBRARY, name, ()) for name in (ACCURACY_IN_USE, STEPS_TAKEN, STEPS_ATTEMPTED, REALIZATIONS))


def told(manager: Any, name: str, result: Any = ctypes.c_int) -> Any:
    """Return what a C++ function of the integrator of a manager returns, of a `ctypes` type."""
    integrator_function = function(LIBRARY, name, (ctypes.c_void_p,), result)
    assert integrator_function is not None
    return integrator_function(int(manager.getIntegrator()))
