"""A log in SI as people keep it: its units, its clock, its kind of file; and its description."""

import json
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
from mcap.writer import Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore
from scipy.io import savemat

from tests.machine.damages import TURN

Columns = dict[str, np.ndarray]

GAIN, DAMPING = 8.0, 0.2  # of a controller of which the effort can be computed
TICKS = 8192
POSITIONS: dict[str, tuple[dict[str, Any], float]] = {
    "rad": ({"unit": "rad"}, 1.0),
    "deg": ({"unit": "deg"}, TURN / 360),
    "turn": ({"unit": "turn"}, TURN),
    "tick": ({"unit": "tick", "per_turn": TICKS}, TURN / TICKS),
    "counts": ({"unit": "turn", "factor": 1 / TICKS, "zero": 700.0}, TURN / TICKS),
}
SPEEDS: dict[str, float] = {"rad/s": 1.0, "deg/s": TURN / 360, "rpm": TURN / 60, "rev/s": TURN}
EFFORTS: dict[str, tuple[dict[str, Any], float]] = {
    "A": ({"unit": "A", "kind": "current"}, 1.0),
    "mA": ({"unit": "mA", "kind": "current"}, 1e-3),
    "torque": ({"unit": "Ncm", "kind": "torque"}, 1e-2),
    "volt": ({"unit": "V", "kind": "voltage"}, 1.0),
    "duty": ({"unit": "%", "kind": "duty", "supply": 24.0}, 0.24),
    "control": ({"unit": "A", "kind": "current", "from": "control"}, 1.0),
}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
DATES = "dates"


@dataclass(frozen=True)
class Kept:
    """How a log is kept: units of its columns, how it tells time, which columns there are."""

    position: str  # of POSITIONS, or "" where there is a speed alone
    speed: str  # of SPEEDS, or "" where there is none
    effort: str  # of EFFORTS
    time: str  # of TIMES, or DATES
    bus: str = ""  # of BUSES, or "" where logs are tables

    def description(self, **more: Any) -> dict[str, Any]:
        """The rig."""
        effort = dict(EFFORTS[self.effort][0])
        found = {"time": {"column": self._called("t"), "unit": self._clock}} | more
        if self.position:
            found["position"] = {"column": self._called("q"), **POSITIONS[self.position][0]}
        if self.speed:
            found["velocity"] = {"column": self._called("v"), "unit": self.speed}
        if self.effort == "control":
            unit = POSITIONS[self.position][0]
            found["reference"] = {"column": self._called("r"), **unit}
            found["control"] = {"kp": GAIN, "kd": DAMPING}
        else:
            effort["column"] = self._called("u")
        return {**found, "effort": effort}

    @property
    def _clock(self) -> str:
        return self.time if self.time in TIMES and self.bus in ("", "topic") else "s"

    def _called(self, name: str) -> str:
        return CALLED.get(self.bus, {}).get(name, name)

    def columns(self, log: Mapping[str, np.ndarray]) -> Columns:
        """Time, position, speed and effort [SI] and the speed felt, as this log has them."""
        found = {"t": log["t"] / TIMES.get(self._clock, 1.0)}
        if self.position:
            found["q"] = self._cells(log["q"])
        if self.speed:
            found["v"] = log["v"] / SPEEDS[self.speed]
        if self.effort == "control":
            asked = log["q"] + (log["u"] + DAMPING * log["felt"]) / GAIN
            found["r"] = self._cells(asked)
        else:
            found["u"] = log["u"] / EFFORTS[self.effort][1]
        return found

    def _cells(self, angle: np.ndarray) -> np.ndarray:
        told, size = POSITIONS[self.position]
        cells = angle / size + told.get("zero", 0.0)
        return np.round(cells) if size == TURN / TICKS else cells


def _frame(columns: Columns, dates: bool) -> pd.DataFrame:
    frame = pd.DataFrame(columns)
    if dates:
        stamps = pd.to_datetime(1.7e9 + frame["t"], unit="s", errors="coerce")
        frame["t"] = stamps.dt.strftime("%Y-%m-%dT%H:%M:%S.%fZ")
    return frame


def _csv(frame: pd.DataFrame, path: Path) -> None:
    frame.to_csv(path, index=False)


def _european(frame: pd.DataFrame, path: Path) -> None:
    frame.to_csv(path, index=False, sep=";", decimal=",")


def _commented(frame: pd.DataFrame, path: Path) -> None:
    path.write_text("# a logger\n" + frame.to_csv(index=False, sep="\t"))


def _parquet(frame: pd.DataFrame, path: Path) -> None:
    frame.to_parquet(path)


def _npz(frame: pd.DataFrame, path: Path) -> None:
    np.savez(path, **{name: frame[name].to_numpy() for name in frame})


def _mat(frame: pd.DataFrame, path: Path) -> None:
    savemat(path, {"log": {name: frame[[name]].to_numpy() for name in frame}})


