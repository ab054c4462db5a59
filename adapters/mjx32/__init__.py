"""The adapter of MJX in single precision, which is JAX's default precision, on the CPU.

Everything else is as in `bodycheck.adapters.mjx`, whose modules this adapter shares. The states are numbers of single
precision: a length of 100 m is known to 4 micrometres, and a step adds a rounding error to every coordinate.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation(
    "mujoco-mjx",
    variables={
        "JAX_PLATFORMS": "cpu",
        "JAX_ENABLE_X64": "false",
        "JAX_COMPILATION_CACHE_DIR": "{environment}/jax-cache",
    },
    modules=("jax", "mujoco"),
)
