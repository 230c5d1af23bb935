"""No file, however hostile, crashes a reader, hangs it or takes a gigabyte."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from spirob.errors import SpirobError
from spirob.logs import read_parquet
from spirob.logs.foreign import mapping_from, read_mapping, trace_from
from spirob.logs.readers import read_table
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

GIGABYTE = 2**30
FLIPS = st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), max_size=5)
MAP = {
    "name": "x",
    "time": {"column": "t"},
    "channels": {"left.current": {"column": "a", "unit": "A"}},
}
FIELDS = {
    "name": "x",
    "channels": {
        "left.displacement": {"topic": "/joint_states", "field": "joints[0].position", "unit": "m"}
    },
}


def test_small_files_that_unpack_to_gigabytes_are_refused_in_less_than_one(tmp_path):
    asked = [sys.executable, "-m", "tests.logs.hostile", str(tmp_path)]
    answer = subprocess.run(
        asked, cwd=Path(__file__).parents[2], capture_output=True, timeout=120, check=True
    )
    told = json.loads(answer.stdout)
    assert told["peak"] < GIGABYTE
    said = told["said"]
    assert "unpacks to more than" in said["mcap"]
    assert "unpack to far more than the file's size" in said["survey"]
    assert "is whole" in said["heads"]
    assert "are no messages" in said["empty"]
    assert "is lost" in said["empty survey"]
    for kind in ("parquet", "parquet import", "mat"):
        assert "unpacks to more than" in said[kind]
    assert "more than 10000 values" in said["yaml"]


@pytest.fixture(scope="module")
def wholes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    frame = pd.DataFrame({"t": np.arange(50) * 0.001, "a": np.linspace(0, 1, 50)})
    frame.to_csv(folder / "x.csv", index=False)
    frame.to_parquet(folder / "x.parquet")
    savemat(folder / "x.mat", {k: frame[k].to_numpy() for k in frame}, do_compression=False)
    savemat(folder / "y.mat", {"s": {"t": frame["t"].to_numpy()}}, do_compression=True)
    record_on(FakeRobot(), folder, 0.2, "x.mcap")
    return folder


@pytest.mark.parametrize("name", ["x.csv", "x.parquet", "x.mat", "y.mat", "x.mcap"])
def test_damaged_files_of_others_are_refused_or_read_but_never_crash(name, wholes):
    whole = (wholes / name).read_bytes()
    path = wholes / f"damaged.{name.split('.')[-1]}"
    mapping = mapping_from(FIELDS if name.endswith("mcap") else MAP, "map.yaml")

    apart = not name.endswith("csv")  # a process for each

    @settings(max_examples=40 if apart else 120, deadline=None)
    @given(flips=FLIPS, end=st.floats(0, 1), junk=st.binary(max_size=30))
    def holds(flips, end, junk):
        content = bytearray(whole[: int(end * len(whole))] if junk else whole) + junk
        for at, mask in flips:
            if content:
                content[int(at * len(content))] ^= mask
        path.write_bytes(content)
        try:
            trace_from(read_table(path, mapping.columns), mapping)
        except SpirobError as error:
            assert len(str(error)) < 5000

    holds()


@settings(max_examples=150, deadline=None)
@given(content=st.one_of(st.binary(max_size=200), st.text(max_size=200).map(str.encode)))
def test_any_bytes_as_a_mapping_are_refused_in_a_sentence(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("map") / "map.yaml"
    path.write_bytes(content)
    with pytest.raises(SpirobError, match=r"map\.yaml"):
        read_mapping(path)


@settings(max_examples=100, deadline=None)
@given(
    plain=st.recursive(
        st.one_of(st.none(), st.booleans(), st.floats(), st.integers(), st.text(max_size=10)),
        lambda inner: (
            st.lists(inner, max_size=4)
            | st.dictionaries(
                st.sampled_from(["name", "time", "channels", "unit", "column", "meta", "x"]),
                inner,
                max_size=4,
            )
        ),
        max_leaves=20,
    )
)
def test_any_plain_data_as_a_mapping_is_refused_in_a_sentence(plain):
    with pytest.raises(SpirobError, match=r"map\.yaml"):
        mapping_from(plain, "map.yaml")


def test_yaml_makes_no_objects(tmp_path):
    path = tmp_path / "map.yaml"
    path.write_text("name: !!python/object/apply:os.system ['touch " + str(tmp_path / "x") + "']")
    with pytest.raises(SpirobError, match="is not read"):
        read_mapping(path)
    assert not (tmp_path / "x").exists()


def test_no_channel_or_name_leaves_its_folder(tmp_path):
    for name in ("../x", "/etc/x", "a/b", ".hidden", ""):
        (tmp_path / "map.yaml").write_text(yaml.safe_dump(MAP | {"name": name}))
        with pytest.raises(SpirobError, match="key 'name'"):
            read_mapping(tmp_path / "map.yaml")


@settings(max_examples=100, deadline=None)
@given(raw=st.binary(max_size=300))
def test_any_bytes_as_a_trace_are_refused(tmp_path_factory, raw):
    path = tmp_path_factory.mktemp("p") / "x.parquet"
    path.write_bytes(b"PAR1" + raw + b"PAR1")
    with pytest.raises(SpirobError, match=r"x\.parquet"):
        read_parquet(path)
