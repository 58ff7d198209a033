"""`init`: what it writes is valid as it stands, is not overwritten by accident, and has what it includes."""

import json
import os

import pytest

from tests.program import visitlab
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load

NAMES = [name for name in shipped_configs() if "/" not in name]


@pytest.mark.parametrize("name", [*NAMES, "paper/fig8_humans"])
def test_what_it_writes_is_the_shipped_config(name, tmp_path):
    done = visitlab("init", name, "--folder", tmp_path / "new folder", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert config_hash(load(told["config"])) == config_hash(load(name))
    assert set(told["files"]) == {str(file) for file in (tmp_path / "new folder").rglob("*") if file.is_file()}
    assert load(told["config"]).name == name.rpartition("/")[2]


def test_it_writes_quickstart_here_with_its_comments(tmp_path):
    done = visitlab("init", cwd=tmp_path)
    assert done.stdout == "quickstart.yaml\nschema.json\n"
    assert done.stderr == "next: visitlab run quickstart.yaml\n"
    assert (tmp_path / "quickstart.yaml").read_bytes() == shipped_configs()["quickstart"].read_bytes()


def test_what_was_edited_is_not_overwritten(tmp_path):
    assert visitlab("init", "my-human", cwd=tmp_path).returncode == 0
    assert visitlab("init", "my-human", cwd=tmp_path).returncode == 0  # nothing would change
    config = tmp_path / "my-human.yaml"
    config.write_text("name: mine\n")
    (tmp_path / "schema.json").unlink()
    done = visitlab("init", "my-human", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (4, "")
    assert done.stderr == (
        "my-human.yaml: is there already, with another content; --force overwrites it, --folder writes elsewhere\n"
    )
    assert [file.name for file in tmp_path.iterdir()] == ["my-human.yaml"]
    assert visitlab("init", "my-human", "--force", cwd=tmp_path).returncode == 0
    assert load(config).name == "my-human"


def test_a_wrong_name_and_a_folder_that_cannot_be(tmp_path):
    done = visitlab("init", "my_human", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (5, "my_human: no such example; did you mean my-human?\n")
    (tmp_path / "file").touch()
    done = visitlab("init", "--folder", tmp_path / "file")
    assert done.returncode == 4
    assert done.stderr.startswith(f"{tmp_path / 'file'}: can't be written: ")


@pytest.mark.parametrize("force", [(), ("--force",)])
@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir])
def test_what_is_no_file_is_neither_waited_for_nor_written(tmp_path, make, force):
    make(tmp_path / "schema.json")
    done = visitlab("init", *force, cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (4, 1)
    assert done.stderr.startswith("schema.json: is no file")
    assert [file.name for file in tmp_path.iterdir()] == ["schema.json"]
