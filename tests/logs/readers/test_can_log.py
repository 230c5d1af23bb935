"""Frames of CAN, decoded by a DBC file: any writer, many messages, broken lines."""

import can
import numpy as np
import pytest

from spirob.errors import DataError, MissingChannel, NothingLeft
from spirob.logs.readers import read_table

DBC = """VERSION ""
BU_: X
BO_ 256 Motor: 8 X
 SG_ position : 0|16@1- (0.01,5) [0|0] "deg" X
 SG_ current : 23|12@0- (0.1,0) [0|0] "A" X
 SG_ state : 48|8@1+ (1,0) [0|0] "" X
BO_ 257 Other: 2 X
 SG_ current : 0|16@1- (0.5,0) [0|0] "A" X
BO_ 258 Many: 3 X
 SG_ which M : 0|8@1+ (1,0) [0|0] "" X
 SG_ cold m0 : 8|16@1- (1,0) [0|0] "" X
 SG_ warm m1 : 8|16@1- (1,0) [0|0] "" X
VAL_ 256 state 1 "on" 0 "off" ;
"""


def lines(count=20):
    """A frame of the motor every 10 ms; the other message comes every 20 ms, 1 ms before."""
    found = []
    for k in range(count):
        stamp = 1_700_000_000 + 0.01 * k
        if k % 2 == 0:
            found.append((stamp - 0.001, "can0", 257, (2 * k).to_bytes(2, "little", signed=True)))
        data = (100 * k).to_bytes(2, "little", signed=True)
        data += (-k % 4096 << 4).to_bytes(2, "big") + bytes([0, 0, 1, 0])
        found.append((stamp, "can0", 256, data))
    return found


def compact(stamp, bus, number, data):
    return f"({stamp:.6f}) {bus} {number:03X}#{data.hex().upper()}"


def seen(stamp, bus, number, data):
    return f" ({stamp:.6f})  {bus}  {number:03X}   [{len(data)}]  {data.hex(' ').upper()}"


@pytest.fixture
def dbc(tmp_path):
    (tmp_path / "a.dbc").write_text(DBC)
    return tmp_path / "a.dbc"


def written(folder, name="a.log", write=compact, frames=None):
    (folder / name).write_text("\n".join(write(*frame) for frame in frames or lines()) + "\n")
    return folder / name


@pytest.mark.parametrize("write", [compact, seen])
@pytest.mark.parametrize("name", ["a.log", "a.txt", "candump"])
def test_what_candump_writes_is_decoded(tmp_path, dbc, write, name):
    path = written(tmp_path, name, write)
    table = read_table(path, ["time", "position", "Motor.current", "state", "Other.current"], dbc)
    np.testing.assert_allclose(table.column("time"), 0.01 * np.arange(20), atol=1e-9)
    np.testing.assert_allclose(table.column("position"), 5.0 + np.arange(20))
    np.testing.assert_allclose(table.column("Motor.current"), -0.1 * np.arange(20))
    np.testing.assert_allclose(table.column("Other.current"), np.repeat(np.arange(0, 20, 2), 2))
    assert set(table.column("state")) == {1.0}
    assert table.units == {"time": "s"}
    assert any("Other is held at its latest value" in sentence for sentence in table.said)


def test_a_signal_that_two_messages_have_needs_its_message(tmp_path, dbc):
    table = read_table(written(tmp_path), ["current"], dbc)
    with pytest.raises(MissingChannel, match=r"'current' is missing; present: Motor\.current"):
        table.column("current")


def test_time_is_that_of_the_first_message_that_is_wanted(tmp_path, dbc):
    table = read_table(written(tmp_path), ["time", "Other.current", "position"], dbc)
    np.testing.assert_allclose(np.diff(table.column("time")), 0.02, atol=1e-9)
    np.testing.assert_allclose(table.column("position"), 5.0 + np.arange(1, 19, 2))
    assert any("before the first of all others" in sentence for sentence in table.said)


def test_messages_that_say_what_they_hold(tmp_path, dbc):
    frames = [(1.0 + 0.1 * k, "can0", 258, bytes([k % 2, k, 0])) for k in range(10)]
    table = read_table(written(tmp_path, frames=frames), ["time", "cold", "warm"], dbc)
    np.testing.assert_array_equal(table.column("cold")[:4], [0, 0, 2, 2])
    np.testing.assert_array_equal(table.column("warm")[1:4], [1, 1, 3])


def test_broken_lines_and_a_second_bus_are_said(tmp_path, dbc):
    frames = [*lines(), *((stamp, "can1", *rest) for stamp, _, *rest in lines())]
    path = written(tmp_path, frames=frames)
    with path.open("a") as file:
        file.write("(1700000001.0) can0 100#R\n(17000000\n")
    table = read_table(path, ["position"], dbc)
    assert len(table.column("position")) == 20
    said = " ".join(table.said)
    assert "2 lines that are no data frame" in said
    assert "20 frames of a second bus" in said


def test_frames_that_are_cut_or_unknown_are_no_crash(tmp_path, dbc):
    frames = [(stamp, bus, number, data[:2]) for stamp, bus, number, data in lines()]
    table = read_table(written(tmp_path, frames=frames), ["position", "Motor.current"], dbc)
    np.testing.assert_allclose(table.column("position"), 5.0 + np.arange(20))
    with pytest.raises(MissingChannel):
        table.column("Motor.current")
    frames = [(stamp, bus, number + 1000, data) for stamp, bus, number, data in lines()]
    with pytest.raises(DataError, match="knows none of its frames; identifiers: 4E8, 4E9"):
        read_table(written(tmp_path, frames=frames), ["position"], dbc)


