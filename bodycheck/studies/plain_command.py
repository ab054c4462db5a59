"""The command of a study that has no module `command`; see `plain`.

The imports are inside the function, so that `--help` answers at once.
"""

import sys
from collections.abc import Callable, Iterator

from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import (
    AS_USUAL,
    CaseName,
    Engines,
    Figures,
    Integrators,
    Jobs,
    Json,
    OfRobots,
    Out,
    Quiet,
    Viewed,
)
from bodycheck.studies import registry


def command(name: str) -> Callable[..., int]:
    """Return the command of a study."""

    def study(
        *cases: CaseName,
        engine: Engines = (),
        integrator: Integrators = (),
        robots: OfRobots = AS_THEY_ARE,
        out: Out = None,
        figures: Figures = (),
        jobs: Jobs = None,
        json: Json = False,
        view: Viewed = AS_USUAL,
        quiet: Quiet = False,
    ) -> int:
        from bodycheck.console import terminal
        from bodycheck.console.arguments import check_has_folder, load_engines, processes, read_cases, tell_left_out
        from bodycheck.console.output import end
        from bodycheck.studies import plain
        from bodycheck.studies.output import Output

        check_has_folder(figures, out)
        plain.check_view(name, view)
        read = read_cases(cases, robots)
        tell_left_out(read)
        loaded = plain.suited(name, read.cases, named=bool(cases))
        engines = load_engines(engine, integrators=integrator)
        results = plain.carry_out(name, loaded, engines, integrator, sys.argv, processes(jobs), Output(out, figures, quiet))
        if json:
            first, *others = results.tables
            terminal.print_json({"rows": results.tables[first].rows} | {table: results.tables[table].rows for table in others})
        elif not quiet:
            plain.print_tables(name, results, view)
        decision = plain.decided(name, results, engines, loaded, failed=bool(read.faults))
        return end(decision, out, json=json, quiet=quiet)

    study.__name__ = study.__qualname__ = name
    study.__doc__ = registry.about(name)
    return study


def of_studies() -> Iterator[Callable[..., int]]:
    """Yield the commands of all studies."""
    for name in registry.STUDIES:
        module = registry.part(name, "command")
        yield from (command(name),) if module is None else module.COMMANDS
