"""The command `bodycheck truth`.

Its imports are inside the function, so that `--help` answers at once.
"""

import sys
from typing import Annotated

from cyclopts import Parameter

from bodycheck.console import arguments
from bodycheck.console.options import AS_USUAL, Json, Viewed
from bodycheck.errors import FAILED, OK, BadInput


def truth(
    case: str,
    /,
    *,
    at: Annotated[tuple[float, ...], Parameter(consume_multiple=True)] = (),
    certify: bool = False,
    json: Json = False,
    view: Viewed = AS_USUAL,
) -> int:
    """Print the reference trajectory of a case, and a bound of its error.

    Parameters
    ----------
    case
        The name of a shipped case, or the path of a case file.
    at
        Instants in s, in any order. By default, the sampling times of the case.
    certify
        Also compute the trajectory by all other methods, and print how far they are apart and how large the error of the
        truth is at most according to the most accurate of them. The exit code is 1 if two methods are farther apart than their
        own error bounds allow.
    """
    from bodycheck.console import tables, terminal
    from bodycheck.console import truths as printing
    from bodycheck.reference.errors import NotModelled, OutOfReach
    from bodycheck.running import truths

    tables.check(view, printing.STATES)
    loaded = arguments.load_case(case)
    if not all(0 <= instant < float("inf") for instant in at):
        raise BadInput("--at: instants must be finite and at least 0 s")
    times = sorted(at) or None
    try:
        certificate = truths.certify(loaded, times) if certify else None
        found = certificate.truth if certificate else truths.truth(loaded, times)
    except NotModelled as error:
        print(f"{loaded.name}: unsupported: the reference does not model {error}", file=sys.stderr)
        return FAILED
    except OutOfReach as error:
        print(f"{loaded.name}: the reference cannot follow this motion: {error}", file=sys.stderr)
        return FAILED
    if json:
        terminal.print_json(truths.as_json(loaded, found) | (truths.certificate_as_json(certificate) if certificate else {}))
    else:
        printing.print_truth(found, len(at) or 11, view)
        if certificate:
            printing.print_certificate(certificate)
    for fault in certificate.faults if certificate else ():
        print(f"not certified: {fault}", file=sys.stderr if json else sys.stdout)
    return OK if certificate is None or certificate.certified else FAILED
