"""One trial, one MCAP file, readable up to the last half second whatever happens.

For a loop with deadlines a thread of its own writes the log, in order: packing, compressing and
writing a chunk of a log takes up to a few milliseconds, which a cycle of one millisecond does not
have.
"""

import io
import platform
import queue
import subprocess
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Self

import yaml
from mcap.writer import CompressionType, Writer

import spirob
from spirob.can.drive import Drive
from spirob.can_protocol import CanFrame
from spirob.errors import DataError
from spirob.files import publish
from spirob.logs.cycles import Transmission
from spirob.logs.messages import (
    ABOUT,
    COMMAND_TOPIC,
    CONFIG_FILE,
    DBC_FILE,
    DRIVE_FILE,
    JOINTS_TOPIC,
    LOOP,
    RAW_TOPIC,
    SCHEMAS,
    STOPPED,
    TRIAL_FILE,
    JointPacker,
    pack_command,
    pack_frame,
)
from spirob.robot import MOTORS

PACKAGES = ("numpy", "mujoco")


def versions() -> dict[str, str]:
    """Versions of Python, spirob and of the packages that decide the numbers."""
    found = {"python": platform.python_version(), "spirob": spirob.__version__}
    return found | installed(PACKAGES)


def installed(packages: Iterable[str]) -> dict[str, str]:
    """Versions of packages, "absent" where one is not there."""
    found = {}
    for package in packages:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "absent"
    return found


