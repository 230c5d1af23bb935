"""`spirob watch` prints what happens on a bus, sends nothing, and says what is wrong."""

import threading
import time

import can
import numpy as np
import pytest
from can.interfaces import virtual

from spirob.cli.main import main
from spirob.perceive.model_file import save_model
from spirob.perceive.passive import learned
from spirob.trials.trial import wrap_trial
from tests.perceive.live.played import frames_and_features, pushed
from tests.perceive.test_passive import drawn


def play(channel, frames, sent_back):
    """Put frames on a virtual bus once somebody else is on it; what others send is kept."""
    with can.Bus(interface="virtual", channel=channel, preserve_timestamps=True) as bus:
        while len(virtual.channels[channel]) < 2:
            time.sleep(0.01)
        for frame in frames:
            bus.send(
                can.Message(
                    timestamp=frame.stamp_ns / 1e9,
                    arbitration_id=frame.arbitration_id,
                    is_extended_id=False,
                    data=frame.data,
                )
            )
        while len(virtual.channels[channel]) > 1:
            time.sleep(0.01)
        while (message := bus.recv(0)) is not None:
            sent_back.append(message)


def test_a_contact_is_printed_and_nothing_is_sent(tmp_path, capsys):
    plain = wrap_trial("wrap", "heldout", 0.04, {}, np.random.default_rng(0))
    frames, _ = frames_and_features(plain, tmp_path, features=False)
    sent_back = []
    player = threading.Thread(target=play, args=("watched", frames, sent_back))
    player.start()
    asked = ["--interface", "virtual", "--channel", "watched", "--seconds", "4"]
    assert main(["watch", *asked, "--model", "none"]) == 0
    player.join(timeout=10)
    assert not player.is_alive()
    assert sent_back == []
    first, *lines = capsys.readouterr().out.splitlines()
    assert first.startswith("both motors are heard on Virtual bus channel watched")
    assert len(lines) == 1
    assert "left   contact: +" in lines[0]


def test_a_push_is_told_from_drives_that_take_voltages(tmp_path, capsys):
    save_model(learned(*drawn(60, 0)), tmp_path / "regions.skops")
    sent_back = []
    player = threading.Thread(target=play, args=("pushed", pushed(tmp_path), sent_back))
    player.start()
    asked = ["--interface", "virtual", "--channel", "pushed", "--seconds", "4", "--gear", "1"]
    asked += ["--drive", "gm6020", "--passive", str(tmp_path / "regions.skops")]
    assert main(["watch", *asked, "--model", "none"]) == 0
    player.join(timeout=10)
    assert not player.is_alive()
    assert sent_back == []
    told = [line for line in capsys.readouterr().out.splitlines() if "push: " in line]
    assert len(told) == 2
    assert 0.9 < float(told[0].split()[0]) < 1.0
    assert told[0].endswith("both   push: felt")
    assert told[1].endswith("mA at most")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ["--interface", "virtual", "--model", "none", "--seconds", "0.3"],
            "no feedback",
        ),
        (["--interface", "smoke", "--model", "none"], "no interface 'smoke'"),
        (["--interface", "virtual", "--model", "nowhere.skops"], "nowhere.skops"),
        (["--interface", "virtual", "--model", "none", "--passive", "none.skops"], "none.skops"),
        (["--interface", "virtual", "--seconds", "nan"], "--seconds nan is out of range"),
        (["--interface", "virtual", "--gear", "0", "--model", "none"], "gear_ratio"),
        (["--interface", "virtual", "--drive", "none", "--model", "none"], "no drive 'none'"),
    ],
)
def test_a_mistake_is_one_sentence(capsys, arguments, said):
    assert main(["watch", *arguments]) == 2
    spoken = capsys.readouterr().err
    assert said in spoken
    assert len(spoken.strip().splitlines()) == 1
