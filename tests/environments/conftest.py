"""An engine that is installed from wheels which the tests write."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.support import MINIATURES, wheels


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where an engine has its adapter, in `plugin`, and its package, in `wheels`: that is all there is to install from."""
    place = tmp_path_factory.mktemp("environments")
    wheels.plugin(place / "plugin")
    (place / "wheels").mkdir()
    with pytest.MonkeyPatch.context() as patch:
        for folder in (MINIATURES, place / "plugin"):
            patch.syspath_prepend(folder)
        patch.setenv("PYTHONPATH", os.pathsep.join(map(str, (MINIATURES, place / "plugin"))))
        patch.setenv("BODYCHECK_CACHE", str(place / "cache"))
        patch.setenv("UV_CACHE_DIR", str(place / "uv"))
        patch.setenv("PIP_NO_INDEX", "1")
        patch.setenv("PIP_FIND_LINKS", str(place / "wheels"))
        yield place


@pytest.fixture
def wheel(place: Path) -> Callable[..., Path]:
    """Adds a version of the engine's package to what there is to install from."""
    return lambda version, body="KIND = 'exact'": wheels.wheel(place / "wheels", version, body)
