"""Measure how often intervals are right."""

from collections.abc import Sequence


def printed(engines: Sequence[str], *, json: bool, quiet: bool) -> int:
    """Print the calibration."""
    raise NotImplementedError
