"""From a diagnosis on disk to files: proof, bad input, and nothing half-written."""

import json
import subprocess
import sys

import mujoco
import numpy as np
import pytest

from spirob.cli.main import main
from spirob.errors import ExportError
from spirob.export import exporting, listed, targets
from spirob.export.corrected import corrected, read_document
from spirob.export.exporting import export
from spirob.export.targets import ALONE, alone
from tests.export.machines import exported_model

OWN = '''
"""An effect of somebody's own."""

from spirob.effects.effect import Effect
from spirob.parameter import bounded

HALF = 0.5


def bent(x):
    """Half of it, squared."""
    return HALF * x * abs(x)


class OwnDrag(Effect):
    """τ = -c·bent(ω)."""

    port = "motor.torque"
    reads = {"speed": "motor.speed"}
    neutral = {"drag": 0.0}
    title = "own"
    signature = "own"
    explanation = "own"
    drag: float = bounded(1e-3, 0.0, 1.0, "N·m·s²/rad²", "c", "drag")

    @staticmethod
    def kernel(speed, drag):
        """Torque."""
        return -drag * bent(speed)
'''


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """The folder of a diagnosis that named two effects, one of them outside of MJCF."""
    folder = tmp_path_factory.mktemp("first")
    exported_model(folder, ["coulomb_friction", "load_dependent_friction"], seconds=2.5)
    return folder


def edited(home, folder, change):
    """The same diagnosis with something else in it."""
    document = json.loads((home / "diagnosis.json").read_text())
    change(document)
    (folder / "heldout.parquet").write_bytes((home / "heldout.parquet").read_bytes())
    (folder / "diagnosis.json").write_text(json.dumps(document))
    return folder


def test_help_lists_every_target(capsys):
    with pytest.raises(SystemExit):
        main(["export", "--help"])
    said = capsys.readouterr().out
    assert listed() in said
    assert set(targets()) == {"bam", "c", "mjcf", "mujoco", "table"}


@pytest.mark.parametrize("target", ["mujoco", "mjcf", "bam"])
def test_a_check_writes_both_errors(target, home, tmp_path, capsys):
    given = ["export", str(home / "diagnosis.json"), "--to", target, "--out", str(tmp_path)]
    assert main([*given, "--check"]) == 0
    told = json.loads((tmp_path / "check.json").read_text())
    assert told["exported"] == pytest.approx(told["ours"], abs=told["apart"] + 1e-12)
    lossy = target != "mujoco"
    assert (told["lost"] > 0.01) == lossy
    for file in tmp_path.iterdir():
        first = file.read_text().splitlines()[0]
        assert ("LOSES" in first) == lossy, file
    assert "held-out error" in capsys.readouterr().out


def test_a_lossy_target_says_so_unasked(home, tmp_path):
    export(home, "mjcf", tmp_path)
    text = (tmp_path / "elbow.xml").read_text()
    assert text.startswith("<!-- LOSES ")
    assert "leaves out load_dependent_friction: costs " in text
    mujoco.MjModel.from_xml_string(text)


@pytest.mark.parametrize("target", ["c", "bam", "table", "mjcf"])
def test_a_model_of_logs_of_one_direction_says_so_first(target, home, tmp_path, capsys):
    given = edited(home, tmp_path, lambda document: document["model"].update(way=-1))
    assert main(["export", str(given), "--to", target, "--out", str(tmp_path / "out")]) == 0
    assert "ONE WAY" in capsys.readouterr().out
    for path in (tmp_path / "out").glob("*.[cxj]*"):
        first = path.read_text().splitlines()[0]
        assert "ONE WAY" in first, path


def test_sensors_of_plain_mjcf_lag_and_are_late(tmp_path):
    names = ["current_lag", "feedback_latency"]
    values = {e.name: e.values for e in exported_model(tmp_path, names, seconds=1.5).effects}
    export(tmp_path, "mjcf", tmp_path / "out")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "elbow.xml"))
    data, k = mujoco.MjData(model), np.arange(400)
    given = np.sin(0.05 * k)
    lagged, found, places = np.zeros(400), np.zeros(400), np.zeros((2, 400))
    share = 1.0 - np.exp(-model.opt.timestep / values["current_lag"]["time"])
    for row in k:
        lagged[row] = lagged[row - 1] + share * (given[row] - lagged[row - 1]) if row else 0.0
        data.ctrl[:] = given[row]
        places[0, row] = data.qpos[0]
        mujoco.mj_step(model, data)
        found[row], places[1, row] = data.sensor("effort").data[0], data.sensor("position").data[0]
    then = k - values["feedback_latency"]["latency"] / model.opt.timestep
    assert found[20:] == pytest.approx(np.interp(then, k, lagged)[20:], abs=1e-9)
    assert places[1, 20:] == pytest.approx(np.interp(then, k, places[0])[20:], abs=1e-9)


