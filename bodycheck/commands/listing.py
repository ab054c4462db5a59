"""The command `bodycheck cases`.

The imports are inside the functions, so that `--help` answers at once.
"""

from bodycheck.console import arguments
from bodycheck.console.options import AS_USUAL, Json, Viewed
from bodycheck.errors import OK


def cases(*, requires: bool = False, json: Json = False, view: Viewed = AS_USUAL) -> int:
    """List the cases that come with bodycheck.

    Parameters
    ----------
    requires
        Also print which properties a model needs to represent each scene exactly.
    """
    from bodycheck.casefile.case import shipped
    from bodycheck.console import tables, terminal
    from bodycheck.reference.requirements import COLUMNS, as_row

    if not requires:
        tables.check(view, terminal.CASES)
    loaded = arguments.load_cases(shipped())
    if requires:
        tables.check(view, terminal.requirement_columns(COLUMNS))
        needs = {case.name: as_row(case.scene) for case in loaded}
        if json:
            terminal.print_json([{"name": name, **needed} for name, needed in needs.items()])
        else:
            shown = [name for name in COLUMNS if any(name in row for row in needs.values())]
            terminal.print_requirements({case: dict.fromkeys(shown, False) | row for case, row in needs.items()}, view)
    elif json:
        terminal.print_json([{"name": c.name, "title": c.title, "source": c.source, "tags": c.tags} for c in loaded])
    else:
        tables.show(terminal.CASES, loaded, view)
    return OK
