"""Physics engines behind one contract: one folder an engine, and what all of them share.

- `contract`: what an adapter is. `method`: an integrator with options and time step, parsed once. `registry`: adapters by name.
- `offers`: what the core does once for all adapters. `stepping`: the loop of engines that are stepped from Python.
- `mujoco/`, `pinocchio/`: an engine each; `engine` is the adapter, its other modules are its parts.
"""
