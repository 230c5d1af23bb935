"""YAML that somebody wrote, read as data: what YAML 1.2 calls its core, and no surprises.

A number is a number, `true` and `false` are truth, and all else is text: no time that counts in
sixties (`100:00`), no date, no `yes`, no octal `010`.  A key given twice, a tag that asks for
anything else, and what is larger than a person writes are mistakes with their line.
"""

import codecs
import re
from typing import Any

import yaml

from spirob.errors import ConfigError

MOST = 10_000  # values, with every alias counted as what it repeats
DEEPEST = 32
LONGEST = 40  # characters of a number; a double has 17 digits that say something
CORE = "tag:yaml.org,2002:"
SCALARS = {  # kind -> how it is written, and the characters it may begin with
    "null": (r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    "bool": (r"true|True|TRUE|false|False|FALSE", list("tTfF")),
    "int": (r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", list("-+0123456789")),
    "float": (
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
}
IN_MEMORY = re.compile(r'\s+in "<(byte|unicode) string>",?')  # what the library calls a text
WRITTEN = {CORE + kind: re.compile(rf"(?:{text})\Z") for kind, (text, _) in SCALARS.items()}
KINDS = {*WRITTEN, *(CORE + name for name in ("str", "seq", "map"))}


class Mistake(yaml.YAMLError):
    """What is no plain data, with its line."""

    def __init__(self, node: yaml.Node, said: str):
        super().__init__(f"line {node.start_mark.line + 1}: {said}")


class Plain(yaml.SafeLoader):
    """Reads the core of YAML 1.2 and nothing else."""

    yaml_implicit_resolvers: dict[str, Any] = {}

    def get_single_node(self) -> Any:
        """The document, looked through before anything is made of it."""
        node = super().get_single_node()
        if node is not None:
            _look_through(node)
        return node

    def construct_int(self, node: yaml.ScalarNode) -> int:
        """A whole number, of base ten unless it says another."""
        return int(node.value, {"0o": 8, "0x": 16}.get(node.value[:2], 10))


for _kind, (_, _first) in SCALARS.items():
    Plain.add_implicit_resolver(CORE + _kind, WRITTEN[CORE + _kind], _first)
Plain.add_constructor(CORE + "int", Plain.construct_int)


def read(text: str | bytes, where: str) -> Any:
    """The plain data of a YAML text; raises ConfigError naming `where` and the line."""
    try:
        return yaml.load(text, Loader=Plain)
    except RecursionError:
        raise ConfigError(f"{where}: is nested too deeply") from None
    except Mistake as error:
        raise ConfigError(f"{where}: {error}") from None
    except (yaml.YAMLError, ValueError) as error:  # what cannot be decoded is a ValueError
        raise ConfigError(f"{where}: is not YAML: {_told(error)}") from None


def _told(error: Exception) -> str:
    """What the library says, with the line alone of the place that it shows."""
    if isinstance(error, yaml.MarkedYAMLError) and error.problem and error.problem_mark:
        return f"line {error.problem_mark.line + 1}: {error.problem}"
    return " ".join(IN_MEMORY.sub(" at", str(error)).split())[:200]


def text(content: bytes) -> str:
    """Of what `read` can read, in UTF-8 or, by its first bytes, UTF-16."""
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    return content.decode("utf-16" if wide else "utf-8-sig")


def _look_through(root: yaml.Node) -> None:
    left, seen = [(root, 1)], 0
    while left:
        node, depth = left.pop()
        seen += 1
        if seen > MOST:
            raise Mistake(node, f"more than {MOST} values")
        if depth > DEEPEST:
            raise Mistake(node, f"nested more than {DEEPEST} deep")
        if node.tag not in KINDS:
            raise Mistake(node, f"the tag '{node.tag.removeprefix(CORE)}' is not read")
        if isinstance(node, yaml.MappingNode):
            _each_key_once(node)
            left += [(part, depth + 1) for pair in node.value for part in pair]
        elif isinstance(node, yaml.SequenceNode):
            left += [(part, depth + 1) for part in node.value]
        elif node.tag in WRITTEN and len(node.value) > LONGEST:
            raise Mistake(node, f"a number of {len(node.value)} characters")
        elif node.tag in WRITTEN and not WRITTEN[node.tag].match(node.value):
            raise Mistake(node, f"'{node.value}' is no {node.tag.removeprefix(CORE)}")


def _each_key_once(mapping: yaml.MappingNode) -> None:
    seen: dict[str, int] = {}
    for key, _ in mapping.value:
        if not isinstance(key, yaml.ScalarNode):
            raise Mistake(key, "a key is text")
        line = key.start_mark.line + 1
        if key.value in seen:
            raise Mistake(key, f"'{key.value}' is given twice, first in line {seen[key.value]}")
        seen[key.value] = line
