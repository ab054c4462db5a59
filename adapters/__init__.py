"""Adapters of physics engines. Each engine has one folder; the modules here serve all engines.

- `contract` defines what an adapter must offer; `links` and `robot_reading` define two optional parts of an adapter.
- `method` parses and writes the spelling of a method: an integrator, its options and a time step. It also defines which values
  of an option are allowed.
- `engine_name` parses the name of an engine, which may have a version.
- `registry` finds adapters by name, and checks the record of an engine.
- `offers` decides which methods an engine offers for a scene, and checks methods before they are run.
- `stepping` contains the loop for engines that are stepped from Python, normalises quaternions, and steps several simulations
  one after another.
- `touching` describes bodies that touch a plane or each other, and checks that a body lies flat on its plane.
- `mechanisms` converts bodies on joints to the forms that engines take, and `mechanism_models` builds larger models of them.
- `attitudes` converts states of engines that step along the principal axes, and attitudes that are rotation vectors.
- `robot_numbers` contains functions that the readers of robot models share; `file_motion` is the contract of engines that run a
  whole scene from a robot's file.
- `quiet` keeps the output of C code from the terminal.
- Every folder contains the adapter of one engine, as its module `engine`; the docstring of the folder describes the methods.
"""
