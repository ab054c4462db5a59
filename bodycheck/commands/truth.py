"""The command `bodycheck truth`.

Its imports are inside the function, so that `--help` answers at once.
"""

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from bodycheck.console import arguments
from bodycheck.console.arguments import AS_THEY_ARE
from bodycheck.console.options import AS_USUAL, Json, OfRobots, Viewed
from bodycheck.errors import FAILED, OK, BadInput, Failed

if TYPE_CHECKING:
    from bodycheck.reference.sensors.readings import SensorTruth
    from bodycheck.reference.truths import Truth

#: Time limit of the command, that of a truth in a run.
TIME_LIMIT_S = 300.0

#: The part of the limit after which a proof ends at an earlier instant, so that its last step and the answer fit in the limit.
PROOF_SHARE = 0.8


def truth(
    case: str,
    /,
    *,
    at: Annotated[tuple[float, ...], Parameter(consume_multiple=True)] = (),
    certify: bool = False,
    limit: float = TIME_LIMIT_S,
    robots: OfRobots = AS_THEY_ARE,
    json: Json = False,
    view: Viewed = AS_USUAL,
) -> int:
    """Print the reference trajectory of a case, and a bound of its error.

    Parameters
    ----------
    case
        The name of a shipped case, the path of a case file, or the file of a robot (URDF or MJCF).
    at
        Instants in s, in any order. By default, the sampling times of the case.
    certify
        Prove how far the printed states are from the exact motion, where there is a proof (with the extra `proof`), and
        cross-check the truth: compute the trajectory by all other methods, and print how far they are apart and how large the
        error of the truth is at most according to the most accurate of them. The cross-check is a measurement, not a proof.
        The exit code is 1 if a printed bound is smaller than the proved distance, or if two methods are farther apart than
        their own error bounds allow.
    limit
        The time limit in s. A proof that needs longer says until which instant the motion is enclosed.
    """
    from bodycheck.console import tables, terminal, truth_states
    from bodycheck.console import truths as printing
    from bodycheck.console.robots import noticed
    from bodycheck.reference.certified import Certificate
    from bodycheck.running import tasks
    from bodycheck.running.tasks import Question

    loaded = arguments.load_case(case, robots)
    tables.check(view, truth_states.columns(loaded.scene))
    if not all(0 <= instant < float("inf") for instant in at):
        raise BadInput("--at: instants must be finite and at least 0 s")
    if not limit > 0:
        raise BadInput(f"--limit {limit:g}: must be greater than 0 s")
    noticed([loaded], 1, quiet=False)
    question = Question(loaded, tuple(sorted(at)) or None, certify, PROOF_SHARE * limit)
    answered: Truth | Certificate = _answered(tasks.answer, question, loaded.name, limit)
    certificate = answered if isinstance(answered, Certificate) else None
    computed = answered.truth if isinstance(answered, Certificate) else answered
    readings: tuple[SensorTruth, ...] = ()
    if loaded.sensors:
        readings = _answered(tasks.answer_sensors, tasks.SensorQuestion(loaded, computed), loaded.name, limit)
    if json:
        from bodycheck.running import truths  # which imports all ways to a truth

        parts = truths.certificate_as_json(certificate) if certificate else {}
        sensors = truths.sensors_as_json(loaded.sensors, readings) if loaded.sensors else {}
        terminal.print_json(truths.as_json(loaded, computed) | parts | sensors)
    else:
        printing.print_truth(computed, len(at) or 11, view)
        printing.print_sensors(loaded, readings)
        if certificate:
            printing.print_certificate(certificate)
            printing.print_proof(certificate)
    for fault in certificate.faults if certificate else ():
        print(f"contradicted: {fault}", file=sys.stderr if json else sys.stdout)
    return OK if certificate is None or certificate.certified else FAILED


def _answered(compute: Callable[[Any], Any], question: Any, name: str, limit: float) -> Any:
    """Return the answer to a question from a worker process with a time limit (s). Raises `Failed` if there is none.

    The process is killed when the command is interrupted, also where it computes in C and hears no signal.

    compute: the function that answers the question. name: of the case.
    """
    from bodycheck.processes import pool
    from bodycheck.processes.failures import Crashed, TimedOut
    from bodycheck.reference.truths import NoTruth
    from bodycheck.running import tasks

    home = pool.Home(prepare=tasks.leave_out_sympy)
    with pool.Workers(compute, 1, limit, home=lambda group: home) as workers:
        answer = workers.call(question)
    match answer:
        case TimedOut():
            raise Failed(f"{name}: its truth takes longer than the limit of {limit:g} s; --limit sets another")
        case NoTruth(reason):
            raise Failed(f"{name}: {reason}")
        case Crashed(reason):
            raise Failed(f"{name}: the computation of its truth failed: {reason}")
        case _:
            return answer
