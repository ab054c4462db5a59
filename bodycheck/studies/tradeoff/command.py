"""The commands `bodycheck tradeoff` and `bodycheck recommend`.

The imports are inside the functions, so that `--help` answers at once.
"""

from typing import Literal

from bodycheck.console.options import (
    AS_USUAL,
    CaseName,
    Engines,
    Figures,
    Integrators,
    Jobs,
    Json,
    Out,
    Quiet,
    Timesteps,
    Viewed,
)
from bodycheck.errors import FAILED, OK, BadInput


def tradeoff(
    *cases: CaseName,
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    out: Out = None,
    figures: Figures = (),
    jobs: Jobs = None,
    json: Json = False,
    view: Viewed = AS_USUAL,
    quiet: Quiet = False,
) -> int:
    """Measure error and cost of every method over a range of time steps.

    The report also contains the order of convergence of every method and the textbook scheme that it agrees with. The default
    time steps suit the case; orders need five or more time steps. Costs are measured with one process. The tables are
    tradeoff.csv and orders.csv.
    """
    from dataclasses import asdict

    from bodycheck import reports
    from bodycheck.console import tables, terminal
    from bodycheck.console.arguments import check_has_folder
    from bodycheck.console.output import say_where
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging import judgement
    from bodycheck.running import origin
    from bodycheck.studies.tradeoff import printing, study
    from bodycheck.studies.tradeoff.page import present

    check_has_folder(figures, out)
    tables.check(view, printing.RUNS, printing.METHODS)
    with ran(Selection(cases, engine, integrator, timestep, jobs), study.plan, out, quiet) as made:
        results, adapters = made.results, made.adapters
        verdicts = judgement.judge(results)
        with terminal.progress("measuring", 2 * len(results.cases), quiet) as progress:
            rows = study.price(results, verdicts, adapters, progress)
            orders = study.orders(results, verdicts, adapters, progress)
        if out is not None:
            study.write(rows, orders, out, [origin.stored(results.header)])
            reports.write_study(present(results.header, rows, orders), out, figures)
    if json:
        terminal.print_json({"rows": rows, "orders": [asdict(order) for order in orders]})
    elif not quiet:
        printing.print_tradeoff(rows, orders, view)
    say_where(out, quiet)
    return FAILED if made.engine_failed else OK


def recommend(
    case: str,
    /,
    *,
    error: float,
    quantity: Literal["attitude", "position", "energy", "angular_momentum"] = "attitude",
    engine: Engines = (),
    integrator: Integrators = (),
    timestep: Timesteps = (),
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Find the cheapest methods that keep an error below a limit. All are measured; nothing is extrapolated.

    The default time steps suit the case. Costs are measured with one process.

    Exit codes: 0 a method was found; 1 no method keeps the limit; 2 bad input or usage.

    Parameters
    ----------
    case
        The name of a shipped case, or the path of a case file.
    error
        The largest allowed error, in rad for the attitude, in m for the position, and relative for the others.
    quantity
        The quantity whose error is limited. Default: attitude.
    """
    from dataclasses import asdict

    from bodycheck.console import terminal
    from bodycheck.console.ran import Selection, ran
    from bodycheck.judging import judgement
    from bodycheck.studies.tradeoff import printing, recommendation, study

    if not error > 0:
        raise BadInput(f"--error {error:g}: must be positive")
    with ran(Selection((case,), engine, integrator, timestep, jobs), study.plan, None) as made:
        results, adapters = made.results, made.adapters
        with terminal.progress("measuring", 1) as progress:
            rows = study.price(results, judgement.judge(results), adapters, progress)
        (name,) = results.cases
    found = recommendation.recommend(rows, quantity, error)
    front = recommendation.pareto(rows, quantity)
    if json:
        document = {"case": name, "quantity": quantity, "error": error}
        terminal.print_json(
            document | {"recommended": [asdict(entry) for entry in found], "pareto": [asdict(method) for method in front]}
        )
    else:
        printing.print_recommendations(found, front, quantity, error)
    return OK if found and not made.engine_failed else FAILED
