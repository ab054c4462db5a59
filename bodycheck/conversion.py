"""Read the arguments of Python functions as the command line reads its options, with the same messages for bad ones."""

from numbers import Real

from bodycheck.errors import BadInput


def name(option: str, value: object) -> str:
    """Return a name, such as the name of an engine. For anything else, raise `BadInput` that names the option."""
    if isinstance(value, str):
        return value
    raise BadInput(f"Invalid value for {option}: read {value!r}; allowed: a text.")


def number(option: str, value: object) -> float:
    """Return a number. For anything else, raise `BadInput` that names the option."""
    if isinstance(value, Real) and not isinstance(value, bool):
        return float(value)
    raise BadInput(f'Invalid value for {option}: unable to convert "{value}" into float.')


def whole_number(option: str, value: object) -> int:
    """Return an integer. For anything else, raise `BadInput` that names the option."""
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    raise BadInput(f'Invalid value for {option}: unable to convert "{value}" into int.')
