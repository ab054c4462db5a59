"""Methods that an adapter offers only to demonstrate something, and that users would not choose."""

from collections.abc import Iterable, Mapping

from bodycheck.results.header import Header
from bodycheck.results.key import RunKey


def demonstrated(header: Header, keys: Iterable[RunKey]) -> Mapping[RunKey, str]:
    """Return the purpose of each method that is a demonstration; other methods are left out.

    Parameters
    ----------
    header
        The header of the results, or of all sets of results together.
    keys
        The methods over all cases; see `RunKey.over_cases`.
    """
    named = header["demonstrations"]
    told = {key: named.get(key.engine, {}).get(key.method.integrator, "") for key in keys}
    return {key: text for key, text in told.items() if text}
