"""Enclosures of motions in ball arithmetic (python-flint): proofs, which share no code with any way to a truth.

A ball is a midpoint with a radius, and every operation encloses its exact result (Johansson, IEEE Trans. Comput. 66, 2017). The
proof of a scene starts from its numbers, which are taken as exact, and ends with balls that contain the exact states. The
doubles that were printed are then compared with the balls, however they were computed. A proof does not cover the reader of
case files, the equations of motion, and python-flint.
"""