@pytest.mark.parametrize("body", [False, True])
@pytest.mark.parametrize("target", ["mujoco", "mjcf", "c"])
def test_what_the_logs_carried_goes_along(target, body, tmp_path):
    """Payload and force of the logs are there without being told, and their weight is felt."""
    own = {"payload": 0.3, "offset": 0.02}
    known = {"scale": 0.5, "delay": 0.0, "inertia": 0.005}
    if not body:
        known |= {"payload_inertia": 0.04, "payload_cosine": 0.3, "payload_sine": -0.2}
    model = exported_model(
        tmp_path, ["quadratic_drag"], body, known=known, logs={"log": own}, seconds=2.5, step=2e-3
    )
    assert model.usual == pytest.approx(own)
    out = tmp_path / "out"
    export(tmp_path, target, out, check=True)
    assert json.loads((out / "check.json").read_text())["lost"] < 0.01
    if target == "c":
        assert body or "state->payload = 0.3;" in (out / "elbow.c").read_text()
        return
    alone = mujoco.MjModel.from_xml_path(str(out / "elbow.xml"))
    data = mujoco.MjData(alone)
    mujoco.mj_forward(alone, data)
    rest = data.qfrc_actuator[0] + data.qfrc_passive[0]
    assert rest == pytest.approx(-0.02 if body else -0.02 - 0.3 * 0.3, abs=1e-6)


def test_bam_is_the_law_here_where_nothing_else_acts(tmp_path):
    names = ["stribeck_friction", "load_dependent_friction"]
    exported_model(tmp_path, names, seconds=2.5, known={"inertia": 0.5, "scale": 0.5})
    export(tmp_path, "bam", tmp_path / "out")
    told = json.loads((tmp_path / "out" / "elbow_m5.json").read_text())
    assert told["model"] == "m5"
    assert told["kt"] == 0.5
    assert set(told) >= {"friction_stribeck", "dtheta_stribeck", "alpha", "load_friction_motor"}


@pytest.mark.parametrize("kind", ["held", "accelerated"])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_bam_counts_a_load_once(kind, way, tmp_path):
    exported_model(tmp_path, ["load_dependent_friction"], seconds=1.5)
    export(tmp_path, "bam", tmp_path / "out")
    told = json.loads((tmp_path / "out" / "elbow_m5.json").read_text()) | {"friction_viscous": 0.0}
    load, share, speed = 0.8, told["load_friction_motor"], 3.0 * way
    given = dict.fromkeys(("carried", "hung", "acceleration"), np.zeros(1))
    given["speed"] = np.array([speed])
    if kind == "held":
        given["carried"] = np.array([load])
    else:
        given["acceleration"] = np.array([load / told["armature"]])
    torque = told["kt"] * targets()["bam"].effort(told, given)[0]
    # a motor's torque is the load and its friction: F = m·|load ± F|
    assert torque - load == pytest.approx(way * share * load / (1 - way * share), rel=0.01)


def test_what_is_drawn_has_the_moments_that_were_fitted(home, tmp_path):
    export(home, "mujoco", tmp_path)
    export(home, "table", tmp_path)
    told = json.loads((tmp_path / "randomisation.json").read_text())
    script = (
        "import sys; sys.path.insert(0, '.'); import draw, elbow, json, numpy as np\n"
        "rng = np.random.default_rng(0)\n"
        "drawn = [[draw.draw(rng).dof_damping[0].item(), elbow.VISCOUS] for _ in range(400)]\n"
        "print(json.dumps(drawn))"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-c", script], cwd=tmp_path, capture_output=True, check=True
    )
    drawn = np.array(json.loads(done.stdout))
    assert np.array_equal(drawn[:, 0], drawn[:, 1])
    sigma = np.sqrt(told["covariance"][0][0])
    assert drawn[:, 0].mean() == pytest.approx(told["mean"][0], abs=5 * sigma / 20)
    assert drawn[:, 0].std() == pytest.approx(sigma, rel=0.2)


def test_the_player_cannot_import_the_project(tmp_path):
    script = tmp_path / "imports.py"
    script.write_text("import spirob\n")
    with pytest.raises(ExportError, match="spirob"):
        alone(script)
    assert "sys.modules['spirob']" in ALONE


