"""The adapter of MJX in single precision; see `bodycheck.adapters.mjx32`."""

from functools import partial

from bodycheck.adapters.mjx import robots, sensing, simulation
from bodycheck.adapters.mjx32 import INSTALLATION
from bodycheck.adapters.mujoco import engine as adapter

engine = simulation.record("mjx32", INSTALLATION.distribution, "float32")
prepare, prepare_links = partial(simulation.prepare, engine), partial(simulation.prepare_links, engine)
read_robot = partial(robots.read_robot, engine)
contact_law, contact_load = adapter.contact_law, partial(simulation.contact_load, engine)
lacking, prepare_sensing = sensing.lacking, partial(sensing.prepare_sensing, engine)
