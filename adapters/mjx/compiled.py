"""Simulations whose steps JAX compiles, in the precision of the process."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np
from jax import numpy as jnp

from bodycheck.adapters.contract import Engine, Strides, single
from bodycheck.reference.trajectory import Array

#: The number of strides that one compiled call takes. A call with fewer strides is filled up with strides of no steps.
STRIDES_PER_CALL = 64


def check_precision(engine: Engine) -> None:
    """Raise `RuntimeError` if JAX computes in another precision in this process than the engine's record says."""
    if (own := np.dtype(jnp.float64 if jax.config.jax_enable_x64 else jnp.float32).name) != engine.precision:
        raise RuntimeError(
            f"JAX computes in {own} in this process, and {engine.name} in {engine.precision}: "
            f"the environment variable JAX_ENABLE_X64 must be {'true' if engine.precision == 'float64' else 'false'}"
        )


def strider(step: Callable[[Any, Any], Any], seen: Callable[[Any], Any]) -> Any:
    """Return a compiled function that takes `STRIDES_PER_CALL` strides.

    The system is an argument of it and not a constant, so that all systems of the same structure share compiled code.

    Parameters
    ----------
    step
        Returns the state of the engine one step after a state, from the system and that state.
    seen
        Returns the numbers (k,) that describe a state.

    Returns
    -------
    A function of the system, the state and the numbers of steps (`STRIDES_PER_CALL`,), which returns the state after all
    strides and the numbers (`STRIDES_PER_CALL`, k) after each.
    """

    def taken(system: Any, state: Any, strides: Any) -> Any:
        def stride(state: Any, steps: Any) -> Any:
            state = jax.lax.fori_loop(0, steps, lambda _, state: step(system, state), state)
            return state, seen(state)

        return jax.lax.scan(stride, state, strides)

    return jax.jit(taken)


@dataclass
class Compiled:
    """A simulation of one scene with one body, whose steps are compiled when it is built.

    Parameters
    ----------
    take
        What `strider` returns.
    system, state
        The system and its current state, in the forms that the engine uses.
    rows
        Converts the numbers (n, k) of n states to rows (n, 13) in the columns of `Simulation.advance`.
    """

    take: Any
    system: Any
    state: Any
    rows: Callable[[Array], Array]

    def __post_init__(self) -> None:
        # A state that differs in type or place from the one that a call returns would make JAX compile the steps twice.
        state = jax.tree.map(lambda leaf: jnp.asarray(leaf, dtype=jnp.result_type(leaf)), self.state)
        self.state = jax.device_put(state, jax.devices()[0])
        self.seen(np.zeros(1, dtype=np.int64))

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, 1, 13) after each of n strides, as `Simulation.advance` does."""
        return single(self.rows(self.seen(strides)))

    def seen(self, strides: Strides) -> Array:
        """Take n >= 1 strides, and return the numbers (n, k) that describe the state after each."""
        parts = []
        for first in range(0, len(strides), STRIDES_PER_CALL):
            part = strides[first : first + STRIDES_PER_CALL]
            filled = np.zeros(STRIDES_PER_CALL, dtype=np.int32)
            filled[: len(part)] = part
            self.state, seen = self.take(self.system, self.state, filled)
            parts.append(np.array(seen, dtype=np.float64)[: len(part)])
        return np.concatenate(parts)
