"""Trials that fail, each in its own way, for the test of what makes trials."""

import os
import time
from pathlib import Path


def fails_sometimes(seed: int, folder: Path) -> str:
    """Raises, dies, hangs or answers with a fault where the seed is odd."""
    match seed:
        case 1:
            raise ZeroDivisionError
        case 3:
            os._exit(3)
        case 5:
            Path(os.environ["HANGS"]).touch()
            time.sleep(600)
        case 7:
            return "something is wrong"
    return ""
