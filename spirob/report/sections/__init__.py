"""The sections of the page, one file each; a new file here is a new section.

A section is a title, a template and the numbers that fill it.
"""

import importlib
import pkgutil
from abc import ABC, abstractmethod
from typing import Any, ClassVar

from spirob.report.data import ReportData


class Section(ABC):
    """One part of the page.

    order     place on the page; ties are broken by name
    title     heading, also the entry in the list of contents
    template  file in templates/ that prints what `get_context` returns
    pages     that have it: "arm", the pipeline's; "rig", of a diagnosis of any other machine
    """

    order: ClassVar[int]
    title: ClassVar[str]
    template: ClassVar[str]
    pages: ClassVar[tuple[str, ...]] = ("arm",)

    @property
    def name(self) -> str:
        """Anchor of the section: the name of its file."""
        return type(self).__module__.rsplit(".", 1)[-1]

    @staticmethod
    def absent(context: dict[str, Any]) -> str:
        """Why there is nothing to show, of what `get_context` returned; empty where there is.

        Such a section is a line at the end of the page.
        """
        return ""

    @abstractmethod
    def get_context(self, data: ReportData) -> dict[str, Any]:
        """Everything the template prints."""


def discover(page: str = "arm") -> list[Section]:
    """The sections of a page in their order."""
    found: list[Section] = []
    for info in pkgutil.iter_modules(__path__, f"{__name__}."):
        module = importlib.import_module(info.name)
        members = vars(module).values()
        found += [
            member()
            for member in members
            if isinstance(member, type)
            and issubclass(member, Section)
            and member.__module__ == info.name
            and member is not Section
            and page in member.pages
        ]
    return sorted(found, key=lambda section: (section.order, section.name))
