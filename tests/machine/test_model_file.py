"""A model file is data: it reads its own meshes alone, repeats nothing, and fails in words."""

import os

import mujoco
import numpy as np
import pytest

from spirob.errors import ConfigError, DataError, MissingLog, SpirobError
from spirob.machine.description.model_file import load
from tests.machine.rigs import PENDULUM

INCLUDE = '<include file="other.xml"/>'
OTHER = '<mujoco><worldbody><body><geom size="1" mass="7"/></body></worldbody></mujoco>'


def loaded(folder, text, name="link.xml"):
    (folder / name).write_text(text)
    return load(name, folder)


def before(text, added, mark="<worldbody>"):
    return text.replace(mark, added + mark)


def within(added):
    return PENDULUM.replace("<worldbody>", "<worldbody>" + added)


def mesh(file, more="", compiler=""):
    return before(PENDULUM, f'{compiler}<asset><mesh file="{file}" {more}/></asset>')


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<!DOCTYPE a [<!ENTITY b 'c'>]>" + PENDULUM, "entities are not read"),
        (before(PENDULUM, INCLUDE), "<include> is not read"),
        (before(PENDULUM, f"<!-- -->{INCLUDE}<!-- -->"), "<include> is not read"),
        (before(PENDULUM, "<!-- > --" + ">" + INCLUDE), "<include> is not read"),
        (before(PENDULUM, '<include xmlns="u" file="other.xml"/>'), "include> is not read"),
        (before(PENDULUM, '<i:include xmlns:i="u" file="other.xml"/>'), "include> is not read"),
        (before(PENDULUM, '<extension><plugin plugin="x"/></extension>'), "<extension>"),
        (before(PENDULUM, '<asset><model name="m" file="other.xml"/></asset>'), "<model>"),
        (before(PENDULUM, '<asset><mesh name="m" builtin="sphere"/></asset>'), "MuJoCo builds"),
        (within('<replicate count="1000000000"/>'), "<replicate>"),
        (within("<body><composite/></body>"), "<composite>"),
        (within("<flexcomp/>"), "<flexcomp>"),
        (within('<attach model="m" body="b" prefix="p"/>'), "<attach>"),
        (within("<body/>" * 25_000), "25001 bodies"),
        (within("<site/>" * 25_000), "elements"),
        (within("<frame>" * 600 + "</frame>" * 600), "nest"),
        (before(PENDULUM, "<default>" * 2000 + "</default>" * 2000), "nested too deeply"),
        (PENDULUM.replace("mass=", "weight="), "MuJoCo cannot read"),
        (PENDULUM.replace('mass="0.4"', 'mass="nan"'), "mass of a <.*> is 'nan', no number"),
        (within('<geom size="0.1" mass="+inf"/>'), "mass of a <geom> is '.inf', no number"),
        (within('<geom size="0.1" mass="1e300"/>'), "mass of a <geom> is '1e300', no number of"),
        ("<robot name='r'><link name='l'/></robot>", "begins with <mujoco>"),
        ("no xml", "is no XML"),
        ("", "is no XML"),
        ('<?xml version="1.0" encoding="klingon"?>' + PENDULUM, "is no XML"),
        (mesh("/etc/hostname"), "leads out of"),
        (mesh("&#47;etc&#x2f;hostname"), "leads out of"),
        (mesh("&#46;./secret.stl"), "leads out of"),
        (mesh("hostname", compiler='<compiler meshdir="/etc"/>'), "leads out of"),
        (mesh("a.stl", compiler='<compiler assetdir=".."/>'), "leads out of"),
    ],
)
def test_a_model_that_reaches_out_or_multiplies_is_refused(tmp_path, text, sentence):
    (tmp_path / "other.xml").write_text(OTHER)
    with pytest.raises(ConfigError, match=sentence):
        loaded(tmp_path, text)


