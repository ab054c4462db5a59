"""The adapter of MJX in double precision; see `bodycheck.adapters.mjx`."""

from functools import partial

from bodycheck.adapters.mjx import INSTALLATION, robots, sensing, simulation
from bodycheck.adapters.mujoco import engine as adapter

engine = simulation.record("mjx", INSTALLATION.distribution, "float64")
prepare, prepare_links = partial(simulation.prepare, engine), partial(simulation.prepare_links, engine)
read_robot = partial(robots.read_robot, engine)
contact_law, contact_load = adapter.contact_law, partial(simulation.contact_load, engine)
lacking, prepare_sensing = sensing.lacking, partial(sensing.prepare_sensing, engine)
