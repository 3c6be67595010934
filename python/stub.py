"""nevh/__init__.pyi: the names of the package with their types, for editors and mypy.

    python3 stub.py >nevh/__init__.pyi

SPDX-License-Identifier: GPL-3.0-or-later
"""

import inspect
import re
import textwrap

import nevh
from nevh import _commands


class Bare(str):
    """An annotation that is printed without quotes."""
    __repr__ = str.__str__


def annotation_of(given):
    given = "Any" if given is inspect.Parameter.empty else given
    return Bare(re.sub(r"PathLike(?!\[)", "PathLike[str]",
                       given.replace("os.PathLike", "PathLike")
                       .replace("list[", "List[").replace("dict[", "Dict[")))


def signature_of(function):
    """Its signature as a stub has it."""
    own = inspect.signature(function)
    return str(own.replace(
        parameters=[one if one.name == "self" else
                    one.replace(annotation=annotation_of(one.annotation))
                    for one in own.parameters.values()],
        return_annotation=annotation_of(
            "None" if function.__name__ == "__init__" else own.return_annotation)))


def lines_of(text):
    """A long line, as several, which end within its parentheses."""
    head, arrow, result = text.rpartition(") -> ")
    kept = head + (arrow + result).replace(" ", "\0")
    return "\n".join(textwrap.wrap(kept, 90, subsequent_indent=" " * 8,
                                   break_long_words=False,
                                   break_on_hyphens=False)).replace("\0", " ")


def function(name, of, indent=""):
    return lines_of("%sdef %s%s: ..." % (indent, name, signature_of(of)))


def class_of(name, of, base):
    lines = ["class %s(%s):" % (name, base) if base else "class %s:" % name]
    for one, member in vars(of).items():
        public = one == "__init__" or not one.startswith("_")
        if isinstance(member, property):
            lines.append("    @property\n" + function(one, member.fget, "    "))
        elif public and inspect.isfunction(member):
            lines.append(function(one, member, "    "))
    return "\n".join(lines + _attributes.get(name, ["    ..."] if len(lines) == 1 else []))


_attributes = {
    "Error": ["    result: Any"],
    "Table": ["    columns: List[str]\n    notes: List[str]\n    words: List[str]",
              "    command: List[str]", "    @overload",
              "    def __getitem__(self, key: str) -> Any: ...", "    @overload",
              "    def __getitem__(self, key: SupportsIndex) -> Dict[str, Any]: ...",
              "    @overload",
              "    def __getitem__(self, key: slice) -> List[Dict[str, Any]]: ..."],
    "Scene": ["    path: Any\n    is_formula: bool"],
    "HGrad": ["    def __call__(self, t: float, y: Any) -> Any: ..."],
    "Result": ["    def __getattr__(self, name: str) -> Any: ..."],
}
_bases = {"Error": "Exception", "Refused": "Error, ValueError",
          "Failed": "Error, ArithmeticError", "Table": "List[Dict[str, Any]]", "Text": "str",
          "Result": "Dict[str, Any]"}

print('"""Types of nevh, made by python/stub.py."""\n')
print("from os import PathLike\nfrom typing import (Any, Callable, Dict, Iterable, List, "
      "Literal, Mapping, Sequence,\n                    SupportsIndex, overload)\n")
print("__version__: str\nverdicts: tuple[str, ...]\n")
classes = {name: getattr(nevh, name) for name in nevh.__all__
           if inspect.isclass(getattr(nevh, name))}
classes["Result"] = type("Result", (), {"plot": nevh.solve.__globals__["Result"].plot})
for name in sorted(classes, key=lambda one: (one not in _bases, one)):
    print(class_of(name, classes[name], _bases.get(name)) + "\n")
for name in sorted({*nevh.__all__, *_commands._names()} - set(classes) - {"verdicts"}):
    print(function(name, getattr(nevh, name)))
