"""One synthetic run for all tests of the report; it is only read."""

from pathlib import Path

import pytest

from spirob.report import ReportData, load, render
from tests.report.synthetic import write_run


@pytest.fixture(scope="session")
def run(tmp_path_factory) -> Path:
    return write_run(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="session")
def data(run) -> ReportData:
    return load(run)


@pytest.fixture(scope="session")
def sparse(tmp_path_factory) -> ReportData:
    """A run with nothing but the required files."""
    return load(write_run(tmp_path_factory.mktemp("sparse"), optional=False))


@pytest.fixture(scope="session")
def page(data) -> str:
    return render(data)
