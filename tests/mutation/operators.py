# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes mutants of a source: each changes one operator, constant, sign, condition or statement.

C++ is searched as text in which comments, strings and preprocessor lines are blanked. clang-format puts blanks only
around binary operators, which distinguishes product ``a * b`` and pointer ``A* b``. Numbers right after ``<`` may be
template arguments and are not changed. Python is searched by its syntax tree. Messages, documentation and annotations
are not changed.
"""
from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import PurePath


@dataclass(frozen=True, order=True)
class Mutant:
    """One change of one file: ``text[start:end]`` becomes ``replacement``."""

    file: str
    start: int
    end: int
    operator: str
    replacement: str

    def applied(self, text: str) -> str:
        """Return the text with the change."""
        return text[: self.start] + self.replacement + text[self.end:]

    def described(self, text: str) -> str:
        """Return ``file:line: was → is``, on one line."""
        line = text.count("\n", 0, self.start) + 1
        was = " ".join(text[self.start: self.end].split())
        return f"{self.file}:{line}: {was} → {' '.join(self.replacement.split()) or 'nothing'}"


def mutants(file: str, text: str) -> list[Mutant]:
    """Return all mutants of a file in order of their position."""
    found = _of_python(file, text) if PurePath(file).suffix == ".py" else _of_cpp(file, text)
    return sorted(set(found))


RELATIONAL = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
BOUNDARY = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
LOGICAL = {"&&": "||", "||": "&&"}
FUNCTIONS = {"min": "max", "max": "min", "sin": "cos", "cos": "sin"}
CALLED = {"min": "max", "max": "min", "any": "all", "all": "any"}

# Comments, raw strings, strings, characters and preprocessor lines.
_NOT_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|' + r"(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])'" +
    r"|^[ \t]*#[^\n]*", re.S | re.M)
_BINARY = re.compile(r"(?<=[^\s]) (<=|>=|==|!=|<|>|\+=|-=|\*=|/=|\+|-|\*|/|&&|\|\|) (?=[^\s=])")
_BINARY_AT_END = re.compile(r"(?<=[^\s]) (<=|>=|==|!=|<|>|\+|-|\*|/|&&|\|\|)(?=\n)")
_NUMBER = re.compile(r"(?<![\w.])(?:0x[0-9a-fA-F]+|\d+\.?\d*(?:[eE][-+]?\d+)?)[uUlLfz]*(?![\w.])")
_UNARY_MINUS = re.compile(r"(?:(?<=[(,=?:] )|(?<=[(\[{])|(?<=return ))-(?=[\w(])")
_FUNCTION = re.compile(r"\bstd::(min|max|sin|cos)(?=\()")
_CONDITION = re.compile(r"\b(?:if|while) \((?!const\b|auto\b)")
# A call or an assignment that is a whole statement, without a type before the assigned name.
_STATEMENT = re.compile(r"(?<=[;{})])(\s+)((?:\+\+|--)?[A-Za-z_][\w.:]*(?:->[\w.]+|\[[^\]\n]*\])*(?:\.[\w.]+)*"
                        r"(?:\s(?:=|\+=|-=|\*=|/=)\s[^;{}]*|\([^;{}]*\)[^;{}]*)?;)")
_ENDS = re.compile(r"(?<=[;{})])\s+(if \([^;{}]*\) (?:return|continue|break|throw)\b[^;{}]*;)")
_TYPED = re.compile(r"^(?:return|throw|using|namespace|break|continue|case|default|static_assert|template|friend|"
                    r"delete)\b")


def blanked(text: str, strings: bool = True) -> str:
    """Return C++ with comments replaced by blanks; if ``strings`` is true, strings and preprocessor lines too."""

    def blank(found: re.Match[str]) -> str:
        if strings or found.group().startswith(("//", "/*")):
            return re.sub(r"[^\n]", " ", found.group())
        return found.group()

    return _NOT_CODE.sub(blank, text)


def _other_number(number: str) -> str | None:
    """Return another number of the same type, as a mutant; None for a number that is not a plain decimal."""
    if number.startswith("0x") or number[-1] in "uUlLfz":
        return None
    if re.fullmatch(r"\d+", number):
        return {"0": "1", "1": "2"}.get(number, str(int(number) + 1))
    value = float(number)
    return "1.0" if value == 0 else repr(2 * value)


def _of_cpp(file: str, text: str) -> Iterator[Mutant]:
    code = blanked(text)
    for pattern in (_BINARY, _BINARY_AT_END):
        for found in pattern.finditer(code):
            sign, place = found.group(1), found.span(1)
            for name, table in (("relational", RELATIONAL), ("boundary", BOUNDARY), ("arithmetic", ARITHMETIC),
                                ("logical", LOGICAL)):
                if sign in table:
                    yield Mutant(file, *place, name, table[sign])
    for found in _NUMBER.finditer(code):
        other = _other_number(found.group())
        line = code[code.rfind("\n", 0, found.start()) + 1: found.start()]
        if other is not None and "template" not in line and not line.rstrip().endswith("<"):
            yield Mutant(file, *found.span(), "constant", other)
    for found in _UNARY_MINUS.finditer(code):
        yield Mutant(file, *found.span(), "sign", "")
    for found in _FUNCTION.finditer(code):
        yield Mutant(file, *found.span(1), "function", FUNCTIONS[found.group(1)])
    for found in _CONDITION.finditer(code):
        inside = found.end()
        end = _closing(code, inside)
        condition = code[inside:end]
        if not re.search(r" (?:<|>|<=|>=|==|!=|&&|\|\|)\s", condition) and ";" not in condition:
            yield Mutant(file, inside, end, "condition", f"!({text[inside:end]})")
    for pattern, group in ((_STATEMENT, 2), (_ENDS, 1)):
        for found in pattern.finditer(code):
            if not _TYPED.match(found.group(group)):
                yield Mutant(file, *found.span(group), "removed statement", ";")


def _closing(code: str, place: int) -> int:
    depth = 1
    while depth:
        depth += {"(": 1, ")": -1}.get(code[place], 0)
        place += 1
    return place - 1


_COMPARED: dict[type[ast.cmpop], tuple[str, ...]] = {
    ast.Lt: (">=", "<="), ast.LtE: (">", "<"), ast.Gt: ("<=", ">="), ast.GtE: ("<", ">"), ast.Eq: ("!=",),
    ast.NotEq: ("==",), ast.Is: ("is not",), ast.IsNot: ("is",), ast.In: ("not in",), ast.NotIn: ("in",),
}
_CALCULATED: dict[type[ast.operator], str] = {
    ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.Mod: "*", ast.Pow: "*", ast.FloorDiv: "*",
}


class _Source:
    """Positions of nodes in a text as offsets."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._lines = [0]
        for line in text.splitlines(keepends=True):
            self._lines.append(self._lines[-1] + len(line))

    def _offset(self, line: int, column: int) -> int:
        start = self._lines[line - 1]
        whole = self.text[start: self._lines[line]].encode()
        return start + len(whole[:column].decode())

    def span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        """Return start and end of a node."""
        assert node.end_lineno is not None and node.end_col_offset is not None
        return self._offset(node.lineno, node.col_offset), self._offset(node.end_lineno, node.end_col_offset)

    def between(self, left: ast.expr, right: ast.expr, word: str) -> tuple[int, int] | None:
        """Return the position of an operator between two operands; None if a comment also lies between them."""
        first, last = self.span(left)[1], self.span(right)[0]
        place = self.text.find(word, first, last)
        return None if place < 0 or "#" in self.text[first:last] else (place, place + len(word))


