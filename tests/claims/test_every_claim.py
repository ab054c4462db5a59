"""Every claim holds in each of its releases: `make claims`, which installs engines and takes minutes."""

import pytest

from claims import measuring, records
from claims.measuring import Commands
from claims.records import Claim

#: Each claim with each of its releases.
CLAIMED = [(claim, release) for claim in records.claims().values() for release in claim.releases]


@pytest.fixture(scope="session")
def commands(tmp_path_factory: pytest.TempPathFactory) -> Commands:
    """The commands that claims share."""
    return Commands(tmp_path_factory.mktemp("commands"))


@pytest.mark.claims
@pytest.mark.parametrize(("claim", "release"), CLAIMED, ids=[f"{claim.name}@{release}" for claim, release in CLAIMED])
def test_the_command_and_the_script_of_a_claim_give_its_values(claim: Claim, release: str, commands: Commands) -> None:
    assert list(measuring.deviations(claim, release, commands)) == []
