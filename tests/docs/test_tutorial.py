"""The tutorial's commands work, in small as the page says, and (slow) print what it shows."""

import pytest

from tests.docs.tutorial import PAGE, RUN, made_anew, run, shown, small_size
from visitlab_cli.config.files import shipped_configs


@pytest.mark.slow
def test_the_commands_work_in_small(tmp_path):
    page = PAGE.read_text()
    steps = shown(page)
    assert len(steps) >= 8
    size = small_size(page)
    for each in steps:
        assert each.output, each.command
        done = run(each.command.replace(RUN, f"{RUN} {size}"), tmp_path)
        assert done.returncode == each.code, f"{each.command}: {done.stderr}"
        same = any(words in each.command for words in ("init", "validate my-human", "validate wrong"))
        assert not same or each.output == (done.stderr if each.code else done.stdout), each.command
    assert (tmp_path / "worst.svg").stat().st_size > 10_000


def test_the_human_on_the_page_is_the_one_in_the_file():
    page, config = PAGE.read_text(), shipped_configs()["my-human"].read_text()
    shown_yaml = page.split("```yaml\n")[1].split("```")[0]
    assert len(shown_yaml.splitlines()) > 5
    assert shown_yaml in config


@pytest.mark.slow
def test_the_page_shows_what_the_commands_print(tmp_path):
    page = PAGE.read_text()
    assert made_anew(page, tmp_path) == page