def test_what_was_exported_needs_no_project(home, tmp_path):
    export(home, "mujoco", tmp_path)
    for file in tmp_path.iterdir():
        assert "import spirob" not in file.read_text()
        assert "from spirob" not in file.read_text()


def test_an_effect_of_ones_own_goes_along(home, tmp_path):
    own = tmp_path / "own_drag.py"
    own.write_text(OWN)

    def add(document):
        document["model"]["effects"] += [
            {"name": "own_drag", "source": str(own), "numbers": {"drag": 0.01}}
        ]

    folder = edited(home, tmp_path, add)
    model = corrected(read_document(folder / "diagnosis.json"), folder)
    names = {}
    from spirob.export.code import python_text

    exec(python_text(model), names)
    assert names["kernel_own_drag"](-3.0, 0.01) == pytest.approx(0.01 * 0.5 * 9.0)
    assert "own_drag_bent" in targets()["c"].files(model)["elbow.c"]
    own.write_text(OWN.replace("HALF * x * abs(x)", "open(x)"))
    with pytest.raises(ExportError, match=r"'own_drag': its kernel holds a call of 'open'"):
        export(folder, "c", tmp_path / "out")
    own.unlink()
    with pytest.raises(ExportError, match=r"own_drag.py' is gone"):
        export(folder, "c", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def nothing(document):
    """Leaves it as it is."""


CHANGES = {
    "diagnose again": lambda d: d.pop("model"),
    "another version": lambda d: d["model"].update(format=99),
    "is no number": lambda d: d["model"]["numbers"].update(inertia="1; import os"),
    "no effect of this version": lambda d: d["model"]["effects"][0].update(source="os"),
    "cannot be read": lambda d: d["model"]["effects"][0].update(numbers={}),
    "axis": lambda d: d["model"].update(axis="furlong"),
    "moves no inertia": lambda d: d["model"]["numbers"].update(inertia=0.0),
    "number": lambda d: d["model"].update(angle=None),
    "no model to take home": lambda d: d.update(doubts=["A."], explanation="A.\nB."),
}


@pytest.mark.parametrize("said", CHANGES)
def test_a_bad_diagnosis_is_a_sentence_and_writes_nothing(said, home, tmp_path, capsys):
    folder = edited(home, tmp_path, CHANGES[said])
    out = tmp_path / "out"
    assert main(["export", str(folder), "--to", "mjcf", "--out", str(out)]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not out.exists()


def test_what_is_not_there_is_a_sentence(home, tmp_path, capsys):
    for given in (
        [str(tmp_path / "none.json"), "--to", "c"],
        [str(home), "--to", "wax"],
        [str(home), "--to", "table", "--check"],
    ):
        assert main(["export", *given, "--out", str(tmp_path / "out")]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    (tmp_path / "list.json").write_text("[]")
    assert main(["export", str(tmp_path / "list.json"), "--to", "c", "--out", str(tmp_path)]) == 2
    assert "no diagnosis" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert main(["export", str(home), "--to", "c", "--out", str(tmp_path / "file")]) == 2


@pytest.mark.parametrize("there", [False, True])
def test_a_disk_that_is_full_leaves_nothing_half_written(there, home, tmp_path, monkeypatch):
    out, written = tmp_path / "out", []
    if there:
        export(home, "c", out)
    before = {f.name: f.read_bytes() for f in out.iterdir()} if there else {}

    def full(path, text):
        written.append(path)
        if len(written) > 1:
            raise OSError(28, "No space left on device")
        path.write_text(text)

    monkeypatch.setattr(exporting, "write_text", full)
    with pytest.raises(OSError, match="No space left"):
        export(home, "table", out)
    assert len(written) > 1
    assert out.exists() == there
    assert ({f.name: f.read_bytes() for f in out.iterdir()} if there else {}) == before


def test_a_name_from_a_file_becomes_no_code(home, tmp_path):
    evil = '"""\nimport os\n*/ int x; /* --> <worldbody/> <!-- "{evil}"'

    def rename(document):
        document["rig"] = document["sentence"] = evil
        document["model"].update(effort_unit=evil, torque_unit=evil)

    folder = edited(home, tmp_path, rename)
    for target in ("c", "mujoco", "mjcf", "bam", "table"):
        export(folder, target, tmp_path / target)
    module = next((tmp_path / "mujoco").glob("*.py")).read_text()
    names = {}
    exec(compile(module, "module", "exec"), names)
    assert "os" not in names
    source = next((tmp_path / "c").glob("*.c")).read_text()
    assert "int x;" not in source.partition("*/")[2]
    mujoco.MjModel.from_xml_path(str(next((tmp_path / "mjcf").glob("*.xml"))))
