"""The report: one offline page with the verdict, the evidence for it and where it comes from.

`load(root)` reads what the stages wrote, `build(data, out)` writes the page: all sections, none of
which is known by name.  `build_rig_page(found)` puts a rig's diagnosis on one, of the sections that
say they stand there.

    data.py         what the page is made of: the files, who writes them, what they must hold
    provenance.py   source, data, versions, seed and the command that makes the page again
    sections/       the parts of the page, one file each, with a file in templates/
What they share:
    words.py        numbers and fits as people read them
    figures.py      figures as plotly describes them, their signals, and when each regime holds
    arm.py          the arm's motion for the page;  clip.py  the same, rendered

plotly.js names no other host here.  The library names map servers, a chart editor and its own home
page.  The page draws nothing of the kind, so those addresses are made unusable; what is left are
XML namespaces, which are names and never fetched.  They are written with escaped slashes, the same
string to JavaScript, so that the finished page can be checked by searching it for '://'.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from spirob.files import write_text
from spirob.report.data import ReportData, load, with_clip
from spirob.report.provenance import collect
from spirob.report.sections import Section, discover
from spirob.report.words import prose

if TYPE_CHECKING:
    from spirob.machine.result import Diagnosis

SCRIPTS = (
    "packing.js",
    "theme.js",
    "legend.js",
    "plots.js",
    "switches.js",
    "moment.js",
    "overlay.js",
    "body.js",
    "arm.js",
    "bar.js",
    "start.js",
)
NAMESPACE = re.compile(r"(https?:)//(?=www\.w3\.org/)")
ADDRESS = re.compile(r"https?://")
OFFLINE = "offline:"


def build(data: ReportData, out: Path | str) -> Path:
    """Write the page to `out`, whole or not at all; equal data give equal bytes."""
    out = Path(out)
    write_text(out, render(data))
    return out


def render(data: ReportData, sections: Sequence[Section] | None = None) -> str:
    """The page as text; without a choice it has all sections in `sections/`."""
    environment = _environment()
    sections = discover() if sections is None else sections
    shown, absent = [], []
    for section in sections:
        context = section.get_context(data)
        if why := section.absent(context):
            absent.append((section, why))
        else:
            body = environment.get_template(section.template).render(context)
            shown.append((section, Markup(body)))
    return environment.get_template("page.html.j2").render(
        sections=shown,
        absent=absent,
        commit=data.provenance.commit[:10],
        style=Markup(_asset("style.css")),
        plotly=Markup(plotly_script()),
        scripts=[Markup(_asset(name)) for name in SCRIPTS],
    )


def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("spirob.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["json_script"] = json_script
    environment.filters["prose"] = prose
    return environment


def _asset(name: str) -> str:
    return resources.files("spirob.report").joinpath("assets", name).read_text(encoding="utf-8")


def json_script(name: str, value: Any) -> Markup:
    """`value` as a script element of type JSON with the id `name`."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    text = text.replace("</", "<\\/").replace("<!--", "<\\u0021--")
    return Markup(f'<script type="application/json" id="{name}">{text}</script>')


@cache
def plotly_script() -> str:
    """The library, to be inlined once."""
    return ADDRESS.sub(OFFLINE, NAMESPACE.sub(r"\1\\/\\/", get_plotlyjs()))


def build_rig_page(found: "Diagnosis") -> str:
    """The page as text."""
    sources, document = found.sources, found.document
    files = [str(file.resolve()) for file in sources.files]
    about = collect(Path.cwd(), files, sources.config)
    # names, not places: where a log lies on somebody's disk is no provenance
    hashes = {Path(path).name: digits for path, digits in about.hashes.items()}
    provenance = replace(about, seed="0", command=sources.command, overrides=(), hashes=hashes)
    data = ReportData(
        config=sources.config,
        identified={"parameters": found.parameters, "identifiability": found.identifiability},
        compare={},
        diagnosis={**document, "ladder": [_rung(rung) for rung in document["ladder"]]},
        overlay=found.overlay,
        laws=found.laws,
        motion=found.motion,
        composed=found.composed,
        library=found.library,
        metrics={},
        provenance=provenance,
    )
    return render(data, discover("rig"))


def _rung(rung: dict[str, Any]) -> dict[str, Any]:
    """The page's sections call the test logs held out."""
    intervals = rung["interval"]
    held = {"heldout": rung["test"], "interval": {**intervals, "heldout": intervals["test"]}}
    return {**rung, **held}


__all__ = ["ReportData", "build", "build_rig_page", "load", "render", "with_clip"]
