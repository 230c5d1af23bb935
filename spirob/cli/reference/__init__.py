"""The reference, made from the source: modules, classes and functions with their docstrings.

source.py    reads a module's public names without importing it
markdown.py  writes them down
"""

from spirob.cli.reference.markdown import page
from spirob.cli.reference.source import Module, modules

__all__ = ["Module", "modules", "page"]
