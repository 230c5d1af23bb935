"""The sections of the page, one file each; a new file here is a new section."""

from spirob.report.sections.section import Section, discover

__all__ = ["Section", "discover"]
