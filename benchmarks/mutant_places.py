"""Places in the code where a sign, a factor, a term, an axis or a bound can be wrong, and the change that does it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
_FOLDERS = ("folder", "parent", "path", "file", "FILE", "ROOT")


@dataclass
class Mutant:
    """One small change."""

    file: str
    """from the tree's root"""
    function: str
    """that it is in, `Class.method`; empty: none"""
    text: str
    """of the line: it is found by it when lines move"""
    kind: str
    before: str
    """the expression"""
    after: str
    start: int
    """byte in `text`"""
    end: int
    verdict: str = "open"
    """open, killed, survived or equivalent"""
    by: str = ""
    """file of tests that noticed, or the reason why nothing can"""


class _Places(ast.NodeVisitor):
    """Finds what can be changed in one file."""

    def __init__(self) -> None:
        self.found: list[tuple[ast.expr, str, ast.expr]] = []

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_arg(self, node: ast.arg) -> None:
        pass  # annotations

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for statement in node.body:
            self.visit(statement)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        if not _textual(node):
            if isinstance(node.op, ast.Add | ast.Sub):
                other = ast.Sub() if isinstance(node.op, ast.Add) else ast.Add()
                self._add(node, "sign", ast.BinOp(node.left, other, node.right))
                self._add(node, "dropped term", node.left)
            if isinstance(node.op, ast.Mult | ast.Div) and not _is_path(node):
                self._add(node, "factor 2", ast.BinOp(ast.Constant(2.0), ast.Mult(), node))
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.USub) and not isinstance(node.operand, ast.Constant):
            self._add(node, "sign", node.operand)
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        swap = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
        if len(node.ops) == 1 and type(node.ops[0]) in swap:
            self._add(node, "off by one", ast.Compare(node.left, [swap[type(node.ops[0])]()], node.comparators))
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        if isinstance(node.func, ast.Name) and node.func.id == "range" and len(node.args) == 1:
            more = ast.BinOp(node.args[0], ast.Sub(), ast.Constant(1))
            self._add(node, "off by one", ast.Call(node.func, [more], []))
        for keyword in node.keywords:
            if keyword.arg == "axis" and isinstance(keyword.value, ast.Constant) and keyword.value.value in (0, 1):
                self._add(keyword.value, "swapped axis", ast.Constant(1 - keyword.value.value))
        self.generic_visit(node)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        if isinstance(node.ctx, ast.Load):
            for index in ast.walk(node.slice):
                whole = isinstance(index, ast.Constant) and type(index.value) is int and index.value in (0, 1, 2)
                if whole and isinstance(index, ast.Constant):
                    self._add(index, "swapped axis", ast.Constant({0: 1, 1: 0, 2: 1}[index.value]))
        self.generic_visit(node)

    def _add(self, node: ast.expr, kind: str, instead: ast.expr) -> None:
        if node.lineno == node.end_lineno:
            self.found.append((node, kind, instead))


def _textual(node: ast.BinOp) -> bool:
    return any(
        isinstance(part, ast.JoinedStr | ast.List | ast.Tuple | ast.Dict)
        or (isinstance(part, ast.Constant) and isinstance(part.value, str | bytes))
        for part in ast.walk(node)
    )


def _is_path(node: ast.BinOp) -> bool:
    names = ast.unparse(node.left)
    return isinstance(node.op, ast.Div) and any(part in names for part in _FOLDERS)


def places(path: Path) -> Iterator[Mutant]:
    """Every change that one file allows."""
    text = path.read_text()
    finder = _Places()
    finder.visit(ast.parse(text))
    for node, kind, instead in finder.found:
        line = text.splitlines()[node.lineno - 1].encode()
        before = line[node.col_offset : node.end_col_offset].decode()
        shift = len(line) - len(line.lstrip())
        after = ast.unparse(ast.fix_missing_locations(instead))
        after = f"({after})" if isinstance(instead, ast.BinOp | ast.Compare) else after
        name = str(path.relative_to(ROOT))
        yield Mutant(
            name,
            function_at(text, node.lineno),
            line.decode().strip(),
            kind,
            before,
            after,
            node.col_offset - shift,
            (node.end_col_offset or 0) - shift,
        )


def function_at(text: str, line: int) -> str:
    """Name of the innermost function or class that a line of a file is in, `Class.method`; empty: none."""
    names: list[str] = []
    inside: list[ast.AST] = [ast.parse(text)]
    while inside:
        node = inside.pop()
        for child in ast.iter_child_nodes(node):
            if child.__dict__.get("lineno", 0) <= line <= (child.__dict__.get("end_lineno") or 0):
                if isinstance(child, ast.FunctionDef | ast.ClassDef):
                    names.append(child.name)
                inside.append(child)
    return ".".join(names)
