"""The report: one offline page with the verdict, the evidence for it and where it comes from.

`load(root)` reads what the stages wrote, `build(data, out)` writes the page: all sections, none of
which is known by name.
"""

from collections.abc import Sequence
from importlib import resources
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from spirob.files import write_text
from spirob.report.data import ReportData, load, with_clip
from spirob.report.embed import json_script, plotly_script
from spirob.report.sections import Section, discover
from spirob.report.words import prose

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


__all__ = ["ReportData", "build", "load", "render", "with_clip"]
