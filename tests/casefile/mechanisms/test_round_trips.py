"""What is written of a mechanism as a case file is read back as the same mechanism, to the last bit."""

from hypothesis import HealthCheck, given, settings

from bodycheck.casefile.case import parse
from bodycheck.casefile.toml_text import written
from bodycheck.reference.mechanisms.mechanism import Mechanism
from tests.support.random_mechanisms import document, mechanisms


@given(mechanisms())
@settings(max_examples=30, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
def test_a_mechanism_is_read_as_it_was_written(mechanism: Mechanism) -> None:
    assert parse(written(document(mechanism)), "f").scene == mechanism
