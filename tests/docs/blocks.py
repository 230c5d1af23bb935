"""The code blocks of a page, run in their order as a reader would.

```python            executed, one namespace for the whole page
```python FILE       written to FILE
```yaml FILE         written to FILE
```console           each line `$ spirob ...` is run; the lines under it must be in its output
"""

import re
import shlex
from pathlib import Path
from typing import Any

from spirob.cli.main import main

BLOCK = re.compile(r"^```(\w+) ?(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def follow(page: Path, capsys: Any) -> int:
    """Run all blocks in the current folder; how many there were."""
    names: dict[str, Any] = {}
    blocks = BLOCK.findall(page.read_text(encoding="utf-8"))
    for language, file, text in blocks:
        if file:
            Path(file).write_text(text, encoding="utf-8")
        elif language == "python":
            exec(compile(text, str(page), "exec"), names)
        elif language == "console":
            _type(text, capsys)
        else:
            raise AssertionError(f"{page}: a block of '{language}' that is not run")
    return len(blocks)


def _type(text: str, capsys: Any) -> None:
    said = ""
    for line in text.splitlines():
        if line.startswith("$ "):
            program, *arguments = shlex.split(line[2:])
            assert program == "spirob"
            capsys.readouterr()
            assert main(arguments) == 0, capsys.readouterr().err
            said = capsys.readouterr().out
        else:
            assert line in said, f"'{line}' is not in:\n{said}"
