"""Where a TOML text writes its entries: the stretches that an edit cuts, replaces or adds to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from gbeam.scenario.text.locate_toml import keys_of, syntax_tree
from gbeam.scenario.values.paths import Path

if TYPE_CHECKING:
    from tree_sitter import Node

BLOCKS = ("table", "table_array_element")  # [table] and [[element]], with the lines below them
# The node to cut, and the node of the value; None where a longer key only passes through the entry.
Written = tuple["Node", "Node | None"]


class Layout:
    """Where every entry of a TOML text is written: several times where headers and dotted keys share a table."""

    def __init__(self, code: bytes) -> None:
        self.root = syntax_tree(code)
        self.entries: dict[Path, list[Written]] = {}
        self.bases: dict[int, Path] = {}  # of pairs: the table that they stand in
        counts: dict[Path, int] = {}
        for node in self.root.named_children:
            if node.type == "pair":
                self._pair((), node)
            elif node.type in BLOCKS:
                base = self._header(node, counts)
                for pair in node.named_children[1:]:
                    if pair.type == "pair":
                        self._pair(base, pair)

    def _note(self, path: Path, whole: Node, value: Node | None) -> None:
        self.entries.setdefault(path, []).append((whole, value))

    def _header(self, node: Node, counts: dict[Path, int]) -> Path:
        path: Path = ()
        names = [name for name, _ in keys_of(node.named_children[0])]
        for i, name in enumerate(names, 1):
            path += (name,)
            opens = node.type == "table_array_element" and i == len(names)
            if opens:
                counts[path] = counts.get(path, -1) + 1
            listed = path in counts
            self._note(path, node, node if i == len(names) and not listed else None)
            if listed:
                path += (counts[path],)
                self._note(path, node, node if i == len(names) else None)
        return path

    def _pair(self, base: Path, node: Node) -> None:
        inside = [*_known(node)]
        if len(inside) != 2:
            return
        self.bases[node.id] = base
        names = [name for name, _ in keys_of(inside[0])]
        for i in range(1, len(names)):
            self._note((*base, *names[:i]), node, None)
        self._value((*base, *names), node, inside[1])

    def _value(self, path: Path, whole: Node, value: Node) -> None:
        self._note(path, whole, value)
        if value.type == "inline_table":
            for pair in _known(value):
                self._pair(path, pair)
        elif value.type == "array":
            for i, each in enumerate(_known(value)):
                self._value((*path, i), each, each)


def _known(node: Node) -> Iterator[Node]:
    return (child for child in node.named_children if child.type not in ("comment", "ERROR"))
