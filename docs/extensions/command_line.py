"""The reference of the command line, from the commands themselves: their help, arguments, options and exit codes."""

import inspect
import re
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, get_args

from cyclopts import App

from bodycheck.commands.command_line import app
from docs.extensions.markdown import code, prose, table

#: How the help of a command names the values of options.
METAVARS = {str: "STR", int: "INT", float: "FLOAT", Path: "PATH"}

#: How the paragraph of a docstring with the exit codes begins.
CODES = "Exit codes:"


def page() -> str:
    """Return the commands, each with its description, its arguments and options and its exit codes, as Markdown."""
    rows = [(f"[`{name}`](#{_anchor(name)})", prose(_paragraphs(command)[0])) for name, command in commands()]
    parts = [prose(_exit_codes(app.help_epilogue or "")), table(("command", "what it does"), rows)]
    for name, command in commands():
        parts += _section(name, command)
    return "\n\n".join(parts)


def commands() -> Iterator[tuple[str, App]]:
    """Yield all commands with their names, those of groups such as `engines add` after the group."""
    yield from _commands(app, "")


def _commands(group: App, before: str) -> Iterator[tuple[str, App]]:
    for name in group:
        if not name.startswith("-"):
            yield before + name, group[name]
            yield from _commands(group[name], f"{before}{name} ")


def arguments(command: App) -> list[Any]:
    """Return the arguments and options of a command that its help has, as Cyclopts describes them."""
    found = command.assemble_argument_collection(default_parameter=app.default_parameter, parse_docstring=True)
    return [argument for argument in found if argument.show]


def spelled(argument: Any) -> str:
    """Return how an argument or option is written, such as `--timestep FLOAT`."""
    name = argument.names[0]
    if not name.startswith("-"):
        return str(name)
    return f"{name} {_value(argument)}".strip()


def _section(name: str, command: App) -> list[str]:
    listed = arguments(command)
    paragraphs = _paragraphs(command)
    told = [part for part in paragraphs if not part.startswith(CODES)]
    codes = next((part for part in paragraphs if part.startswith(CODES)), app.help_epilogue or "")
    level = "#" * (2 + name.count(" "))
    return [
        f"{level} bodycheck {name}",
        f"```\n{_usage(name, listed)}\n```",
        *map(prose, told),
        prose(_exit_codes(codes)),
        *([f"```{{program}} bodycheck {name}\n```"] if listed else []),
        *(_option(each) for each in listed),
    ]


def _usage(name: str, listed: Sequence[Any]) -> str:
    options = [argument for argument in listed if argument.names[0].startswith("-")]
    required = [spelled(argument) for argument in options if argument.required]
    further = ["[OPTIONS]"] if len(required) < len(options) else []
    places = []
    for argument in listed:
        if argument not in options:
            place = argument.names[0] + ("…" if getattr(argument.hint, "__origin__", None) is tuple else "")
            places.append(place if argument.required else f"[{place}]")
    line = " ".join(["bodycheck", name, *required, *further, *places])
    return textwrap.fill(line, 70, subsequent_indent=4 * " ", break_long_words=False, break_on_hyphens=False)


def _option(argument: Any) -> str:
    choices = argument.get_choices()
    sentences = [
        prose(argument.parameter.help or ""),
        f"One of {', '.join(map(code, choices))}." if choices else "",
        "Required." if argument.required else "",
    ]
    return f"````{{option}} {spelled(argument)}\n{' '.join(filter(None, sentences))}\n````"


def _paragraphs(command: App) -> list[str]:
    """The paragraphs of the docstring of a command, without the section of its parameters."""
    described = re.split(r"\n\w+\n-{3,}\n", inspect.getdoc(command.default_command) or "")[0]
    return described.strip().split("\n\n")


def _exit_codes(text: str) -> str:
    """The sentence with every code as code."""
    return re.sub(r"(?<=[:;]) (\d+)(?= )", r" `\1`", " ".join(text.split()))


def _value(argument: Any) -> str:
    """The word that stands for the value of an option; empty for a switch."""
    if argument.get_choices():
        return "CHOICE"
    kinds = {argument.hint, *get_args(argument.hint)}
    return next((word for kind, word in METAVARS.items() if kind in kinds), "")


def _anchor(name: str) -> str:
    return f"bodycheck-{name.replace(' ', '-')}"
