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
    "--window-size=1280,3000",
)
FOUND = re.compile(r'<pre id="found">(.*?)</pre>', re.DOTALL)


FRAME = """<!doctype html><meta charset="utf-8"><body><script>
addEventListener("message", (event) => {
  const shown = document.createElement("pre");
  shown.id = "found"; shown.textContent = JSON.stringify(event.data); document.body.append(shown);
});</script><iframe src="page.html" width="WIDTH" height="3000" style="border:0"></iframe>"""


def probe(page: str, script: str, folder: Path, width: int = 1260) -> dict[str, Any]:
    """Open the page, run `script` as the body of an async function, return what it returns.

    The page lies in a frame `width` pixels wide, as a window is never as narrow as a phone.  Fails
    when anything was said on the console, which errors and refused loads do.
    """
    scripted = page.replace("</body>", f"<script>{_wrapped(script)}</script></body>")
    (folder / "page.html").write_text(scripted, encoding="utf-8")
    path = folder / "frame.html"
    path.write_text(FRAME.replace("WIDTH", str(width)), encoding="utf-8")
    profile = f"--user-data-dir={folder / 'profile'}"
    command = [str(CHROMIUM), *FLAGS, profile, "--dump-dom", path.as_uri()]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    said = [line for line in ran.stderr.splitlines() if "CONSOLE" in line]
    assert said == [], "\n".join(said)
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
        " parent.postMessage(found, '*'); });"
    )
