"""Print how far a hinge at 2 rad/s goes beyond a limit of 40 N m/rad and 0.3 N m s/rad in Brax, by its impedance."""

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

XML = """<mujoco><compiler angle="radian"/><option timestep="0.0005" gravity="0 0 0"/><worldbody><body>
<joint axis="0 1 0" limited="true" range="-1 0.1" solreflimit="{} {}" solimplimit="{} {} 0.001 0.5 1"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/><geom size="0.1" contype="0" conaffinity="0"/></body></worldbody>
</mujoco>"""

for name, impedance in (("large", 0.5), ("small", 0.1), ("smaller", 0.01), ("smallest", 1e-4)):
    scale = -(1 - impedance) / 0.01
    system = mjcf.loads(XML.format(40 * scale, 0.3 * scale, impedance, impedance))
    state, angles = pipeline.init(system, jnp.zeros(1), jnp.array([2.0])), []
    step = jax.jit(lambda state, system=system: pipeline.step(system, state, jnp.zeros(0)))
    for _ in range(600):
        state = step(state)
        angles.append(float(state.q[0]))
    print(f"{name}_beyond {max(angles) - 0.1 if angles[-1] == angles[-1] else 'nan'}")
