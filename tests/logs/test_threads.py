"""Logs are read from several threads at once, as parallel sweeps do."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from spirob.logs.records import read_content
from tests.trials.fake_robot import FakeRobot
from tests.trials.trials import record_on

TURNS = 60


def test_four_threads_read_what_one_reads(tmp_path):
    path = record_on(FakeRobot(), tmp_path, duration=2.0)
    alone = read_content(path)
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: read_content(path), range(TURNS)))
    for content in found:
        assert content.attachments == alone.attachments
        assert content.messages.keys() == alone.messages.keys()
        for topic, messages in content.messages.items():
            assert np.array_equal(messages, alone.messages[topic])
