"""The page of a rig's diagnosis: the report's builder and sections, with a rig's own overlay."""

from spirob.report.rig.page import build_rig_page

__all__ = ["build_rig_page"]
