"""Read the arguments of Python functions as the command line reads its own, and refuse others with its texts."""

from numbers import Real

from bodycheck.errors import BadInput


def name(option: str, value: object) -> str:
    """Return a name, such as that of an engine. Raises `BadInput` that names the option for anything else."""
    if isinstance(value, str):
        return value
    raise BadInput(f"Invalid value for {option}: read {value!r}; allowed: a text.")


def number(option: str, value: object) -> float:
    """Return a number. Raises `BadInput` that names the option for anything else."""
    if isinstance(value, Real) and not isinstance(value, bool):
        return float(value)
    raise BadInput(f'Invalid value for {option}: unable to convert "{value}" into float.')


def whole_number(option: str, value: object) -> int:
    """Return an integer. Raises `BadInput` that names the option for anything else."""
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    raise BadInput(f'Invalid value for {option}: unable to convert "{value}" into int.')
