"""Generates the Python functions of the commands: signatures, types and docstrings from their options.

A command becomes a function of the same name that returns a `Found`, unless `python_calls.py` specifies otherwise.
"""

from __future__ import annotations

import json
import re
import textwrap
from dataclasses import dataclass
from typing import Any

from python_calls import BY_HAND, CALLS, Call

#: Options for output and execution, which the Python functions do not have.
LEFT_OUT = {"json", "quiet", "verbose", "executor"}
#: Types that do not follow from the kind of an option.
TYPES = {
    "task": "Given", "space": "SpaceName | StrPath", "robot": "RobotName | StrPath", "optimizer": "OptimizerName",
    "objective": "Objective | Sequence[Objective]", "constraint": "str | Sequence[str]", "engine": "Engine",
    "finger_model": "FingerModel", "start": "Start", "axes": "Axes", "aggregate": "Aggregate",
}
#: Names imported from other modules of the package.
IMPORTS = {
    "_call": ["called", "checked", "without", "wrong"],
    "_result": ["Found"],
    "_task": ["Given", "sources"],
    "_words": [
        "Aggregate", "Axes", "Engine", "FingerModel", "Numbers", "Objective", "OptimizerName", "RobotName", "SpaceName",
        "Start", "StrPath", "TaskName",
    ],
}
RAISES = """\
Raises:
    InputError: A value or file is invalid; :class:`TaskError` if it is the task.
    StudyError: The command fails at run time or cannot write a file.
    Interrupted: Ctrl-C.
"""


@dataclass(frozen=True)
class Parameter:
    """Parameter of a function, from an option of its command."""

    option: str
    name: str
    type: str
    #: Empty if the parameter is required.
    default: str
    help: str

    def declaration(self) -> str:
        """Returns the parameter as written in the signature."""
        return f"{self.name}: {self.type}" + (f" = {self.default}" if self.default else "")

    def argument(self) -> str:
        """Returns the expression passed to the library."""
        return f"sources({self.name})" if "Given" in self.type else self.name


def parameter(option: dict[str, Any], call: Call) -> Parameter:
    """Returns the parameter of an option."""
    name = call.names.get(option["name"], option["name"])
    kind, default = kind_of(option, call), option["default"]
    if option["flag"]:
        default = "False"
    elif option["name"] in call.hidden:
        default = call.hidden[option["name"]]
    elif option["name"] in call.unset:
        kind, default = f"{kind} | None", "None"
    elif default:
        default = literal(kind, default)
    elif option["multiple"] or kind.startswith("Sequence["):
        default = "" if option["required"] else "()"
    elif not option["required"]:
        kind, default = f"{kind} | None", "None"
    if default == "()" and kind == "Numbers":
        kind, default = "Numbers | None", "None"
    if option["name"] == "task" and "measurements" in call.positional:
        kind, default = f"{kind} | None", "None"
    # Python keywords get a trailing underscore.
    name = f"{name}_" if name == "async" else name
    help = with_parameter_names(option["help"] or "").removeprefix(f"{option['name'].capitalize()}: ")
    return Parameter(option["name"], name, kind, default, help)


def kind_of(option: dict[str, Any], call: Call) -> str:
    """Returns the Python type of an option."""
    name, value = option["name"], option["value"] or ""
    if name in call.types or name in TYPES:
        return call.types.get(name) or TYPES[name]
    if option["flag"]:
        return "bool"
    if option["words"]:
        return f"Literal[{', '.join(repr(word) for word in option['words'])}]".replace("'", '"')
    if value == "KEY=VALUE":
        return "Numbers"
    parts = re.fullmatch(r"[A-Z]+(?:[,x][A-Z]+)+", value)
    if parts:
        kind = "int" if value == "NxM" else "float"
        numbers = ", ".join([kind] * len(re.split("[,x]", value)))
        kind = f"tuple[{numbers}]"
    else:
        kind = {"number": "float", "integer": "int", "path": "StrPath"}.get(option["kind"], "str")
        if kind == "str" and re.match(r"(NAME|FILE|DIR|T)\b", value) and not name.endswith("body"):
            kind = "StrPath"
    if option["multiple"] or value.endswith(".."):
        kind = f"Iterable[{kind}]" if kind == "StrPath" else f"Sequence[{kind}]"
    return kind


def literal(kind: str, default: str) -> str:
    """Returns a default as Python source."""
    if kind.startswith("tuple["):
        return f"({', '.join(repr(float(part)) for part in default.split(','))})"
    if kind in ("int", "float"):
        return repr(int(default) if kind == "int" else float(default))
    return f'"{default}"'


def with_parameter_names(text: str) -> str:
    """Returns a help text with option names replaced by parameter names."""
    text = text.replace("; may be given several times", "").replace("; may be given\nseveral times", "")
    return re.sub(r"(?<![\w-])--([a-z][a-z-]*)", lambda found: found[1].replace("-", "_"), text)


def docstring(command: dict[str, Any], call: Call, parameters: list[Parameter]) -> str:
    """Returns the docstring: purpose and parameters."""
    first, *rest = with_parameter_names(command["about"]).split("\n\n")
    text = f"{first.rstrip('.')}, as ``optimize {command['name']}`` does.\n\n"
    text += "".join(f"{textwrap.fill(' '.join(part.split()), 104)}\n\n" for part in rest)
    if call.example:
        text += f">>> import finger_opt as fo\n>>> {call.example}\n\n"
    if parameters:
        text += "Args:\n"
    for one in parameters:
        line = f"{one.name}: {' '.join(one.help.split())}."
        text += textwrap.fill(line, 104, initial_indent="    ", subsequent_indent="        ") + "\n"
    text += ("\n" if parameters else "") + RAISES
    return f'"""{text}"""'.replace("\\", "\\\\")


