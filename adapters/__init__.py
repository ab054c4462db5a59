"""Adapters of physics engines. Each engine has one folder; the modules here serve all engines.

- `contract` defines what an adapter must offer.
- `method` parses and writes the spelling of a method: an integrator, its options and a time step.
- `engine_name` parses the name of an engine, which may have a version.
- `record` checks the record of an engine.
- `registry` finds adapters by name.
- `offers` decides which methods an engine offers for a scene, and checks methods before they are run.
- `stepping` contains the loop for engines that are stepped from Python, and normalises quaternions.
- `flat_contact` checks that a body lies flat on its plane.
- `principal_axes` converts the states of engines that have the principal axes as the frame of a body.
- `rotation_vectors` converts the attitudes of engines that keep them as rotation vectors.
- `threads` says in how many threads an engine may step, and `in_turn` steps several simulations one after another.
- `quiet` keeps what engines write in C from the terminal.
- Every folder contains one engine; its module `engine` is the adapter, and its first lines say what the methods are.
"""
