"""An MCAP log as a `Trace` in SI units, derived from the raw frames.

Row k stands for cycle k, t_k = t_0 + k ms.  Measured channels are the latest feedback received
before the command of cycle k went out, the command and references are what was sent then: the
state at t_k and the input held from t_k to t_(k+1).  Where a cycle or a frame is missing the value
before it holds, and `meta["frames"]` counts it.
"""

from pathlib import Path
from typing import Any

import numpy as np
import yaml

from spirob.control.law import CURRENT, DISPLACEMENT, FORCE, VELOCITY
from spirob.drives import Drive
from spirob.drives.drive import translated
from spirob.errors import ConfigError, DataError, MissingChannel, TooShort
from spirob.logs.cycles import Cycles, Transmission
from spirob.logs.messages import unpack_commands, unpack_frames
from spirob.logs.records import Content, read_content
from spirob.logs.schema import (
    ABOUT,
    COMMAND_TOPIC,
    DBC_FILE,
    DRIVE_FILE,
    LOOP,
    RAW_TOPIC,
    STOPPED,
    TRIAL_FILE,
)
from spirob.robot import MOTORS
from spirob.trace import Trace, moving_average

FILTER_WINDOW = 100  # samples of the current filter in the paper's set-up
SAFE_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # plain data only, both of them
DOCUMENT_LIMIT = 2**20  # bytes of trial.yaml
REFERENCE_UNITS = {CURRENT: "A", VELOCITY: "m/s", DISPLACEMENT: "m", FORCE: "N"}
CHANNELS = {
    "current": "A",
    "current_filtered": "A",
    "displacement": "m",
    "velocity": "m/s",
    "temperature": "degC",
    "command": "A",
    "reference": "by mode",
    "reference_rate": "m/s",
    "mode": "1",
}
VOLTAGE = {"voltage": "V"}  # a channel more of motors in voltage mode


def read_log(path: Path | str, torn: bool = False) -> Trace:
    """Decode one trial's log; with `torn`, take what a log that breaks off still holds.

    Raises MissingLog, MissingChannel, TooShort (shorter than the current filter) and DataError
    (torn, corrupt, not a log of a trial), each naming the file.
    """
    content = read_content(path, torn, (RAW_TOPIC, COMMAND_TOPIC))
    try:
        return _trace(str(path), content)
    except (MissingChannel, TooShort):
        raise
    except (DataError, ConfigError, ValueError, TypeError) as error:
        said = str(error)
        raise DataError(said if said.startswith(str(path)) else f"{path}: {said}") from error


def _trace(where: str, content: Content) -> Trace:
    for topic in (RAW_TOPIC, COMMAND_TOPIC):
        if not len(content.messages.get(topic, [])):
            raise MissingChannel(where, topic, list(content.messages))
    document = _document(content)
    transmission = Transmission.from_mapping(document["transmission"])
    assert isinstance(transmission, Transmission)
    raw, dropped = unpack_frames(content.messages[RAW_TOPIC])
    drive = _drive(content) if "drive" in document else None
    if drive:
        raw = translated(drive, raw)
    asked = unpack_commands(content.messages[COMMAND_TOPIC])
    volts = drive is not None and drive.by_voltage
    channels = CHANNELS | (VOLTAGE if volts else {})
    cycles = Cycles(where, raw, asked, volts)
    if cycles.count < FILTER_WINDOW:
        raise TooShort(where, cycles.count, FILTER_WINDOW, f"the {FILTER_WINDOW}-sample filter")
    signals: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    for m, motor in enumerate(MOTORS):
        columns = cycles.feedback(m, transmission) | cycles.asked_of(m)
        columns["current_filtered"] = moving_average(columns["current"], FILTER_WINDOW, where)
        signals |= {f"{motor}.{name}": np.ascontiguousarray(columns[name]) for name in channels}
        units |= {f"{motor}.{name}": unit for name, unit in channels.items()}
        units[f"{motor}.reference"] = REFERENCE_UNITS.get(int(columns["mode"][0]), "")
    trial = document["trial"]
    meta = {
        "role": trial["role"],
        "rig": document["rig"],
        "scene": trial.get("scene") or {},
        "trial": trial,
        "transmission": document["transmission"],
        "about": content.metadata.get(ABOUT, {}),
        "frames": {"malformed": dropped, **cycles.counts},
        "torn": content.torn,
        "first_angle": cycles.first_angle,
    }
    if LOOP in content.metadata:
        meta[LOOP] = dict(content.metadata[LOOP])
    if STOPPED in content.metadata:
        meta[STOPPED] = content.metadata[STOPPED].get("reason", "")
    return Trace(str(trial["name"]), cycles.time_ns, signals, units, meta)


def _drive(content: Content) -> Drive:
    texts = [content.attachments.get(name) for name in (DRIVE_FILE, DBC_FILE)]
    if any(text is None or len(text) > DOCUMENT_LIMIT for text in texts):
        raise DataError(f"it needs attachments '{DRIVE_FILE}' and '{DBC_FILE}' of at most 1 MiB")
    text, dbc = (text.decode("utf-8", errors="replace") for text in texts if text is not None)
    return Drive.from_texts(text, dbc, DRIVE_FILE)


def _document(content: Content) -> dict[str, Any]:
    text = content.attachments.get(TRIAL_FILE)
    if text is None:
        raise DataError(f"it has no attachment '{TRIAL_FILE}', so it is no log of a trial")
    if len(text) > DOCUMENT_LIMIT:
        raise DataError(f"'{TRIAL_FILE}' has {len(text)} bytes, more than {DOCUMENT_LIMIT}")
    try:
        document = yaml.load(text, Loader=SAFE_LOADER)
        trial = document["trial"]
        complete = isinstance(trial, dict) and {"name", "role"} <= set(trial)
        complete = complete and isinstance(document["rig"], str)
        complete = complete and isinstance(document["transmission"], dict)
    except (yaml.YAMLError, UnicodeError, KeyError, TypeError, ValueError, RecursionError):
        complete = False
    if not complete:
        raise DataError(f"'{TRIAL_FILE}' needs trial (name, role), rig and transmission")
    return document