def function(command: dict[str, Any], call: Call) -> str:
    """Returns the source of a command's function."""
    options = [option for option in command["options"] if option["name"] not in LEFT_OUT]
    options += [option for option in command["hidden"] if option["name"] in call.hidden]
    parameters = {one.name: one for one in (parameter(option, call) for option in options)}
    positional = [parameter(option, call).name for option in options if option["positional"]]
    ordered = [parameters.pop(name) for name in call.positional or positional]
    # Required parameters come first.
    named = sorted(parameters.values(), key=lambda one: one.default != "")
    all_parameters = [*ordered, *named]
    words = [f'"{one.option}": {one.argument()}' for one in all_parameters]
    words += [f'"{name}": {value}' for name, value in call.always.items()]
    kind = call.result.split(".")[-1]
    method = command["name"] == "study"
    signature = (["cls: type[S]"] if method else []) + [one.declaration() for one in ordered]
    signature += ["*", *(one.declaration() for one in named)] if named else []
    returned, suffix = call.returns or ("S" if method else kind, "")
    given = "{" + ", ".join(words) + "}"
    if command["name"] == "study":
        body = f"return cls.asked({given})"
    elif command["name"] == "resume":
        words = ", ".join(word for word in words if not word.startswith('"dir"'))
        body = f"return {kind}.resumed({ordered[0].name}, {{{words}}})"
    else:
        statement = f'called("{command["name"]}", {given}, {kind})'
        body = statement if returned == "None" else f"return {statement}{suffix}"
    head = [f"def {call.name}(", *(f"    {one}," for one in signature), f") -> {returned}:"]
    lines = ["@checked", *(head if signature else [f"def {call.name}() -> {returned}:"])]
    for part in (docstring(command, call, all_parameters), call.checks, wrapped(body)):
        lines += [f"    {line}" if line else "" for line in part.splitlines()]
    if method:
        lines = [f"    {line}" if line else "" for line in ["@classmethod", *lines]]
    return "\n".join(lines) + "\n"


def wrapped(body: str) -> str:
    """Returns a statement wrapped to lines of at most 116 characters."""
    if len(body) <= 116:
        return body
    before, rest = body.split("{", 1)
    words, after = rest.rsplit("}", 1)
    return f"{before}{{\n{packed(words.split(', '))}\n}}{after}"


def packed(words: list[str]) -> str:
    """Returns indented lines of at most 114 characters, with a comma after each word."""
    lines = ["   "]
    for word in words:
        if len(lines[-1]) + len(word) > 112:
            lines.append("   ")
        lines[-1] += f" {word},"
    return "\n".join(lines)


def module(about: str, body: str, results: list[str]) -> str:
    """Returns the text of a module: imports and body."""
    sources = {name: list(names) for name, names in IMPORTS.items()}
    for result in results:
        home, kind = result.split(".")
        sources.setdefault(home, []).append(kind)
    lines = [f'"""{about} Written by scripts/generate.py."""', "", "from __future__ import annotations", ""]
    for home, names in {
        "collections.abc": ["Iterable", "Mapping", "Sequence"], "pathlib": ["Path"],
        "typing": ["Any", "Literal", "TypeVar"],
    }.items():
        lines += imported(home, names, body)
    lines += [""]
    for home in sorted(sources):
        lines += imported(f".{home}", sources[home], body)
    return "\n".join(lines) + body


def imported(home: str, names: list[str], body: str) -> list[str]:
    """Returns the import line for the names used in a body."""
    body = re.sub(r'"{3}.*?"{3}', "", body, flags=re.DOTALL)
    used = sorted({name for name in names if re.search(rf"(?<![\w.`\"]){name}\b(?!`)", body)})
    line = f"from {home} import {', '.join(used)}"
    if len(line) > 118:
        line = f"from {home} import (\n{packed(used)}\n)"
    return [line] if used else []


CREATED = '''

S = TypeVar("S", bound="Asked")


class Asked:
    """Base class of requests that are made with the options of ``optimize``."""

    @classmethod
    def asked(cls: type[S], words: Mapping[str, Any]) -> S:
        """Returns the request with these options."""
        raise NotImplementedError

'''


def modules(commands: list[dict[str, Any]]) -> dict[str, str]:
    """Returns the texts of the modules by file name."""
    functions, results, names = list[str](), list[str](), list[str]()
    created, further = "", ""
    for command in commands:
        name = command["name"]
        if name in BY_HAND:
            continue
        call = CALLS.get(name) or Call(name.replace(" ", "_").replace("-", "_"))
        if name == "study":
            created = CREATED + function(command, call)
            continue
        functions.append(function(command, call))
        results.append(call.result)
        names.append(call.name)
        if name not in CALLS:
            further += f"\n    {call.name}  {command['about'].splitlines()[0]}"
    return {
        "_asked.py": module("The options of a study.", created, []),
        "_commands.py": module(
            "The commands of ``optimize`` as functions.",
            f"\n\n__all__ = [\n{packed([json.dumps(name) for name in sorted(names)])}\n]\n"
            "#: Functions and summaries missing from the docstring of the package.\n"
            f'_FURTHER = """{further}"""\n\n\n'
            + "\n\n".join(functions),
            results,
        ),
    }
