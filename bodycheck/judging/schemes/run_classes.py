"""Classes of equal methods among stored runs."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from functools import lru_cache

from bodycheck.adapters.contract import Kind, kind_of
from bodycheck.judging.schemes.classes import MethodClass, Motion, beginning, classes
from bodycheck.judging.schemes.scheme_rounding import ROUNDOFF
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.requirements import touches
from bodycheck.reference.truths import Truth
from bodycheck.results.outcome import Completed, Run
from bodycheck.results.store import Results

#: The number of truths that are kept in memory: the truths of one case at its time steps.
TRUTHS_KEPT = 8


def classes_of(results: Results, runs: Iterable[Run]) -> Mapping[Kind, tuple[MethodClass, ...]]:
    """Return the classes of methods by the kind of scene, as far as the cases of the runs distinguish methods.

    Runs that did not complete, engines of unknown precision (as in results of earlier versions) and cases that were run with a
    single method are left out. Methods with error control, whose steps differ, mechanisms, whose schemes `bodycheck tradeoff`
    names, and bodies in contact are left out too. A motion that agrees with the truth to rounding is not distinguished from
    others.
    """
    precisions, truths = results.header["precisions"], lru_cache(TRUTHS_KEPT)(results.truth)
    known = [run for run in runs if run.engine in precisions and run.method.accuracy is None]
    together = Counter((run.case, run.method.timestep) for run in known if isinstance(run.outcome, Completed))
    motions: dict[Kind, list[Motion]] = defaultdict(list)
    for run in known:
        scene = results.cases[run.case].scene
        if not isinstance(run.outcome, Completed) or together[run.case, run.method.timestep] < 2:
            continue
        if isinstance(scene, Mechanism):  # their schemes are stepped in Python, which takes too long for every report
            continue
        if touches(scene):  # the effect of contacts is no scheme
            continue
        timestep, method = run.method.timestep, run.key.over_cases.over_steps
        trajectory, truth = beginning(run.outcome.trajectory, timestep), truths(run.case, timestep)
        if isinstance(truth, Truth):
            exact, roundoff = truth.at(trajectory.t).trajectory, ROUNDOFF[precisions[run.engine]]
            motions[kind_of(scene)].append(Motion(scene, timestep, method, trajectory, roundoff, exact))
    return {kind: classes(motions_of_kind) for kind, motions_of_kind in motions.items()}
