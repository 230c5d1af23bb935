"""The page in a headless Chromium: what it says on its console, and what a script finds in it."""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("chrome")
REASON = "needs Chromium to draw the page"
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-logging=stderr",
    "--virtual-time-budget=9000",
)
FOUND = re.compile(r'<pre id="found">(.*?)</pre>', re.DOTALL)


def probe(page: str, script: str, folder: Path, size: str = "1280,2400") -> dict[str, Any]:
    """Open the page, run `script` as the body of an async function, return what it returns.

    Fails when anything was said on the console, which errors and refused loads do.
    """
    path = folder / "index.html"
    path.write_text(page.replace("</body>", f"<script>{_wrapped(script)}</script></body>"), "utf-8")
    profile = f"--user-data-dir={folder / 'profile'}"
    command = [str(CHROMIUM), *FLAGS, f"--window-size={size}", profile, "--dump-dom", path.as_uri()]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    assert [line for line in ran.stderr.splitlines() if "CONSOLE" in line] == []
    found = FOUND.search(ran.stdout)
    assert found, "the script did not come to its end"
    return dict(json.loads(html.unescape(found[1])))


def _wrapped(script: str) -> str:
    return (
        "const wait = (ms) => new Promise((done) => setTimeout(done, ms));"
        "const get = (id) => document.getElementById(id);"
        "const turn = (id, value, kind = 'change') => {"
        " get(id).value = value; get(id).dispatchEvent(new Event(kind)); };"
        "addEventListener('load', async () => {"
        f" const found = await (async () => {{ await wait(500); {script} }})();"
        " const shown = document.createElement('pre'); shown.id = 'found';"
        " shown.textContent = JSON.stringify(found); document.body.append(shown); });"
    )
