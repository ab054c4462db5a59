"""Where each key of a TOML document stands, which `tomllib` does not tell."""

import tomllib
from typing import Any, NamedTuple

import tree_sitter_toml
from tree_sitter import Language, Node, Parser

Path = tuple[str | int, ...]


class Position(NamedTuple):
    """Line and column, counted from 1."""

    line: int
    column: int


def positions(text: str) -> dict[Path, Position]:
    """Positions of all tables, keys and array elements of a valid TOML document, by their path."""
    root = Parser(Language(tree_sitter_toml.language())).parse(text.encode()).root_node
    found: dict[Path, Position] = {(): Position(1, 1)}
    lengths: dict[Path, int] = {}
    for node in root.named_children:
        if node.type == "pair":
            _pair(node, (), found)
        elif node.type in ("table", "table_array_element"):
            header = node.named_children[0]
            keys = _keys(header)
            path = _inside(keys[:-1], lengths) + keys[-1:]
            _record(path, header, found)
            if node.type == "table_array_element":
                lengths[path] = lengths.get(path, 0) + 1
                path = (*path, lengths[path] - 1)
                _record(path, header, found)
            for child in node.named_children[1:]:
                if child.type == "pair":
                    _pair(child, path, found)
    return found


def _inside(keys: Path, lengths: dict[Path, int]) -> Path:
    """The path of a table's parents: a parent that is an array of tables stands for its last element."""
    path: Path = ()
    for key in keys:
        path = (*path, key)
        if path in lengths:
            path = (*path, lengths[path] - 1)
    return path


def _pair(node: Node, base: Path, found: dict[Path, Position]) -> None:
    key, value = node.named_children[:2]
    path = base
    for name in _keys(key):
        path = (*path, name)
        _record(path, key, found)
    _value(value, path, found)


def _value(node: Node, path: Path, found: dict[Path, Position]) -> None:
    children = [child for child in node.named_children if child.type != "comment"]
    if node.type == "array":
        for index, child in enumerate(children):
            _record((*path, index), child, found)
            _value(child, (*path, index), found)
    elif node.type == "inline_table":
        for child in children:
            _pair(child, path, found)


def _keys(node: Node) -> tuple[str, ...]:
    if node.type == "dotted_key":
        return tuple(name for child in node.named_children for name in _keys(child))
    text = (node.text or b"").decode()
    if node.type == "quoted_key":
        unquoted: dict[str, Any] = tomllib.loads(f"{text} = 0")
        return tuple(unquoted)
    return (text,)


def _record(path: Path, node: Node, found: dict[Path, Position]) -> None:
    # A dotted key or a header may name the same table again: the first place is where a reader looks.
    found.setdefault(path, Position(node.start_point[0] + 1, node.start_point[1] + 1))
