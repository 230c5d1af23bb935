"""Where the cases are played: on the cores of this machine, or on a Dask cluster."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from joblib import parallel_config

from spirob.errors import ConfigError

TIMEOUT = 5.0  # s for the scheduler to answer, and then for its first worker


@contextmanager
def cluster(scheduler: str | None) -> Iterator[None]:
    """Inside, joblib's jobs run on the workers of this Dask scheduler; on this machine if None.

    scheduler  address, "tcp://10.0.0.5:8786"

    Raises ConfigError where Dask is not installed, the address does not answer or has no worker.
    """
    if scheduler is None:
        yield
        return
    with _client(scheduler), parallel_config(backend="dask"):
        yield


def _client(scheduler: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise ConfigError(
            f"scheduler {scheduler}: needs Dask, which is not installed: "
            'pip install -e ".[cluster]"'
        ) from None
    try:
        client = Client(scheduler, timeout=TIMEOUT)
    except (OSError, ValueError) as error:
        raise ConfigError(
            f"scheduler {scheduler}: no Dask scheduler answers there within {TIMEOUT:g} s "
            f"({str(error) or type(error).__name__})"
        ) from None
    try:
        client.wait_for_workers(1, timeout=TIMEOUT)
    except TimeoutError:
        client.close()
        raise ConfigError(f"scheduler {scheduler}: it answers, but has no worker") from None
    return client
