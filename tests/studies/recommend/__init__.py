"""Tests of the study of the time step that an accuracy needs."""