def _mat73(frame: pd.DataFrame, path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        for name in frame:  # a column of MATLAB's is a row of HDF5
            file[name] = frame[[name]].to_numpy().T
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


def _hdf5(frame: pd.DataFrame, path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name in frame:
            file[f"run/{name}"] = frame[name].to_numpy()


def _json(frame: pd.DataFrame, path: Path) -> None:
    path.write_text(json.dumps({"data": frame.to_dict("list")}))


def _rows(frame: pd.DataFrame, path: Path) -> None:
    frame.to_json(path, orient="records", double_precision=15)


def _lines(frame: pd.DataFrame, path: Path) -> None:
    frame.to_json(path, orient="records", lines=True, double_precision=15)


def _frames(frame: pd.DataFrame, path: Path) -> None:
    """As candump writes it: a message for each column, in the order of time."""
    lines = []
    for row in frame.to_dict("records"):
        for number, name in enumerate(ON_BUS):
            if name in row:
                data = struct.pack("<d", row[name]).hex().upper()
                lines.append(f"({row['t'] + 1e-5 * number:.6f}) can0 {513 + number:X}#{data}")
    path.write_text("\n".join(lines))


def _messages(frame: pd.DataFrame, path: Path) -> None:
    """One topic, its stamps in the messages."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("Any", "jsonschema", b"{}")
        channel = writer.register_channel("/axis", "json", schema)
        for k, row in enumerate(frame.to_dict("records")):
            at = 1_700_000_000_000_000_000 + 1_000_000 * k
            writer.add_message(channel, at, json.dumps(row).encode(), at)
        writer.finish()


def _bag(frame: pd.DataFrame, path: Path, plugin: StoragePlugin) -> None:
    """A bag of ROS 2: states of a joint, and of what is asked of it; whole stamps, none is NaN."""
    store, kind = get_typestore(Stores.LATEST), "sensor_msgs/msg/JointState"
    types = [f"{p}/msg/{t}" for p, t in (("builtin_interfaces", "Time"), ("std_msgs", "Header"))]
    time, header, state = (store.types[name] for name in (*types, kind))
    with BagWriter(path, version=9, storage_plugin=plugin) as bag:
        topic = bag.add_connection("/joint_states", kind, typestore=store)
        for k, row in enumerate(frame.to_dict("records")):
            told = min(int(1e9 * np.nan_to_num(row["t"])), 10**9 * (2**31 - 1))
            both = [
                np.array([row.get(one, 0.0), row.get(other, 0.0)])
                for one, other in (("q", "r"), ("v", ""), ("u", ""))
            ]
            stamp = time(*divmod(told, 10**9))
            message = state(header(stamp, "base"), ["axis", "asked"], *both)
            bag.write(topic, 10**18 + 10**6 * k, store.serialize_cdr(message, kind))


def _bag_db3(frame: pd.DataFrame, path: Path) -> None:
    _bag(frame, path, StoragePlugin.SQLITE3)


def _bag_mcap(frame: pd.DataFrame, path: Path) -> None:
    _bag(frame, path, StoragePlugin.MCAP)


# kind -> the ending of its name, who writes it, and whether dates fit in
FILES: dict[str, tuple[str, Callable[[pd.DataFrame, Path], None], bool]] = {
    "csv": (".csv", _csv, True),
    "european": (".csv", _european, True),
    "commented": (".txt", _commented, True),
    "parquet": (".parquet", _parquet, True),
    "npz": (".npz", _npz, False),
    "mat": (".mat", _mat, False),
    "mat 7.3": (".mat", _mat73, False),
    "hdf5": (".h5", _hdf5, False),
    "json": (".json", _json, True),
    "rows": (".json", _rows, True),
    "lines": (".jsonl", _lines, True),
}
FRAME = "frame"
BUSES: dict[str, tuple[str, Callable[[pd.DataFrame, Path], None], bool]] = {
    "can": (".log", _frames, False),
    "topic": (".mcap", _messages, False),
    "ros 2 db3": ("", _bag_db3, False),
    "ros 2 mcap": ("", _bag_mcap, False),
}
IN_BAG = {
    "t": "/joint_states.header.stamp",
    "q": "/joint_states.position[axis]",
    "r": "/joint_states.position[asked]",
    "v": "/joint_states.velocity[0]",
    "u": "/joint_states.effort[axis]",
}
# bus -> what its logs call the columns, where that is another name
CALLED: dict[str, dict[str, str]] = {
    "can": {"t": "time"},
    "topic": {name: f"/axis.{name}" for name in "tqvur"},
    "ros 2 db3": IN_BAG,
    "ros 2 mcap": IN_BAG,
}
ON_BUS = "ruvq"  # the position last, at which the others are held
DBC = "\n".join(
    [
        'VERSION ""',
        "BU_: X",
        *(
            f'BO_ {513 + k} M{name}: 8 X\n SG_ {name} : 0|64@1- (1,0) [0|0] "" X'
            for k, name in enumerate(ON_BUS)
        ),
        *(f"SIG_VALTYPE_ {513 + k} {name} : 2;" for k, name in enumerate(ON_BUS)),
        "",
    ]
)


def written(columns: Columns, dates: bool, kind: str, path: Path) -> Path | pd.DataFrame:
    """The log in a file of this kind, or as a table; without an ending `path` is its name."""
    frame = _frame(columns, dates)
    if kind == FRAME:
        frame.attrs["name"] = path.name
        return frame
    ending, write, holds_dates = (FILES | BUSES)[kind]
    if dates and not holds_dates:
        ending, write, _ = FILES["csv"]
    write(frame, path.with_suffix(ending))
    return path.with_suffix(ending)
