"""Make the answers for methods from what was measured, and time them."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from bodycheck.adapters.contract import Method
from bodycheck.casefile.content import Case
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.running import campaign
from bodycheck.running.instants import sampling_steps
from bodycheck.studies import cost
from bodycheck.studies.cost import Stretch
from bodycheck.studies.recommend import search
from bodycheck.studies.recommend.rows import Answer, Probe

#: Why a method has no result whose runs ended well.
UNSEEN = "no run shows this figure: the scene does not have it, or the time steps are too large to see it"


def errors_of(probes: Iterable[Probe]) -> dict[float, float]:
    """Return the errors of a method by its time steps (s); infinite where a run failed, none where it timed out."""
    return {
        probe.timestep: math.inf if probe.error is None else probe.error for probe in probes if probe.status != TimedOut.status
    }


def answer_of(engine: str, version: str, method: Method, probes: Sequence[Probe], limit: float) -> Answer:
    """Return the answer for one method, without its cost.

    Parameters
    ----------
    engine, version, method
        The engine with its version, and the method; its time step does not matter.
    probes
        What was measured with the method.
    limit
        The largest allowed error.
    """
    errors = errors_of(probes)
    kept = search.answer(errors, limit)
    finite = {step: error for step, error in errors.items() if math.isfinite(error)}
    step = kept if kept is not None else min(finite, key=lambda step: finite[step], default=None)
    error = None if step is None else finite[step]
    reasons = [probe.reason for probe in sorted(probes, key=lambda probe: probe.timestep) if probe.reason]
    why = reasons[0] if reasons else UNSEEN
    return Answer(
        *(engine, version, method.name, step, error),
        cost=None,
        margin=limit / error if error else None,
        reached=kept is not None,
        cost_low=None,
        cost_high=None,
        steps=len(probes),
        smallest=min(errors, default=None),
        broken=min((step for step in errors if errors[step] > limit), default=None),
        reason=why if step is None else "",
    )


def priced(case: Case, answers: Sequence[Answer]) -> list[Answer]:
    """Measure the costs of answers in turn, with nothing else running, and return them in the order of `Recommendation`."""
    stretches = {
        place: Stretch(case.scene, own.engine, Method.parse(own.integrator, own.timestep), _steps(case, own.timestep))
        for place, own in enumerate(answers)
        if own.timestep is not None
    }
    found = list(answers)
    if stretches:
        costs = cost.measure(tuple(stretches.values()), campaign.TIME_LIMIT_S)
        for measured, (place, stretch) in zip(costs, stretches.items(), strict=True):
            if isinstance(measured, Crashed | TimedOut):
                found[place] = replace(answers[place], reason=f"its cost could not be measured: {measured.reason}")
            else:
                own, step = cost.summarise(measured.times), stretch.method.timestep
                found[place] = replace(
                    answers[place], cost=own.median / step, cost_low=own.low / step, cost_high=own.high / step
                )
    return sorted(found, key=_rank)


def _steps(case: Case, timestep: float) -> int:
    return int(sampling_steps(case.instants, timestep)[-1])


def _rank(own: Answer) -> tuple[bool, float, float]:
    """Return a key that orders answers: those that keep the limit by cost, and by step if that is unknown; others by error."""
    if own.reached:
        return False, math.inf if own.cost is None else own.cost, -(own.timestep or 0.0)
    return True, math.inf if own.error is None else own.error, 0.0
