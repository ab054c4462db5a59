"""A method has one spelling, which is parsed once."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.adapters.method import FORMER_SPELLINGS, MAX_NAME_LENGTH, Method, current, is_name
from bodycheck.errors import BadInput

WORDS = st.text(st.characters(codec="ascii", categories=("Ll", "Lu", "Nd"), include_characters="-_."), min_size=1, max_size=12)


@given(integrator=WORDS.filter(is_name), options=st.dictionaries(WORDS, WORDS, max_size=4))
def test_a_spelling_is_parsed_back_to_itself(integrator: str, options: dict[str, str]) -> None:
    written = integrator + (":" if options else "") + ",".join(f"{key}={value}" for key, value in options.items())
    if current(written) != written:
        return
    method = Method.parse(written, 0.01)
    assert Method.parse(method.name, 0.01) == method
    assert method.integrator == integrator
    assert {key for key, _ in method.options} == set(options)


def test_the_order_of_options_and_the_form_of_numbers_make_no_other_method() -> None:
    method = Method.parse("Euler:solref=0.0040 1.0,cone=elliptic,pads=04", 0.01)
    assert method == Method.parse("Euler:cone=elliptic,pads=4,solref=4e-3  1", 0.01)
    assert method.name == "Euler:cone=elliptic,pads=4,solref=0.004 1"
    assert method.option("cone") == "elliptic"
    assert method.option("condim") is None
    assert str(method) == "Euler:cone=elliptic,pads=4,solref=0.004 1 0.01 s"


@pytest.mark.parametrize(
    ("spelling", "words"),
    [
        ("", "names no integrator"),
        (":cone=elliptic", "names no integrator"),
        ("Euler:", "'' is not an option"),
        ("Euler:cone", "'cone' is not an option"),
        ("Euler:cone=", "'cone=' is not an option"),
        ("=cmd()", "'=cmd\\(\\)' is no name of an integrator"),
        ("+1", "no name"),
        ("-1", "no name"),
        ("@A1", "no name"),
        (" Euler", "no name"),
        ("e" * (MAX_NAME_LENGTH + 1), "at most 100 printable characters"),
        ("Euler\udc80", "cannot be printed"),
        ("Euler\x1b[2J", "cannot be printed"),
        ("Euler:cone=\n", "cannot be printed"),
        ("Euler:=elliptic", "'=elliptic' is not an option"),
        ("Euler:cone=a,cone=b", "the option cone is given twice"),
    ],
)
def test_what_is_no_spelling_is_bad_input(spelling: str, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        Method.parse(spelling, 0.01)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        *FORMER_SPELLINGS.items(),
        ("Euler-fluid:model=everything", "Euler:drag=fluid,model=everything"),
        ("Euler-planar:cone=elliptic", "Euler:model=planar,cone=elliptic"),
    ],
)
def test_a_spelling_of_earlier_versions_is_refused_with_the_present_one(old: str, new: str) -> None:
    assert current(old) == new
    with pytest.raises(BadInput) as refused:
        Method.parse(old, 0.01)
    assert str(refused.value) == f"{old!r} is now spelled {new!r}"
    assert current(new) == new


@pytest.mark.parametrize(
    ("spelling", "name"), [("rk3:accuracy=1e-6", "rk3:accuracy=1e-6"), ("rk3:accuracy=1.50e-06", "rk3:accuracy=1.5e-6")]
)
def test_exponents_are_written_without_zeros_in_front(spelling: str, name: str) -> None:
    method = Method.parse(spelling, 0.1)
    assert method.name == name
    assert method.accuracy == float(name.partition("=")[2])


def test_a_method_without_accuracy_has_fixed_steps() -> None:
    assert Method.parse("rk3", 0.1).accuracy is None
