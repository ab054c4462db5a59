"""Tests of the adapter of Simbody."""
