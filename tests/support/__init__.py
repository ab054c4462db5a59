"""What several tests share."""

from pathlib import Path

#: The checkout.
ROOT = Path(__file__).parents[2]

#: The folder of the miniature engines, which Python finds once it is on its path.
MINIATURES = Path(__file__).parent / "miniature"
