"""Record the kernels that an engine starts with Warp as a graph, on the CPU.

Starting a kernel from Python takes about 20 microseconds, and a step of an engine starts dozens of kernels. Warp records them
once as a graph, with all their arguments, and replays the graph in a loop in C++: the same kernels on the same arrays.
"""

from collections.abc import Callable
from typing import Any, Literal

import warp as wp

from bodycheck.adapters.quiet import no_stderr

#: The function by which a step is taken, looked up at each call.
CALLS: tuple[tuple[Any, str], ...] = ((wp, "capture_launch"),)

# Without this, Warp prints to standard output when it starts, and for every module that it compiles.
wp.config.log_level = wp.LOG_WARNING
with no_stderr():  # Warp warns on a machine without a GPU
    wp.init()

#: The device of all arrays, even on a machine with a GPU: states are read through views of arrays, which must be on the CPU.
DEVICE: Literal["cpu"] = "cpu"
wp.set_device(DEVICE)


def record(work: Callable[[], None]) -> Any:
    """Return the graph of all kernels that a function starts. The kernels are compiled, but not executed.

    The graph keeps references to the arrays that its kernels read and write.
    """
    with wp.ScopedCapture(device=DEVICE, force_module_load=False) as capture:
        work()
    return capture.graph


def replay(graph: Any) -> Any:
    """Execute the kernels of a graph, and return the graph."""
    wp.capture_launch(graph)
    return graph
