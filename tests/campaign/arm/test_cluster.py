"""A trial runs on a Dask cluster, or says in a sentence why it does not."""

import sys
from types import SimpleNamespace

import pytest

from spirob.campaign.arm import running
from spirob.campaign.arm.case import Case
from spirob.cli.main import main
from spirob.errors import ConfigError
from tests.campaign.arm.test_killed import fake

ADDRESS = "tcp://127.0.0.1:9"  # nobody listens at the port of "discard"


def test_without_dask_it_says_how_to_install_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "distributed", None)
    flags = ["--kinds", "cogging", "--seeds", "4", "--out", str(tmp_path / "cases.jsonl")]
    assert main(["trial", *flags, "--scheduler", ADDRESS]) == 2
    assert (
        f"scheduler {ADDRESS}: needs Dask, which is not installed: pip" in capsys.readouterr().err
    )


@pytest.mark.parametrize("error", [TimeoutError(), OSError("refused"), ValueError("no scheme")])
def test_an_address_that_does_not_answer_is_a_sentence(tmp_path, monkeypatch, error):
    def refused(address, timeout):
        assert timeout <= 5.0
        raise error

    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=refused))
    with pytest.raises(ConfigError, match="no Dask scheduler answers there within 5 s"):
        running.play([Case("none", 1)], tmp_path / "cases.jsonl", 1, scheduler=ADDRESS)


def test_a_scheduler_without_workers_is_a_sentence(monkeypatch):
    class Client:
        def __init__(self, address, timeout):
            self.closed = False

        def wait_for_workers(self, n_workers, timeout):
            raise TimeoutError

        def close(self):
            closed.append(self)

    closed = []
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Client))
    with pytest.raises(ConfigError, match="it answers, but has no worker"):
        running._client(ADDRESS)
    assert closed


def test_nobody_at_the_address(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(running, "TIMEOUT", 0.5)
    with pytest.raises(ConfigError, match="no Dask scheduler answers there"):
        running._client(ADDRESS)


def test_a_cluster_plays_the_cases(tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(running, "run", fake)  # the worker is a thread of this process
    cases, said = [Case("none", seed) for seed in range(5)], []
    with distributed.LocalCluster(1, processes=False, dashboard_address=None) as local:
        address = local.scheduler_address
        table = tmp_path / "cases.jsonl"
        results = running.play(cases, table, 1, tell=said.append, scheduler=address)
    assert [one["seed"] for one in results] == [0, 1, 2, 3, 4]
    assert len(said) == 5
    assert running.left(cases, running.known(table)) == []
