"""Files of robots as tests of pytest. The files match a pattern of `bodycheck_models` in pytest's configuration.

A test of a file fails if an engine refuses the file or differs from it. The engines are given by `--bodycheck-engine`; the
default is all installed engines that read robot models. Their processes live as long as the session.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from bodycheck.runner_log import harmless, printable

if TYPE_CHECKING:
    from bodycheck.studies.parity.study import Parity

#: Name of the test of a file.
NAME = "parity"

COMPARE_KEY = pytest.StashKey[Callable[[Path], "Parity"]]()


def is_named(path: Path, root: Path, patterns: Sequence[str]) -> bool:
    """Return whether a file in pytest's root folder matches a pattern, which is relative to that folder."""
    return path.is_relative_to(root) and any(path.relative_to(root).match(pattern) for pattern in patterns)


class ModelFile(pytest.File):
    """The collector of one file of a robot."""

    def collect(self) -> "Iterator[ModelItem]":
        yield ModelItem.from_parent(self, name=NAME)


class ModelItem(pytest.Item):
    """The test of one file of a robot. `of_engines` distinguishes tests of engines from all others."""

    of_engines = True

    def runtest(self) -> None:
        from bodycheck.studies.parity.rows import is_compared
        from bodycheck.studies.parity.wording import differs, engines_of

        parity = _compare(self.config)(self.path)
        measured = [engine for engine, rows in engines_of(parity).items() if any(map(is_compared, rows))]
        self.user_properties += [("engine", engine) for engine in measured]
        if differs(parity):
            raise Different(parity)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        from bodycheck.errors import BadInput

        match excinfo.value:
            case Different(parity=parity):
                return printable(_explained(parity))
            case BadInput() as error:
                return printable(str(error))
        return super().repr_failure(excinfo)

    def reportinfo(self) -> tuple[Path, None, str]:
        return Path(harmless(str(self.path))), None, harmless(f"{self.path.name}: {NAME}")


class Different(Exception):
    """Raised for a file that an engine refuses or reads differently."""

    def __init__(self, parity: "Parity") -> None:
        super().__init__(parity.name)
        self.parity = parity


def _explained(parity: "Parity") -> str:
    from bodycheck.studies.parity.rows import failed
    from bodycheck.studies.parity.wording import engines_of, headline, of_engine, of_file

    lines = [headline([parity]), ""]
    lines += [f"the file: {fault}" for fault in of_file(parity)]
    for engine, rows in engines_of(parity).items():
        if any(map(failed, rows)):
            lines += [f"{engine} {rows[0].version}:", *(f"    {sentence}" for sentence in of_engine(rows))]
    return "\n".join([*lines, "", f"All rows: bodycheck parity {parity.path} --table"])


def _compare(config: pytest.Config) -> "Callable[[Path], Parity]":
    """Return the function that compares a file, with processes that live as long as the session."""
    if COMPARE_KEY not in config.stash:
        from bodycheck.console.arguments import load_engines
        from bodycheck.files.temporary import temporary_folder
        from bodycheck.studies.parity import study

        stack = ExitStack()
        config.add_cleanup(stack.close)
        records = load_engines(tuple(config.getoption("--bodycheck-engine"))).records
        folder = stack.enter_context(temporary_folder())
        how = stack.enter_context(study.asking(records, 1))
        folders: list[Path] = []

        def compare(path: Path) -> "Parity":
            folders.append(folder / str(len(folders)))
            folders[-1].mkdir()
            return study.one(records, path, study.Asking(), folders[-1], how)

        config.stash[COMPARE_KEY] = compare
    return config.stash[COMPARE_KEY]
