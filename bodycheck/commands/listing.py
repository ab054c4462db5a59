"""The commands `bodycheck cases` and `bodycheck engines`.

The imports are inside the functions, so that `--help` answers at once.
"""

from bodycheck.console import arguments
from bodycheck.console.options import Json
from bodycheck.errors import FAILED, OK


def cases(*, requires: bool = False, json: Json = False) -> int:
    """List the cases that come with bodycheck.

    Parameters
    ----------
    requires
        Also print which properties a model needs to represent each scene exactly.
    """
    from dataclasses import asdict

    from bodycheck.casefile.case import shipped
    from bodycheck.console import terminal
    from bodycheck.reference.requirements import requirements

    loaded = arguments.load_cases(shipped())
    if requires:
        needs = {case.name: asdict(requirements(case.scene)) for case in loaded}
        if json:
            terminal.print_json([{"name": name, **needed} for name, needed in needs.items()])
        else:
            terminal.print_requirements(needs)
    elif json:
        terminal.print_json([{"name": c.name, "title": c.title, "source": c.source, "tags": c.tags} for c in loaded])
    else:
        terminal.print_table(("case", "title", "tags"), [(c.name, c.title, ", ".join(c.tags)) for c in loaded])
    return OK


def engines(
    *,
    check: bool = False,
    json: Json = False,
) -> int:
    """List the engines with their versions and integrators.

    Parameters
    ----------
    check
        Also test each adapter with scenes whose solution is obvious. The exit code is 1 if a test fails,
        or an installed engine when it is imported.
    """
    from bodycheck.adapters import offers
    from bodycheck.console import terminal
    from bodycheck.running import smoke

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
        terminal.print_table(("engine", "version", "integrators"), rows + [(name, "-", why) for name, why in missing.items()])
        for name, found in faults.items():
            print("\n".join(found) if found else f"{name}: adapter check passed")
    return FAILED if any(faults.values()) or (check and loaded.broken) else OK
