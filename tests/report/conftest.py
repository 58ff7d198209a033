"""What the tests of the report share: the page of the tiny run."""

import pytest

from visitlab_cli.report.making import make_report


@pytest.fixture(scope="session")
def tiny_page(tiny_run, tmp_path_factory):
    """The page of the tiny run, beside it; not to be changed."""
    return make_report(tiny_run, tmp_path_factory.mktemp("report") / "report.html")
