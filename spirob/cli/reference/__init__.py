"""The reference, made from the source: modules, classes and functions with their docstrings.

source.py  reads a module's public names without importing it; writes them down
"""

from spirob.cli.reference.source import Module, modules, page

__all__ = ["Module", "modules", "page"]
