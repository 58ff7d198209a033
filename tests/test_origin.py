"""What visitlab draws and lays out takes the place of nothing but another such file, whatever the command."""

import os
import shutil
import struct
import zlib

import pytest

from tests.program import visitlab
from visitlab_cli.errors import UsageError
from visitlab_cli.origin import METADATA, check_ours, is_ours, marked_png
from visitlab_cli.same_pictures import same_pictures
from visitlab_cli.whole_file import write_again

PNG = b"\x89PNG\r\n\x1a\n" + b"".join(
    struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    for kind, data in (
        (b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0)),
        (b"IDAT", zlib.compress(b"\0\0")),
        (b"IEND", b""),
    )
)
THEIRS = {
    "a text": b"three years of work\n",
    "a PNG": PNG,
    "an SVG": b'<?xml version="1.0" encoding="utf-8"?>\n<svg xmlns="http://www.w3.org/2000/svg"/>\n',
    "a PDF": b"%PDF-1.4\n%\xac\xdc\n1 0 obj\n<< /Creator (Word) >>\nendobj\n",
    "a recording": b"RRF2\0\x29\0\0 of another program",
    "a page": b"<!doctype html>\n<p>three years of work",
    "a text that names the mark": b"<dc:title>visitlab</dc:title> /Creator (visitlab)",
}
COMMANDS = {
    "strip": ("replay", "RUN", "--strip", "FILE.svg"),
    "strip as PDF": ("replay", "RUN", "--strip", "FILE.pdf"),
    "save": ("replay", "RUN", "--save", "FILE.rrd"),
    "png": ("replay", "RUN", "--step", "0", "--png", "FILE.png"),
    "affordances": ("affordances", "RUN", "--picture", "FILE.png"),
    "matrix": ("eval", "RUN", "--matrix", "--picture", "FILE.pdf"),
    "report": ("report", "RUN", "-o", "FILE.html"),
    "export": ("export", "RUN", "--parquet", "-o", "FILE.parquet"),
}


@pytest.mark.parametrize("content", THEIRS.values(), ids=THEIRS)
def test_what_does_not_say_that_it_is_ours_is_kept(tmp_path, content):
    file = tmp_path / "thesis.svg"
    file.write_bytes(content)
    with pytest.raises(UsageError, match=r"thesis.svg: exists and was not written by visitlab; move it away or choose"):
        write_again(file, b"ours")
    assert file.read_bytes() == content


@pytest.mark.parametrize("kind", METADATA)
def test_every_picture_says_that_it_is_ours_and_nothing_of_when(tmp_path, kind):
    figure = pytest.importorskip("matplotlib.figure").Figure
    file = tmp_path / f"a.{kind}"
    with same_pictures({}):
        drawn = figure()
        for _ in range(60):  # a PDF with a long list of objects at its end
            drawn.add_subplot().plot([0, 1])
        drawn.savefig(file, metadata=METADATA[kind])
    assert is_ours(file)
    check_ours(file)
    assert b"20" + b"26-" not in file.read_bytes()


def test_the_viewers_picture_is_marked_and_still_one(tmp_path):
    (tmp_path / "a.png").write_bytes(marked_png(PNG))
    assert is_ours(tmp_path / "a.png")
    image = pytest.importorskip("PIL.Image").open(tmp_path / "a.png")
    image.load()
    assert (image.size, image.info["Software"]) == ((1, 1), "visitlab")


def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "a.svg")
    with pytest.raises(UsageError, match="was not written by visitlab"):
        check_ours(tmp_path / "a.svg")


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_no_command_overwrites_what_is_somebody_elses(tiny_run, tmp_path, words):
    (target,) = (tmp_path / word for word in words if word.startswith("FILE"))
    target.write_bytes(THEIRS["a PDF"] if target.suffix == ".pdf" else THEIRS["an SVG"])
    before = target.read_bytes()
    done = visitlab(*(tiny_run if word == "RUN" else target if word.startswith("FILE") else word for word in words))
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert done.stderr.startswith(f"{target}: exists")
    assert target.read_bytes() == before
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("words", [COMMANDS["strip"], COMMANDS["strip as PDF"], COMMANDS["save"], COMMANDS["report"]])
def test_what_is_ours_is_written_anew(tiny_run, tmp_path, words):
    (target,) = (tmp_path / word for word in words if word.startswith("FILE"))
    command = [tiny_run if word == "RUN" else target if word.startswith("FILE") else word for word in words]
    for _ in range(2):
        assert visitlab(*command).returncode == 0
    assert is_ours(target)


@pytest.mark.parametrize("name", ["fig6.svg", "grid.pdf"])
def test_a_drawing_of_the_users_in_a_run_stays(tiny_run, tmp_path, name):
    tiny_copy = shutil.copytree(tiny_run, tmp_path / tiny_run.name)
    shutil.rmtree(tiny_copy / "figures", ignore_errors=True)
    (tiny_copy / "figures").mkdir()
    (tiny_copy / "figures" / name).write_text("mine")
    done = visitlab("figures", tiny_copy, "--format", name[-3:])
    assert done.returncode == 2
    assert done.stderr == (
        f"{tiny_copy}/figures/{name}: exists and was not written by visitlab; move it away or choose another file\n"
    )
    assert [file.name for file in (tiny_copy / "figures").iterdir()] == [name]
    assert (tiny_copy / "figures" / name).read_text() == "mine"
