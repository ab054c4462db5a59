"""The adapter of MJX in single precision; see `bodycheck.adapters.mjx32`."""

from functools import partial

from bodycheck.adapters.mjx import adapter as shared
from bodycheck.adapters.mjx import robots, sensing, simulation, touching
from bodycheck.adapters.mjx32 import INSTALLATION
from bodycheck.adapters.mujoco import engine as of_mujoco

engine = shared.record("mjx32", INSTALLATION.distribution, "float32")
prepare, prepare_links = partial(shared.prepare, engine), partial(simulation.prepare_links, engine)
read_robot = partial(robots.read_robot, engine)
contact_law, contact_load = of_mujoco.contact_law, partial(simulation.contact_load, engine)
interface_loads, contact_terms = partial(touching.interface_loads, engine), of_mujoco.contact_terms
lacking, prepare_sensing = sensing.lacking, partial(sensing.prepare_sensing, engine)
