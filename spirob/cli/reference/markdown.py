"""A module's reference as Markdown."""

from spirob.cli.reference.source import Member, Module


def page(module: Module) -> str:
    """One module; members that say nothing of themselves are what their base class says."""
    parts = [f"# {module.name}", module.text]
    for member in module.members:
        parts += _member(member, depth=2)
    return "\n\n".join(part for part in parts if part) + "\n"


def _member(member: Member, depth: int) -> list[str]:
    parts = [f"{'#' * depth} {member.name}", f"```python\n{member.signature}\n```", member.text]
    for inner in member.members:
        if inner.text:
            parts += _member(inner, depth + 1)
    return parts
