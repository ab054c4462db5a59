"""Record what an engine computes with Warp as a graph, on the CPU.

Starting a kernel from Python takes about 20 microseconds, and a step of an engine starts dozens of them. Warp records them once
as a graph, with all their arguments, and replays the graph in a loop in C++: the same kernels on the same arrays.
"""

from collections.abc import Callable
from typing import Any, Literal

import warp as wp

from bodycheck.adapters.quiet import no_stderr

#: The function by which a step is taken, looked up at each call.
CALLS: tuple[tuple[Any, str], ...] = ((wp, "capture_launch"),)

# Otherwise Warp prints to standard output when it begins, and for every module that it compiles.
wp.config.log_level = wp.LOG_WARNING
with no_stderr():  # on a machine without a GPU, a warning that there is none
    wp.init()

#: The device of all arrays, also where there is a GPU: the views by which states are read are those of arrays on the CPU.
DEVICE: Literal["cpu"] = "cpu"
wp.set_device(DEVICE)


def record(work: Callable[[], None]) -> Any:
    """Return the graph of all kernels that a function starts. They are compiled, but nothing is computed yet.

    The graph keeps the arrays that its kernels read and write.
    """
    with wp.ScopedCapture(device=DEVICE, force_module_load=False) as capture:
        work()
    return capture.graph


def replay(graph: Any) -> Any:
    """Compute what a graph has recorded, and return the graph."""
    wp.capture_launch(graph)
    return graph