_WORDS: dict[type[ast.AST], str] = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.Is: "is",
    ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in", ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
    ast.Mod: "%", ast.Pow: "**", ast.FloorDiv: "//", ast.And: "and", ast.Or: "or",
}


def _of_python(file: str, text: str) -> Iterator[Mutant]:
    source, tree = _Source(text), ast.parse(text)
    for node in _code(tree):
        yield from _of_node(file, node, source)


def _code(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield the executed nodes, without annotations and parts of texts."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list", "bases"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not isinstance(child, ast.JoinedStr):
                yield child
                yield from _code(child)


def _of_node(file: str, node: ast.AST, source: _Source) -> Iterator[Mutant]:
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        sign = type(node.ops[0])
        place = source.between(node.left, node.comparators[0], _WORDS[sign])
        for name, other in zip(("relational", "boundary"), _COMPARED[sign]):
            if place:
                yield Mutant(file, *place, name, other)
    elif isinstance(node, ast.BoolOp):
        place = source.between(node.values[0], node.values[1], _WORDS[type(node.op)])
        if place:
            yield Mutant(file, *place, "logical", "or" if isinstance(node.op, ast.And) else "and")
    elif isinstance(node, ast.BinOp) and type(node.op) in _CALCULATED:
        texts = [side for side in (node.left, node.right) if isinstance(side, (ast.JoinedStr, ast.List, ast.Tuple))
                 or isinstance(side, ast.Constant) and isinstance(side.value, str)]
        place = source.between(node.left, node.right, _WORDS[type(node.op)])
        if place and not texts:
            yield Mutant(file, *place, "arithmetic", _CALCULATED[type(node.op)])
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float, bool):
        yield Mutant(file, *source.span(node), "constant", _other_constant(node.value))
    elif isinstance(node, ast.UnaryOp):
        start, end = source.span(node)
        inner = source.text[slice(*source.span(node.operand))]
        if isinstance(node.op, ast.USub):
            yield Mutant(file, start, end, "sign", inner)
        elif isinstance(node.op, ast.Not):
            yield Mutant(file, start, end, "condition", f"({inner})")
    elif isinstance(node, (ast.If, ast.IfExp, ast.While)) and not isinstance(node.test, (ast.Compare, ast.UnaryOp)):
        start, end = source.span(node.test)
        yield Mutant(file, start, end, "condition", f"(not ({source.text[start:end]}))")
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in CALLED:
        yield Mutant(file, *source.span(node.func), "function", CALLED[node.func.id])
    elif isinstance(node, (ast.Raise, ast.AugAssign)) or isinstance(node, ast.Expr) and isinstance(node.value, (
            ast.Call, ast.Yield, ast.YieldFrom)):
        yield Mutant(file, *source.span(node), "removed statement", "pass")


def _other_constant(value: bool | int | float) -> str:
    if isinstance(value, bool):
        return repr(not value)
    if isinstance(value, int):
        return str(value + 1)
    return "1.0" if value == 0 else repr(2 * value)
