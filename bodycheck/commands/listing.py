"""The commands `bodycheck cases` and `bodycheck engines`.

The imports are inside the functions, so that `--help` answers at once.
"""

from bodycheck.console import arguments
from bodycheck.console.options import AS_USUAL, Json, Viewed
from bodycheck.errors import FAILED, OK


def cases(*, requires: bool = False, json: Json = False, view: Viewed = AS_USUAL) -> int:
    """List the cases that come with bodycheck.

    Parameters
    ----------
    requires
        Also print which properties a model needs to represent each scene exactly.
    """
    from dataclasses import asdict, fields

    from bodycheck.casefile.case import shipped
    from bodycheck.console import tables, terminal
    from bodycheck.reference.requirements import Requirements, requirements

    if not requires:
        tables.check(view, terminal.CASES)
    loaded = arguments.load_cases(shipped())
    if requires:
        tables.check(view, terminal.requirement_columns(field.name for field in fields(Requirements)))
        needs = {case.name: asdict(requirements(case.scene)) for case in loaded}
        if json:
            terminal.print_json([{"name": name, **needed} for name, needed in needs.items()])
        else:
            terminal.print_requirements(needs, view)
    elif json:
        terminal.print_json([{"name": c.name, "title": c.title, "source": c.source, "tags": c.tags} for c in loaded])
    else:
        tables.show(terminal.CASES, loaded, view)
    return OK


def engines(
    *,
    check: bool = False,
    json: Json = False,
    view: Viewed = AS_USUAL,
) -> int:
    """List the engines with their versions and integrators.

    Parameters
    ----------
    check
        Also test each adapter with scenes whose solution is obvious. The exit code is 1 if a test fails,
        or an installed engine when it is imported.
    """
    from bodycheck.adapters import offers
    from bodycheck.console import tables, terminal
    from bodycheck.running import smoke

    tables.check(view, terminal.ENGINES)
    loaded = arguments.load_engines(())
    adapters, missing = loaded.adapters, loaded.missing
    faults = smoke.check_all(tuple(adapters)) if check else {}
    if json:
        checked: dict[str, dict[str, list[str]]] = {name: {"faults": found} for name, found in faults.items()}
        terminal.print_json(
            [
                {"name": name, "version": adapter.engine.version, "integrators": offers.listed(adapter.engine)}
                | checked.get(name, {})
                for name, adapter in adapters.items()
            ]
            + [{"name": name, "missing": why} for name, why in missing.items()]
        )
    else:
        rows = [(name, own.engine.version, ", ".join(offers.listed(own.engine))) for name, own in adapters.items()]
        tables.show(terminal.ENGINES, rows + [(name, "-", why) for name, why in missing.items()], view)
        for name, found in faults.items():
            print("\n".join(found) if found else f"{name}: adapter check passed")
    return FAILED if any(faults.values()) or (check and loaded.broken) else OK
