"""Adapters of physics engines. Each engine has one folder; the modules here serve all engines.

- `contract` defines what an adapter must offer, and `links` and `robot_reading` two parts that not all adapters have.
- `method` parses and writes the spelling of a method: an integrator, its options and a time step. It says which options count.
- `engine_name` parses the name of an engine, which may have a version.
- `registry` finds adapters by name, and checks the record of an engine.
- `offers` decides which methods an engine offers for a scene, and checks methods before they are run.
- `stepping` contains the loop for engines that are stepped from Python, normalises quaternions, and steps several simulations
  one after another.
- `touching` has bodies that touch a plane or each other, and checks that a body lies flat on its plane.
- `mechanisms` has bodies on joints in the forms of engines, and `mechanism_models` larger models of them.
- `attitudes` converts states of engines that step along the principal axes, and attitudes that are rotation vectors.
- `robot_files` and `robot_numbers` have what the readers of robot models share.
- `quiet` keeps what engines write in C from the terminal.
- Every folder contains one engine; its module `engine` is the adapter, and its first lines say what the methods are.
"""
