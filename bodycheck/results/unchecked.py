"""Expectations that no run could check, because their engine cannot be used here."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from bodycheck.adapters.method import Method
from bodycheck.casefile.content import Case

#: The reasons why an unchecked expectation does not count as failed.
ALLOWED, SHIPPED = "--allow-missing", "in a shipped case"


@dataclass(frozen=True)
class Unchecked:
    """An expectation of a case about a method whose engine cannot be used.

    Attributes
    ----------
    case, engine, integrator, timestep
        The names of the case and of the engine, the spelling of the method without its time step, and the time step (s).
    reason
        The reason why the engine cannot be used.
    tolerated
        The reason why the expectation does not count as failed; empty if it does.
    """

    case: str
    engine: str
    integrator: str
    timestep: float
    reason: str
    tolerated: str

    @property
    def failed(self) -> bool:
        """True if the expectation counts as failed."""
        return not self.tolerated

    @property
    def text(self) -> str:
        """A sentence with the consequence for the expectation, and the reason."""
        return f"not checked{f' ({self.tolerated})' if self.tolerated else ''}: {self.reason}"


@dataclass(frozen=True)
class Absence:
    """The reason why an engine cannot be used. broken: whether it is installed but fails, which is never tolerated."""

    reason: str
    broken: bool = False


def unchecked(
    cases: Iterable[Case],
    absence: Callable[[str], Absence | None],
    tolerated: Callable[[Case], str],
    integrators: Sequence[str] = (),
    timesteps: Sequence[float] = (),
) -> Iterator[Unchecked]:
    """Yield the expectations of cases that cannot be checked, once for each method.

    Parameters
    ----------
    cases
        The cases.
    absence
        Function that returns why an engine cannot be used; None if it can be used, or was not selected.
    tolerated
        Function that returns why a missing engine is tolerated in a case; an empty text if it is not.
    integrators, timesteps
        The selected spellings of methods and time steps (s); all if they are empty.
    """
    names = {Method.parse(spelling, 0.0).name for spelling in integrators}
    for case in cases:
        for engine, method in dict.fromkeys((expectation.engine, expectation.method) for expectation in case.expectations):
            chosen = (not names or method.name in names) and (not timesteps or any(map(method.is_at, timesteps)))
            if chosen and (absent := absence(engine)) is not None:
                why = "" if absent.broken else tolerated(case)
                yield Unchecked(case.name, engine, method.name, method.timestep, absent.reason, why)


def sentences(unchecked: Iterable[Unchecked]) -> list[str]:
    """Return a sentence for each engine and reason: the number of unchecked expectations, and whether they fail."""
    amounts = Counter((one.engine, one.tolerated, one.reason) for one in unchecked)
    return [_sentence(amount, *about) for about, amount in amounts.items()]


def _sentence(amount: int, engine: str, tolerated: str, reason: str) -> str:
    subject = f"1 expectation of {engine} was" if amount == 1 else f"{amount} expectations of {engine} were"
    counted = (
        f"({tolerated})"
        if tolerated
        else f"and {'counts' if amount == 1 else 'count'} as failed unless --allow-missing is given"
    )
    return f"{subject} not checked {counted}: {reason}."