@pytest.mark.parametrize(
    "added",
    [
        '<size memory="900G" nuserdata="1000000000" nkey="1000000000"/>',
        '<custom><numeric name="a" size="1000000000" data="1"/></custom>',
        '<asset><texture name="t" type="cube" fileright="/etc/hostname"/></asset>',
        '<asset><texture name="t" builtin="flat" width="100000" height="100000"/></asset>',
        '<asset><hfield name="h" nrow="99999" ncol="99999" size="1 1 1 1"/></asset>',
        '<asset><skin file="/etc/hostname"/></asset>',
        '<compiler><lengthrange mode="all" timestep="1e-9" inttotal="1e9"/></compiler>',
        '<option iterations="1000000000" tolerance="0"/>',
        '<visual><global offwidth="1000000"/></visual>',
    ],
)
def test_what_says_nothing_of_the_motion_is_left_out(tmp_path, added):
    plain, model = loaded(tmp_path, PENDULUM), loaded(tmp_path, before(PENDULUM, added), "more.xml")
    assert model.ntex == model.nhfield == model.nskin == model.nuserdata == 0
    assert model.opt.iterations == plain.opt.iterations
    np.testing.assert_array_equal(model.body_inertia, plain.body_inertia)
    np.testing.assert_array_equal(model.opt.gravity, plain.opt.gravity)


@pytest.mark.parametrize(
    ("compiler", "file", "place"),
    [
        ("", "tetra.stl", "tetra.stl"),
        ('<compiler meshdir="parts"/>', "tetra.stl", "parts/tetra.stl"),
        ('<compiler meshdir="parts" assetdir="x"/>', "a/tetra.stl", "parts/a/tetra.stl"),
        ('<compiler assetdir="parts" strippath="true"/>', "x/tetra.stl", "parts/tetra.stl"),
    ],
)
def test_a_mesh_weighs_what_it_weighs_in_mujoco(tmp_path, compiler, file, place):
    """Wherever it lies, and with a material that is left out."""
    (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / place).write_bytes(tetrahedron())
    assets = f'<asset><mesh file="{file}"/><material name="red"/></asset>'
    text = before(PENDULUM, compiler + assets).replace(
        '<site name="hand"', '<geom type="mesh" mesh="tetra" material="red"/><site name="hand"'
    )
    text = text.replace(
        '<inertial pos="0 0 -0.15" mass="0.4" diaginertia="0.003 0.003 0.0001"/>', ""
    )
    model = loaded(tmp_path, text)
    direct = mujoco.MjModel.from_xml_path(str(tmp_path / "link.xml"))
    np.testing.assert_allclose(model.body_mass, direct.body_mass)
    np.testing.assert_allclose(model.body_inertia, direct.body_inertia)


def tetrahedron():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4") * 0.1
    faces = corners[[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]]
    rows = np.zeros(4, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    rows["corners"] = faces
    return bytes(80) + np.uint32(4).tobytes() + rows.tobytes()


def test_files_are_bounded_and_inside_the_folder(tmp_path):
    (tmp_path / "outside.xml").write_text(PENDULUM)
    inside = tmp_path / "rig"
    inside.mkdir()
    (inside / "link.xml").symlink_to(tmp_path / "outside.xml")
    os.mkfifo(inside / "pipe.xml")
    for name in ("../outside.xml", str(tmp_path / "outside.xml"), "link.xml", "a\0b", "/dev/zero"):
        with pytest.raises(ConfigError, match=r"leads out of|no path"):
            load(name, inside)
    with pytest.raises(MissingLog):
        load("absent.xml", inside)
    for name in (".", "pipe.xml"):
        with pytest.raises(DataError, match="no model"):
            load(name, inside)
    with pytest.raises(DataError, match="is no model"):
        loaded(inside, PENDULUM + " " * 2**21, "large.xml")
    (inside / "large.stl").write_bytes(bytes(2**23 + 1))
    with pytest.raises(DataError, match="is no mesh"):
        loaded(inside, mesh("large.stl"), "meshed.xml")
    (inside / "mesh.stl").symlink_to(tmp_path / "outside.xml")
    with pytest.raises(ConfigError, match="leads out of"):
        loaded(inside, mesh("mesh.stl"), "meshed.xml")


def test_mujoco_leaves_no_log_behind(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    model = loaded(tmp_path, PENDULUM)
    data = mujoco.MjData(model)
    data.qpos[:] = np.nan
    mujoco.mj_step(model, data)
    assert mujoco.MjLogConfig.get().logto_console, "warnings of others are still heard"
    with pytest.raises(SpirobError):
        loaded(tmp_path, PENDULUM.replace('mass="0.4"', 'mass="nan"'))
    assert not (tmp_path / "MUJOCO_LOG.TXT").exists()
