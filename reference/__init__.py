"""The reference: the rigid-body mechanics that engines are compared with.

It implements R. F. Gans, *Engineering Dynamics: From the Lagrangian to Simulation*, Springer 2013, chapter 2, with the
corrections listed in docs/errata.md. Docstrings cite its equation n as [G n], and equation n of the NIST Digital Library of
Mathematical Functions as [DLMF n]. The package depends on NumPy, SciPy, mpmath and, where it is installed, heyoka; it does not
depend on engines, case files or reports.

Start here:

- `truth`: the reference trajectory of a scene with the bound of its own error. This is the entry point of the package.
  `truths` defines what it returns, and `certified` what `certificate` returns.
- `witnesses`: independent ways of computing a flight, and whether each can follow the motion. `witness`: the result of one way,
  and the comparison of two results.
- `certificate`: every way of computing one truth, compared with every other.
- `scene`: bodies, initial states, planes, and the content of a file about a body and its start. `trajectory`: sampled states.
  `bounds`: bounds of the errors of sampled states. All other modules use them.
- `bodies`: the bodies of any scene in one view, in which a single body is treated as a mechanism with one body.
- `scenes`: many scenes in free flight that differ in numbers only, as arrays.
- `errors`: the exceptions for scenes and motions that the reference cannot compute.

Mechanics of any motion:

- `kinematics`: quaternions, Euler angles and angular velocity. `inertia`: inertia tensors, angular momentum, and
  conversion between a body's frame and its principal axes.
- `observables`: energies and angular momentum of a trajectory. `contact_observables`: extent, tilt, penetration and stop of a
  body on the plane.
- `planar`: the planar state of a body that lies flat. `requirements`: what a model of a scene must contain to be exact.
  `modelled`: whether the reference has such a model.

Folders:

- `exact`: the quantities that follow from the numbers of a file, computed with a hundred digits.
- `flight`: free flight in closed form, and drag.
- `sliding`: a flat body that slides and spins on a plane with Coulomb friction.
- `contact`: bodies that roll, bounce, rest and tip on a plane and on each other.
- `mechanisms`: bodies on joints, in trees and closed chains.
- `sensors`: what sensors read, and the truth of their readings.
- `robots`: the terms of the equations of motion of robot models.
- `integration`: numerical integration of the equations of motion of a free body, in double, 80-bit and 128-bit arithmetic.
- `independent`: a second computation of the motion from the file, which shares no mechanics with the first.
- `schemes`: textbook one-step schemes, with which the schemes of engines are identified.
- `chapter`: tools of the book's chapter that no truth needs: orientation, particles, wobble.

Imports run in one direction: `certificate` imports `truth`, `truth` imports `witnesses`, and these import the folders of
motions. `sensors` imports `truth` and these folders. `contact` and `schemes` import `mechanisms`; `mechanisms` imports tools of
`flight`, `independent` and `robots`; all of them may import `integration` and `exact`, but `independent` imports only numerical
tools of `integration`. `scene`, `trajectory`, `bounds` and `errors` import only one another from this package.
"""
