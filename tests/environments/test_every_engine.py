"""Every engine that has an adapter, in an environment of its own: `make engines`, which needs package sources and minutes."""

import pytest

from bodycheck.adapters import registry
from bodycheck.environments import environments
from tests.support import ROOT

#: Most time in s for the tests of one engine. Some engines compile for seconds a model.
LIMIT_S = 3000.0

#: The engines that bodycheck does not install itself.
APART = [name for name in registry.names() if registry.installed(name) is None]


@pytest.mark.engines
@pytest.mark.parametrize("name", APART)
def test_an_engine_keeps_the_contract_in_its_own_environment(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    environment = environments.obtain(name, environments.newest(name))
    monkeypatch.chdir(ROOT)
    tests = ["tests/adapters/test_contract.py", *(str(path) for path in sorted(ROOT.glob(f"tests/adapters/{name}")))]
    done = environments.run(environment, "pytest", ["-q", *tests, "--adapter", name], None, LIMIT_S)
    print(done.stdout[-20_000:], done.stderr[-20_000:])
    assert done.returncode == 0
