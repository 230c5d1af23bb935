"""The report: one offline page with the verdict, the evidence for it and where it comes from.

`load(root)` reads what the stages wrote, `build(data, out)` writes the page.
"""

from spirob.report.builder import build, render
from spirob.report.data import ReportData, load, with_clip

__all__ = ["ReportData", "build", "load", "render", "with_clip"]
