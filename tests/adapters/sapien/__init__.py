"""Tests of the adapter of PhysX by SAPIEN."""
