"""Accuracy against cost: which methods of an engine are compared in a scene, and their picture."""
