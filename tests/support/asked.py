"""What the command line of pytest asks for, known already while tests are collected."""

import sys

#: The option that names the one engine whose adapter is tested.
ADAPTER_OPTION = "--adapter"

#: The option that writes the golden pages instead of comparing reports with them.
RENEW_OPTION = "--renew-golden"


def adapter_asked_for() -> str | None:
    """Return the engine that `--adapter NAME` names; None if it is not given."""
    words = sys.argv[1:]
    return words[words.index(ADAPTER_OPTION) + 1] if ADAPTER_OPTION in words else None