def test_an_identifier_of_29_bits_is_another_one(tmp_path, dbc):
    frame = "(1.0) can0 00000100#0000000000000000\n"
    (tmp_path / "a.log").write_text(frame * 5)
    with pytest.raises(DataError, match="knows none of its frames"):
        read_table(tmp_path / "a.log", ["position"], dbc)


@pytest.mark.parametrize("name", ["a.asc", "a.blf", "a.trc"])
def test_what_python_can_writes_is_decoded(tmp_path, dbc, name):
    with can.Logger(tmp_path / name) as logger:
        for stamp, _, number, data in lines():
            logger(can.Message(stamp, number, is_extended_id=False, data=data, channel=1))
    table = read_table(tmp_path / name, ["time", "position"], dbc)
    np.testing.assert_allclose(np.diff(table.column("time")), 0.01, atol=2e-4)
    np.testing.assert_allclose(table.column("position"), 5.0 + np.arange(20))


def test_without_a_dbc_file_it_is_asked_for(tmp_path):
    with pytest.raises(DataError, match=r"give `dbc:` in the description, or --dbc FILE to"):
        read_table(written(tmp_path))


@pytest.mark.parametrize("content", [b"", b"\xff" * 500, b"BO_ 1 X: 8 Y\n SG_ a : x", b"{" * 9999])
def test_what_is_no_dbc_file_is_refused(tmp_path, content):
    (tmp_path / "a.dbc").write_bytes(content)
    with pytest.raises(DataError, match=r"a\.dbc: is no DBC|knows none of its frames"):
        read_table(written(tmp_path), (), tmp_path / "a.dbc")
    with pytest.raises(DataError, match=r"b\.dbc: the DBC file cannot be read"):
        read_table(written(tmp_path), (), tmp_path / "b.dbc")


def test_a_dbc_file_that_gives_a_message_twice_says_nothing_of_its_own(tmp_path, dbc, capfd):
    text = DBC + DBC[DBC.index("BO_ 257") : DBC.index("BO_ 258")] * 3
    dbc.write_text(text)
    assert read_table(written(tmp_path), ["position"], dbc).columns
    assert capfd.readouterr().err == ""


def test_a_log_without_a_frame_says_so(tmp_path, dbc):
    with can.Logger(tmp_path / "a.blf"):
        pass
    with pytest.raises(NothingLeft, match=r"a\.blf: holds no frame"):
        read_table(tmp_path / "a.blf", ["position"], dbc)


def test_a_log_that_is_none_is_refused(tmp_path, dbc):
    for name in ("a.log", "a.asc", "a.blf", "a.trc"):
        (tmp_path / name).write_text("nothing of the kind\n" * 20)
        with pytest.raises(DataError, match=name):
            read_table(tmp_path / name, (), dbc)


def test_a_clock_that_starts_again_does_not_mix_its_stretches(tmp_path, dbc):
    """Two logs one behind the other in a file, the second of which may be the older one."""
    frames = lines()
    older = [(stamp - 3600.0, *rest) for stamp, *rest in frames]
    table = read_table(written(tmp_path, frames=[*frames, *older]), ["time", "position"], dbc)
    once = read_table(written(tmp_path, "b.log", frames=frames), ["time", "position"], dbc)
    count = len(once.column("time"))
    np.testing.assert_allclose(table.column("position")[:count], once.column("position"))
    np.testing.assert_allclose(table.column("position")[count:], once.column("position"))
    assert np.all(np.diff(table.column("time")) > 0)
    assert np.diff(table.column("time")).max() > 0.9
    assert any("its clock starts again 1 times" in said for said in table.said)


def test_a_frame_too_short_for_a_signal_has_none_of_it(tmp_path, dbc):
    """What comes in turn is held until it comes again; what a frame lacks is missing."""
    frames = [f if f[2] != 256 or k % 5 else (*f[:3], f[3][:3]) for k, f in enumerate(lines(40))]
    frames += [(s, bus, 258, bytes([k % 2, k, 0])) for k, (s, bus, *_) in enumerate(lines(40))]
    path = written(tmp_path, frames=sorted(frames))
    table = read_table(path, ["time", "position", "Motor.current", "state"], dbc)
    whole = np.array([len(f[3]) > 3 for f in frames if f[2] == 256])
    assert 0 < np.sum(~whole) < 20
    np.testing.assert_array_equal(np.isfinite(table.column("state")), whole)
    assert np.isfinite(table.column("position")).all()
    turns = read_table(path, ["time", "cold", "warm"], dbc)
    assert np.isfinite(turns.column("cold")).all()
    assert np.isfinite(turns.column("warm")).mean() > 0.9


def test_no_line_of_what_is_no_dbc_file_is_printed(tmp_path):
    (tmp_path / "other.txt").write_text("secret: 1234\n")
    with pytest.raises(DataError) as told:
        read_table(written(tmp_path), ["time", "position"], tmp_path / "other.txt")
    assert str(told.value).endswith("is no DBC file: invalid syntax at line 1, column 1")


def test_a_blf_file_that_breaks_off_is_read_and_said(tmp_path, dbc):
    path = tmp_path / "a.blf"
    with can.Logger(path, max_container_size=500) as log:
        for stamp, _, number, data in lines(200):
            log(can.Message(stamp, number, is_extended_id=False, data=data))
    assert read_table(path, ["position"], dbc).said == []
    content = path.read_bytes()
    for left in range(len(content) // 2, len(content) // 2 + 100, 20):
        path.write_bytes(content[:left])
        table = read_table(path, ["position"], dbc)
        assert 0 < len(table.column("position")) < 200
        assert table.said == ["a.blf: the file breaks off; the frames before are used."]
