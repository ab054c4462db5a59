"""The angular velocity (rad/s, world) of a free brick after a second in Brax's three pipelines; it starts at (0, 2, 2)."""

import contextlib
import io
import warnings

warnings.simplefilter("ignore")
import jax
from jax import numpy as jnp

jax.config.update("jax_enable_x64", True)
with contextlib.redirect_stdout(io.StringIO()):
    from brax.generalized import pipeline as generalized
    from brax.io import mjcf
    from brax.positional import pipeline as positional
    from brax.spring import pipeline as spring

XML = """<mujoco><option timestep="0.002"/><worldbody><body><freejoint/><inertial pos="0 0 0" mass="1"
diaginertia="0.3 0.4 0.6"/><geom type="sphere" size="1" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""

for name, pipeline in (("generalized", generalized), ("positional", positional), ("spring", spring)):
    system = mjcf.loads(XML).replace(gravity=jnp.zeros(3))
    state = pipeline.init(system, jnp.array([0.0, 0, 0, 1, 0, 0, 0]), jnp.array([0.0, 0, 0, 0, 2, 2]))
    step = jax.jit(lambda state, system=system, pipeline=pipeline: pipeline.step(system, state, jnp.zeros(0)))
    for _ in range(500):
        state = step(state)
    for axis, letter in enumerate("xyz"):
        print(f"{name}_{letter} {state.xd.ang[0, axis]:.6g}")
