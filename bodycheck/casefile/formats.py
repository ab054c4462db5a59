"""The formats of case files: 1 for one body, 2 for mechanisms. Which one a document has says its key `format`."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from bodycheck.casefile import contradictions, grammar, scenes
from bodycheck.casefile.mechanisms import building
from bodycheck.casefile.mechanisms import faults as mechanism_faults
from bodycheck.casefile.mechanisms import grammar as mechanism_grammar
from bodycheck.casefile.toml_positions import Path
from bodycheck.casefile.values import Table
from bodycheck.reference.mechanisms.mechanism import AnyScene

#: The table of a whole case file.
AnyCaseTable = grammar.CaseTable | mechanism_grammar.MechanismTable


@dataclass(frozen=True)
class Format:
    """A format of case files.

    Attributes
    ----------
    table
        The grammar of the whole file.
    contradictions
        Yields the faults between keys of a raw document.
    build
        Returns the scene of a file; raises `scenes.Inconsistent`.
    table_at, untagged, known_types
        See the module `grammar`.
    """

    table: type[AnyCaseTable]
    contradictions: Callable[[dict[str, Any]], Iterator[tuple[Path, str]]]
    build: Callable[[Any], AnyScene]
    table_at: Callable[[Path, dict[str, Any]], type[Table] | None]
    untagged: Callable[[Path], Path]
    known_types: Callable[[Path], tuple[str, dict[str, type[Table]]]]


BODY = Format(
    grammar.CaseTable,
    contradictions.contradictions,
    scenes.build_scene,
    grammar.table_at,
    grammar.untagged,
    grammar.known_types,
)
MECHANISM = Format(
    mechanism_grammar.MechanismTable,
    mechanism_faults.contradictions,
    building.build_mechanism,
    mechanism_grammar.table_at,
    mechanism_grammar.untagged,
    mechanism_grammar.known_types,
)

#: What is told of a file of no format.
ALLOWED = f"allowed: {grammar.FORMAT} for one body, {mechanism_grammar.FORMAT} for a mechanism"


def format_of(document: dict[str, Any]) -> Format:
    """Return the format of a raw document."""
    return MECHANISM if mechanism_grammar.is_mechanism(document) else BODY