def git_commit(folder: Path | str) -> str:
    """Commit of the work tree that `folder` lies in; 'unknown' where there is none."""
    command = ["git", "-C", str(folder), "rev-parse", "HEAD"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return answer.stdout.strip()


CHUNK_BYTES = 64 * 1024  # about 0.15 s: what a power cut may cost


class TrialLog:
    """Writes a trial's log; a context manager.

    The log grows under `<name>.part` beside `path` and gets its name when the block ends well.
    After an exception the `.part` file stays: closed, readable, for looking into the fault, whose
    sentence is its metadata 'stopped'.
    All stamps are the robot's own, so a simulated trial gives the same bytes every time.

    path          of the finished log, `*.mcap`
    trial         the trial as plain data, with at least `name` and `role`
    transmission  nominal, from counts to SI
    rig           name of the machine
    config        bytes of the resolved configuration; must not hold the emulator's truth
    drive         whose frames these are where they are not C620-style; its files are attached
    about         further provenance as text, e.g. git_commit, start_time
    timing        how the loop kept its deadlines, as text; set before the block ends

    Raises DataError where the file cannot be opened or written.
    """

    def __init__(
        self,
        path: Path | str,
        *,
        trial: Mapping[str, Any],
        transmission: Transmission,
        rig: str,
        config: bytes = b"",
        about: Mapping[str, str] | None = None,
        drive: Drive | None = None,
    ):
        self.path = Path(path)
        self.partial = self.path.with_name(self.path.name + ".part")
        self._about = {
            "trial": str(trial["name"]),
            "role": str(trial["role"]),
            "rig": rig,
            **versions(),
            **(about or {}),
        }
        numbers = {name: getattr(transmission, name) for name in transmission.parameters()}
        document: dict[str, Any] = {"trial": dict(trial), "rig": rig, "transmission": numbers}
        if drive:
            document["drive"] = drive.about.name
        self._attachments = {
            CONFIG_FILE: config,
            TRIAL_FILE: yaml.safe_dump(document, sort_keys=False, allow_unicode=True).encode(),
        }
        if drive:
            self._attachments |= {
                DRIVE_FILE: drive.text.encode(),
                DBC_FILE: drive.dbc_text.encode(),
            }
        self._joints = JointPacker(MOTORS)
        self._sequence = 0
        self.timing: Mapping[str, str] = {}

    def __enter__(self) -> Self:
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            # A buffer of one byte: each finished chunk reaches the operating system at once.
            self._file = io.BufferedWriter(io.FileIO(self.partial, "wb"), buffer_size=1)
        except OSError as error:
            raise DataError(f"{self.path}: cannot write the log: {error.strerror}") from error
        self._writer = Writer(
            self._file,
            chunk_size=CHUNK_BYTES,
            compression=CompressionType.ZSTD,
            enable_data_crcs=True,
        )
        self._writer.start(profile="", library=f"spirob {self._about['spirob']}")
        self._writer.add_metadata(ABOUT, self._about)
        for name, content in self._attachments.items():
            self._writer.add_attachment(0, 0, name, "application/yaml", content)
        channels = []
        for topic in (RAW_TOPIC, JOINTS_TOPIC, COMMAND_TOPIC):
            name, descriptor = SCHEMAS[topic]
            schema = self._writer.register_schema(name, "protobuf", descriptor)
            channels.append(self._writer.register_channel(topic, "protobuf", schema))
        self._raw, self._joint_states, self._command = channels
        return self

    def frames(self, frames: Sequence[CanFrame]) -> None:
        """Keep frames just as they were received, in the order they were."""
        try:
            for frame in frames:
                stamp = frame.stamp_ns
                data = pack_frame(stamp, frame.arbitration_id, frame.data)
                self._writer.add_message(self._raw, stamp, data, stamp, self._sequence)
        except OSError as error:
            raise self._unwritable(error) from error

    def cycle(
        self,
        stamp_ns: int,
        positions: Sequence[float],
        velocities: Sequence[float],
        efforts: Sequence[float],
        currents: Sequence[float],
        references: Sequence[float],
        rates: Sequence[float],
        modes: Sequence[int],
    ) -> None:
        """Keep what was measured at the start of a cycle and what was asked in it, by motor.

        stamp_ns    of this cycle's command frame
        positions, velocities, efforts   [m], [m/s], [N] at the tendon
        currents    commanded [A];  references and modes as in `Schedule`;  rates [m/s]
        """
        add, sequence = self._writer.add_message, self._sequence
        joints = self._joints(stamp_ns, positions, velocities, efforts)
        command = pack_command(stamp_ns, currents, references, rates, modes)
        try:
            add(self._joint_states, stamp_ns, joints, stamp_ns, sequence)
            add(self._command, stamp_ns, command, stamp_ns, sequence)
        except OSError as error:
            raise self._unwritable(error) from error
        self._sequence = sequence + 1

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        try:
            if self.timing:
                self._writer.add_metadata(LOOP, dict(self.timing))
            if error is not None:
                self._writer.add_metadata(STOPPED, {"reason": str(error) or type(error).__name__})
            self._writer.finish()
            self._file.close()
        except OSError as failed:
            with suppress(OSError):
                self._file.close()  # flushes again, fails again, and closes
            if error is None:
                raise self._unwritable(failed) from failed
        if kind is None:
            publish(self.partial, self.path)

    def _unwritable(self, error: OSError) -> DataError:
        return DataError(
            f"{self.path}: the log cannot be written: {error.strerror}; what came before is in "
            f"{self.partial.name}, see `spirob recover`"
        )


MOST = 120_000  # pieces of work waiting: a minute of a loop at 1 kHz


class Background:
    """Takes calls and makes them later; what a call raises comes back at the next one.

    Nothing more is done after an error.  Not reentrant: one thread gives the work.
    """

    def __init__(self) -> None:
        self._work: queue.SimpleQueue[tuple[Callable[..., Any], tuple[Any, ...]] | None]
        self._work = queue.SimpleQueue()
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    def __call__(self, function: Callable[..., Any], *arguments: Any) -> None:
        """`function(*arguments)` soon; the arguments must not change any more.

        Raises what an earlier call raised, and DataError where the work does not keep up.
        """
        if self._error is not None:
            raise self._error
        if self._work.qsize() > MOST:
            raise DataError("the log cannot be written as fast as it comes in: the disk is slow")
        self._work.put((function, arguments))

    def close(self) -> None:
        """Wait until everything is done; raises what a call raised."""
        if self._thread.is_alive():
            self._work.put(None)
            self._thread.join()
        if self._error is not None:
            raise self._error

    def _run(self) -> None:
        while (work := self._work.get()) is not None:
            function, arguments = work
            if self._error is None:
                try:
                    function(*arguments)
                except BaseException as error:
                    self._error = error


class ThreadedLog(TrialLog):
    """Writes the same bytes; an error of the disk comes back with a later cycle.

    What is handed over must not change any more.
    """

    def __enter__(self) -> Self:
        super().__enter__()
        self._background = Background()
        return self

    def frames(self, frames: Sequence[CanFrame]) -> None:
        """Keep frames soon; raises what keeping earlier ones raised."""
        self._background(super().frames, frames)

    def cycle(self, *about: Any, **named: Any) -> None:
        """Keep a cycle soon; raises what keeping earlier ones raised."""
        assert not named  # the loop gives everything by position
        self._background(super().cycle, *about)

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        try:
            self._background.close()
        except BaseException as late:
            if error is None:
                super().__exit__(type(late), late, late.__traceback__)
                raise
        super().__exit__(kind, error, trace)
