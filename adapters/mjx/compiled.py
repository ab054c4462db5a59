"""Simulations whose steps JAX compiles, in the precision of the process."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import jax
import numpy as np
from jax import numpy as jnp

from bodycheck.adapters.contract import Engine, Strides
from bodycheck.reference.trajectory import Array

#: The number of strides that one compiled call takes. Fewer strides are filled up with strides of no steps.
STRIDES_PER_CALL = 64


def check_precision(engine: Engine) -> None:
    """Raise `RuntimeError` if JAX's precision in this process differs from the precision in the engine's record."""
    if (precision := np.dtype(jnp.float64 if jax.config.jax_enable_x64 else jnp.float32).name) != engine.precision:
        raise RuntimeError(
            f"JAX computes in {precision} in this process, and {engine.name} in {engine.precision}: "
            f"the environment variable JAX_ENABLE_X64 must be {'true' if engine.precision == 'float64' else 'false'}"
        )


def device() -> Literal["cpu", "cuda"]:
    """Return the kind of device on which JAX computes in this process."""
    return "cpu" if jax.default_backend() == "cpu" else "cuda"


@dataclass(frozen=True)
class Strider:
    """Two compiled functions that take `STRIDES_PER_CALL` strides.

    The function `one` takes one state, and `several` takes several states of one system.
    """

    one: Any
    several: Any


def strider(step: Callable[[Any, Any], Any], seen: Callable[[Any], Any]) -> Strider:
    """Return compiled functions that take `STRIDES_PER_CALL` strides.

    The system is an argument of these functions and not a constant, so that all systems of the same structure share compiled
    code.

    Parameters
    ----------
    step
        Returns the state of the engine one step after a state, from the system and that state.
    seen
        Returns the numbers (k,) that describe a state.

    Returns
    -------
    Functions of the system, the state and the numbers of steps (`STRIDES_PER_CALL`,). They return the state after all strides
    and the numbers (`STRIDES_PER_CALL`, k) after each stride. Several states, and their numbers, have an additional first axis.
    """

    def taken(system: Any, state: Any, strides: Any) -> Any:
        def stride(state: Any, steps: Any) -> Any:
            state = jax.lax.fori_loop(0, steps, lambda _, state: step(system, state), state)
            return state, seen(state)

        return jax.lax.scan(stride, state, strides)

    return Strider(jax.jit(taken), jax.jit(jax.vmap(taken, in_axes=(None, 0, None))))


@dataclass
class Compiled:
    """A simulation of one or several scenes with one body, or of a mechanism, whose steps are compiled when it is built.

    Parameters
    ----------
    take
        The function of a `Strider` for one state or for several.
    system, state
        The system and its current state or states, in the forms that the engine uses.
    rows
        Converts the numbers (..., k) of states to rows (..., 13) in the columns of `Simulation.advance`, or (..., bodies, 13).
    bodies
        The number of bodies.
    """

    take: Any
    system: Any
    state: Any
    rows: Callable[[Array], Array]
    bodies: int = 1

    def __post_init__(self) -> None:
        # A state that differs in type or place from the one that a call returns would make JAX compile the steps twice.
        state = jax.tree.map(lambda leaf: jnp.asarray(leaf, dtype=jnp.result_type(leaf)), self.state)
        self.state = jax.device_put(state, jax.devices()[0])
        self.seen(np.zeros(1, dtype=np.int64))

    def advance(self, strides: Strides) -> Array:
        """Return the states (scenes, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        return self.rows(self.seen(strides)).reshape(-1, len(strides), self.bodies, 13)

    def seen(self, strides: Strides) -> Array:
        """Take n >= 1 strides, and return the numbers that describe the states after each: (n, k), or (scenes, n, k)."""
        parts = []
        for first in range(0, len(strides), STRIDES_PER_CALL):
            part = strides[first : first + STRIDES_PER_CALL]
            filled = np.zeros(STRIDES_PER_CALL, dtype=np.int32)
            filled[: len(part)] = part
            self.state, seen = self.take(self.system, self.state, filled)
            parts.append(np.array(seen, dtype=np.float64)[..., : len(part), :])
        return np.concatenate(parts, axis=-2)
