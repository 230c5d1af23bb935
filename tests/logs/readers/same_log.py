"""One small log, written as every kind that is read."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import can
import cantools
import h5py
import numpy as np
import pandas as pd
from mcap.writer import Writer
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore
from scipy.io import savemat

N = 300
TIME = np.arange(N) * 0.005
Q = np.round(np.sin(7 * TIME), 4)
AMP = np.round(0.5 + 0.2 * np.cos(5 * TIME), 3)
FRAME = pd.DataFrame({"time": TIME, "q": Q, "amp": AMP})
STAMPS = 1_700_000_000_000_000_000 + np.arange(N) * 5_000_000
DBC = """VERSION ""
BU_: X
BO_ 513 Servo: 8 X
 SG_ q : 0|32@1- (0.0001,0) [0|0] "rad" X
BO_ 2147484161 Drive: 2 X
 SG_ amp : 7|12@0- (0.001,0) [0|0] "A" X
"""


@dataclass
class Written:
    """A log as it lies on the disk, and what its columns are called there."""

    path: Path
    time: str = "time"
    q: str = "q"
    amp: str = "amp"
    dbc: Path | None = None

    @property
    def names(self) -> list[str]:
        return [self.time, self.q, self.amp]


def _csv(folder: Path) -> Written:
    FRAME.to_csv(folder / "a.csv", index=False)
    return Written(folder / "a.csv")


def _dates(folder: Path) -> Written:
    FRAME.assign(time=pd.to_datetime(STAMPS)).to_csv(folder / "dates.csv", index=False)
    return Written(folder / "dates.csv")


def _parquet(folder: Path) -> Written:
    FRAME.to_parquet(folder / "a.parquet")
    return Written(folder / "a.parquet")


def _stamps(folder: Path) -> Written:
    FRAME.assign(time=pd.to_datetime(STAMPS)).to_parquet(folder / "stamps.parquet")
    return Written(folder / "stamps.parquet")


def _npz(folder: Path) -> Written:
    np.savez_compressed(folder / "a.npz", time=TIME, data=np.column_stack([Q, AMP]))
    return Written(folder / "a.npz", q="data[0]", amp="data[1]")


def _npy(folder: Path) -> Written:
    np.save(folder / "a.npy", FRAME.to_records(index=False))
    return Written(folder / "a.npy")


def _json(folder: Path) -> Written:
    columns = {name: list(values) for name, values in FRAME.items()}
    (folder / "a.json").write_text(json.dumps({"made": "here", "data": columns}))
    return Written(folder / "a.json")


def _rows(folder: Path) -> Written:
    FRAME.to_json(folder / "rows.json", orient="records", double_precision=15)
    return Written(folder / "rows.json")


def _lines(folder: Path) -> Written:
    FRAME.to_json(folder / "a.jsonl", orient="records", lines=True, double_precision=15)
    return Written(folder / "a.jsonl")


def _mat5(folder: Path) -> Written:
    savemat(folder / "five.mat", {"log": {"time": TIME, "q": Q}, "data": np.column_stack([Q, AMP])})
    return Written(folder / "five.mat", "log.time", "log.q", "data(2)")


def _mat73(folder: Path) -> Written:
    path = folder / "seven.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        log = file.create_group("log")
        log.attrs["MATLAB_class"] = np.bytes_("struct")
        parts = {"log/time": TIME[None], "log/q": Q[None], "data": np.vstack([Q, AMP])}
        for name, values in parts.items():  # columns of MATLAB's are rows of HDF5
            file[name] = values
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return Written(path, "log.time", "log.q", "data(2)")


def _hdf5(folder: Path) -> Written:
    with h5py.File(folder / "a.h5", "w") as file:
        file["run/time"], file["run/q"], file["run/amp"] = TIME, Q, AMP
    return Written(folder / "a.h5", "run.time", "run.q", "run.amp")


def frames() -> list[can.Message]:
    """Both signals on a bus; the frame with the current comes just before the other."""
    base = cantools.database.load_string(DBC, "dbc")
    found = []
    for stamp, q, amp in zip(STAMPS, Q, AMP, strict=True):
        for back, name, values in ((1000, "Drive", {"amp": amp}), (0, "Servo", {"q": q})):
            message = base.get_message_by_name(name)
            found.append(
                can.Message(
                    timestamp=(stamp - STAMPS[0] - back) * 1e-9 + 1.0,
                    arbitration_id=message.frame_id,
                    is_extended_id=message.is_extended_frame,
                    data=message.encode(values),
                    channel=0,
                )
            )
    return found


def _can(folder: Path, name: str) -> Written:
    with can.Logger(folder / name) as logger:
        for frame in frames():
            logger(frame)
    (folder / "a.dbc").write_text(DBC)
    return Written(folder / name, q="Servo.q", dbc=folder / "a.dbc")


def _candump(folder: Path) -> Written:
    return _can(folder, "a.log")


def _blf(folder: Path) -> Written:
    return _can(folder, "a.blf")


def _asc(folder: Path) -> Written:
    return _can(folder, "a.asc")


def told(k: int) -> dict[str, object]:
    """A JointState as JSON; its second joint does the reverse."""
    return {"name": ["elbow", "wrist"], "position": [Q[k], -Q[k]], "effort": [AMP[k], -AMP[k]]}


def _mcap(folder: Path) -> Written:
    with (folder / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("sensor_msgs/JointState", "jsonschema", b"{}")
        channel = writer.register_channel("/joint_states", "json", schema)
        for k, stamp in enumerate(STAMPS):
            writer.add_message(channel, int(stamp), json.dumps(told(k)).encode(), int(stamp))
        writer.finish()
    return Written(folder / "a.mcap", "time", *JOINTS)


JOINTS = ("/joint_states.position[0]", "/joint_states.effort[elbow]")


def joint_state(store, k: int, seq: bool):
    """A JointState of ROS."""
    seconds, rest = divmod(int(STAMPS[k]), 10**9)
    stamp = store.types["builtin_interfaces/msg/Time"](seconds, rest)
    header = store.types["std_msgs/msg/Header"](*([k] if seq else []), stamp, "base")
    state = told(k)
    numbers = [np.array(state.get(name, []), float) for name in ("position", "velocity", "effort")]
    return store.types["sensor_msgs/msg/JointState"](header, state["name"], *numbers)


def _bag1(folder: Path) -> Written:
    store = get_typestore(Stores.ROS1_NOETIC)
    kind = "sensor_msgs/msg/JointState"
    with Writer1(folder / "a.bag") as bag:
        joints = bag.add_connection("/joint_states", kind, typestore=store)
        for k, stamp in enumerate(STAMPS):
            message = joint_state(store, k, seq=True)
            bag.write(joints, int(stamp), store.serialize_ros1(message, kind))
    return Written(folder / "a.bag", "/joint_states.header.stamp", *JOINTS)


def _bag2(folder: Path, name: str, plugin: StoragePlugin) -> Written:
    store = get_typestore(Stores.LATEST)
    kind = "sensor_msgs/msg/JointState"
    with Writer2(folder / name, version=9, storage_plugin=plugin) as bag:
        joints = bag.add_connection("/joint_states", kind, typestore=store)
        for k, stamp in enumerate(STAMPS):
            bag.write(joints, int(stamp), store.serialize_cdr(joint_state(store, k, False), kind))
    return Written(folder / name, "/joint_states.header.stamp", *JOINTS)


def _bag2_mcap(folder: Path) -> Written:
    return _bag2(folder, "bag_mcap", StoragePlugin.MCAP)


def _bag2_db3(folder: Path) -> Written:
    return _bag2(folder, "bag_db3", StoragePlugin.SQLITE3)


KINDS: dict[str, Callable[[Path], Written]] = {
    "csv": _csv,
    "csv with dates": _dates,
    "parquet": _parquet,
    "parquet with stamps": _stamps,
    "npz": _npz,
    "npy": _npy,
    "json columns": _json,
    "json rows": _rows,
    "jsonl": _lines,
    "mat 5": _mat5,
    "mat 7.3": _mat73,
    "hdf5": _hdf5,
    "candump": _candump,
    "blf": _blf,
    "asc": _asc,
    "mcap": _mcap,
    "ros 1": _bag1,
    "ros 2 mcap": _bag2_mcap,
    "ros 2 db3": _bag2_db3,
}
