"""How far (m) a body slides in a second down a rail at 30 degrees in Brax, without friction: g t^2 sin(30) / 2 = 2.4525 m."""

import contextlib
import io
import warnings

import jax
from jax import numpy as jnp

warnings.simplefilter("ignore")
jax.config.update("jax_enable_x64", True)
with contextlib.redirect_stdout(io.StringIO()):
    from brax.generalized import pipeline
    from brax.io import mjcf

XML = """<mujoco><compiler angle="degree"/><option timestep="0.002"/><worldbody><body euler="0 {turned} 0">
<joint type="slide" axis="{axis}"/><inertial pos="0 0 0" mass="1" diaginertia="0.3 0.4 0.6"/>
<geom type="sphere" size="1" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""

# The same rail, given by the attitude of the body's frame, or by the axis in a frame along the axes of the world.
for name, turned, axis in (("turned_frame", 30, "1 0 0"), ("oblique_axis", 0, "0.8660254037844387 0 -0.5")):
    system = mjcf.loads(XML.format(turned=turned, axis=axis))
    state = pipeline.init(system, jnp.zeros(1), jnp.zeros(1))
    step = jax.jit(lambda state, system=system: pipeline.step(system, state, jnp.zeros(0)))
    for _ in range(500):
        state = step(state)
    print(f"{name} {state.q[0]:.6g}")
