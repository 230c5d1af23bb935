"""A model file in MuJoCo's format, written by anybody: read as data, and only what is needed of it.

The file is parsed here, and MuJoCo is given what was checked: elements that say how a body moves,
and the meshes that they name, as bytes.  What is only seen (textures, cameras) or measured
(sensors) is left out, and with it all that could be large; what repeats itself, loads code or reads
further files is refused.
"""

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, SubElement, tostring

import mujoco
from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring

from spirob import files
from spirob.errors import ConfigError
from spirob.units import MOST

LARGEST = 2**20  # bytes of a model file
MESHES = 2**23  # bytes of all its meshes
MOST_JOINTS = 64
MOST_BODIES = 2 * MOST_JOINTS  # inverse dynamics runs through all of them at every sample
MOST_ELEMENTS = 4096
MOST_TIES = 2 * MOST_JOINTS  # tendons and equalities, each of which is solved for
BARE = {
    "mujoco", "compiler", "option", "flag", "default", "asset", "mesh", "worldbody", "body",
    "frame", "inertial", "joint", "freejoint", "geom", "site", "tendon", "spatial", "fixed",
    "pulley", "equality", "connect", "weld", "actuator", "general", "motor", "position",
    "velocity", "intvelocity", "orientation", "pid", "damper", "cylinder", "muscle", "adhesion",
    "dcmotor",
}  # fmt: skip
ABSENT = {
    "size", "visual", "statistic", "custom", "keyframe", "sensor", "contact", "camera", "light",
    "texture", "material", "hfield", "skin", "lengthrange", "pair",
}  # fmt: skip
UNSEEN = ("material", "hfield")  # attributes that name what is left out
KEPT = {"compiler": {
    "alignfree", "angle", "autolimits", "balanceinertia", "boundinertia", "boundmass",
    "coordinate", "discardvisual", "eulerseq", "fitaabb", "fusestatic", "inertiafromgeom",
    "inertiagrouprange", "settotalmass",
}, "option": {
    "cone", "density", "gravity", "impratio", "jacobian", "timestep", "viscosity", "wind",
}}  # fmt: skip


def load(name: str, folder: Path) -> mujoco.MjModel:
    """The model in a file beside or below a description, its contacts and limits switched off.

    Raises MissingLog where there is none, DataError and ConfigError where it is not read.
    """
    path = files.inside(name, folder, "body.mjcf")
    text, meshes = checked(path)
    try:
        with unheard():
            model = mujoco.MjModel.from_xml_string(text, meshes)
    except (ValueError, mujoco.FatalError) as error:
        said = " ".join(str(error).split())
        raise ConfigError(f"{path}: MuJoCo cannot read this model: {said[:200]}") from error
    if model.nv == 0 or model.nv > MOST_JOINTS:
        raise ConfigError(f"{path}: {model.nv} degrees of freedom; 1 to {MOST_JOINTS} can be used")
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    return model


def checked(path: Path) -> tuple[str, dict[str, bytes]]:
    """What is needed of a model file, as text, and the files of its meshes by name.

    Raises MissingLog where there is none, ConfigError where it holds what is not read.
    """
    tree = _parsed(files.content(path, "model", LARGEST), path)
    folders = _folders(tree)
    _only_what_moves(tree, path)
    _finite(tree, path)
    meshes = _meshes(tree, path, *folders)
    # the lengths of muscles would be searched by simulation
    compiler = SubElement(tree, "compiler")
    SubElement(compiler, "lengthrange", mode="none")
    try:
        return tostring(tree, "unicode"), meshes
    except RecursionError:
        raise ConfigError(f"{path}: is nested too deeply") from None


def _parsed(text: bytes, path: Path) -> Element:
    try:
        tree: Element = fromstring(text, forbid_dtd=True)
    except DefusedXmlException:
        raise ConfigError(f"{path}: document types and entities are not read") from None
    except (ParseError, ValueError, LookupError) as error:  # an encoding that is none
        raise ConfigError(f"{path}: is no XML: {error}") from None
    if tree.tag != "mujoco":
        raise ConfigError(f"{path}: a model begins with <mujoco>, this with <{tree.tag}>")
    return tree


def _finite(tree: Element, path: Path) -> None:
    """Raise where an attribute holds a number that is none, or none of a machine.

    MuJoCo takes what is not a number for one not given.
    """
    for element in tree.iter():
        for key, value in element.attrib.items():
            if any(not abs(number) <= MOST for number in _numbers(value)):
                raise ConfigError(
                    f"{path}: {key} of a <{element.tag}> is '{value[:40]}', no number of a machine"
                )


def _numbers(text: str) -> Iterator[float]:
    """The words of a text that are numbers."""
    for word in text.split():
        with suppress(ValueError):
            yield float(word)


def _only_what_moves(tree: Element, path: Path) -> None:
    """Leave out what is only seen or measured; raise for what does not belong into a model."""
    for parent in tree.iter():
        for child in list(parent):
            if child.tag in ABSENT or child.get("type") == "hfield":
                parent.remove(child)
        for name in UNSEEN:
            parent.attrib.pop(name, None)
        kept = KEPT.get(parent.tag, parent.attrib)
        parent.attrib = {k: v for k, v in parent.attrib.items() if k in kept}
    tags = Counter(element.tag for element in tree.iter())
    if strange := sorted(set(tags) - BARE):
        raise ConfigError(f"{path}: the element <{strange[0]}> is not read from a rig's model")
    if tags["body"] > MOST_BODIES or tags.total() > MOST_ELEMENTS:
        raise ConfigError(
            f"{path}: {tags['body']} bodies and {tags.total()} elements; {MOST_BODIES} and "
            f"{MOST_ELEMENTS} can be used"
        )
    ties = sum(len(found) for tag in ("tendon", "equality") for found in tree.findall(tag))
    if ties > MOST_TIES:
        raise ConfigError(f"{path}: {ties} tendons and equalities; {MOST_TIES} can be used")


def _folders(tree: Element) -> tuple[str, bool]:
    """The folder in which the model's meshes lie, and whether their own paths are cut off."""
    said = {k: v for compiler in tree.iter("compiler") for k, v in compiler.attrib.items()}
    return said.get("meshdir", said.get("assetdir", "")), said.get("strippath") == "true"


def _meshes(tree: Element, path: Path, beside: str, stripped: bool) -> dict[str, bytes]:
    """The files of the meshes by the plain names that the tree gives them from now on."""
    found: dict[str, bytes] = {}
    for mesh in tree.iter("mesh"):
        if "builtin" in mesh.attrib:
            raise ConfigError(f"{path}: meshes that MuJoCo builds are not read from a rig's model")
        if (name := mesh.attrib.pop("file", None)) is None:
            continue
        given = Path(beside) / (Path(name).name if stripped else name)
        file = files.inside(str(given), path.parent, "file")
        left = MESHES - sum(map(len, found.values()))
        plain = f"{len(found)}{file.suffix}"
        found[plain] = files.content(file, "mesh", left)
        mesh.attrib.setdefault("name", file.stem)
        mesh.set("file", plain)
    return found


@contextmanager
def unheard() -> Iterator[None]:
    """MuJoCo says nothing on the console meanwhile, and never writes MUJOCO_LOG.TXT."""
    log = mujoco.MjLogConfig.get()
    log.logto_file, heard = False, log.logto_console
    log.logto_console = False
    log.set()
    try:
        yield
    finally:
        log.logto_console = heard
        log.set()
