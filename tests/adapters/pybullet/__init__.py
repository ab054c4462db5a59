"""Tests of the adapter of PyBullet."""
