"""What visitlab draws and lays out takes the place of nothing but another such file, whatever the command."""

import os
import shutil
import struct
import zlib

import pytest

from tests.program import visitlab
from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.origin import METADATA, check_ours, is_ours, marked_png
from visitlab_cli.same_pictures import same_pictures
from visitlab_cli.whole_file import new_file, new_folder, write_again

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
    "labs": ("labs", "quickstart", "--picture", "FILE.svg"),
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


@pytest.mark.parametrize("behind_a_link", [False, True])
@pytest.mark.parametrize(("make", "what"), [(os.mkfifo, "device or pipe"), (os.mkdir, "folder")])
def test_what_is_no_file_is_refused_and_stays(tmp_path, make, what, behind_a_link):
    there = tmp_path / "there"
    make(there)
    kind = there.stat().st_mode
    file = tmp_path / "a.svg" if behind_a_link else there
    if behind_a_link:
        file.symlink_to("there")
    with pytest.raises(UsageError, match=f"^{file}: is a {what}; choose a file$"):
        write_again(file, b"ours")
    for new in (new_file, new_folder):
        with pytest.raises(UsageError, match=f"^{file}: exists"), new(file):
            pytest.fail("it was begun")
    assert there.stat().st_mode == kind
    assert file.is_symlink() == behind_a_link


def _new_file(path):
    with new_file(path) as beside:
        beside.write_bytes(b"ours")


def _new_folder(path):
    with new_folder(path) as folder:
        folder.mkdir()


@pytest.mark.parametrize("write", [lambda path: write_again(path, b"ours"), _new_file, _new_folder])
def test_a_link_stays_and_what_it_leads_to_is_written(tmp_path, write):
    (tmp_path / "elsewhere").mkdir()
    file = tmp_path / "a.svg"
    file.symlink_to("elsewhere/b.svg")
    write(file)
    assert file.is_symlink()
    assert file.is_dir() if write is _new_folder else file.read_bytes() == b"ours"
    assert {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*")} == {
        "a.svg",
        "elsewhere",
        "elsewhere/b.svg",
    }


def test_what_a_link_leads_to_is_as_safe_as_any_file(tmp_path):
    file, theirs, empty = (tmp_path / name for name in ("a.svg", "theirs", "empty"))
    theirs.write_bytes(THEIRS["an SVG"])
    empty.touch()
    file.symlink_to("theirs")
    with pytest.raises(UsageError, match="was not written by visitlab"):
        write_again(file, b"ours")
    with pytest.raises(UsageError, match="exists"):
        _new_file(file)
    assert theirs.read_bytes() == THEIRS["an SVG"]
    file.unlink()
    file.symlink_to("empty")
    write_again(file, b"ours")
    assert empty.read_bytes() == b"ours"
    file.unlink()
    file.symlink_to("a.svg")
    with pytest.raises(RunError, match="Too many levels of symbolic links"):
        write_again(file, b"ours")
    assert file.is_symlink()


@pytest.mark.parametrize("name", ["strip", "save", "affordances", "report", "export", "labs"])
def test_no_command_replaces_a_link(tiny_run, tmp_path, name):
    words = COMMANDS[name]
    (target,) = (tmp_path / word for word in words if word.startswith("FILE"))
    target.symlink_to(f"behind{target.suffix}")
    words = (tiny_run if word == "RUN" else target if word.startswith("FILE") else word for word in words)
    done = visitlab(*words)
    assert done.returncode == 0, done.stderr
    assert target.is_symlink()
    assert (tmp_path / f"behind{target.suffix}").stat().st_size


@pytest.mark.parametrize("path", [".", "/", ".."])
@pytest.mark.parametrize("words", [["report", "RUN", "-o"], ["export", "RUN", "--foxglove", "-o"]])
def test_a_path_that_ends_in_no_name_is_refused(tiny_run, tmp_path, words, path):
    done = visitlab(*(tiny_run if word == "RUN" else word for word in words), path, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.splitlines()[-1].startswith(f"{path}: ")


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
