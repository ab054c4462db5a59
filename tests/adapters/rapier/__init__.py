"""Tests of the adapter of Rapier."""
