"""Cases that tests are made of."""

from dataclasses import replace

from bodycheck import Case


def shortened(case: Case, duration: float, samples: int) -> Case:
    """The same case with another duration (s) and number of samples, and without its expectations, which do not apply."""
    return replace(case, duration=duration, samples=samples, expectations=())
