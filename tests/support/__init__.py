"""What several tests share."""

from pathlib import Path

ROOT = Path(__file__).parents[2]
"""The checkout."""

MINIATURES = Path(__file__).parent / "miniature"
"""The folder of the miniature engines, which Python finds once it is on its path."""
