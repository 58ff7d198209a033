"""Disks, limits of the system, locks that don't work, a clock that jumps, the cache of compiled code."""

import contextlib
import errno
import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from tests.faults.fault import Try, fault
from tests.program import the_run

READERS = (
    ("runs", "verify", "--dry-run"),
    ("runs", "show"),
    ("export", "--csv"),
    ("report",),
    ("figures",),
    ("replay", "--trial", "3", "--save", "trial.rrd"),
    ("runs", "prune"),
    ("runs", "verify"),
)


@contextlib.contextmanager
def mounted(place: Path, options: str) -> Iterator[Path]:
    """A file system of its own in memory at `place`."""
    place.mkdir(exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", str(place)], check=True)
    try:
        yield place
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True)


def enlarge(place: Path, options: str) -> None:
    subprocess.run(["mount", "-o", f"remount,{options}", str(place)], check=True)


@fault("disk-full", "the disk is full after a random number of bytes; then there is room again", 12, 1, ["mount"])
def disk_full(this: Try) -> None:
    size = this.random.randrange(4, 5000)
    with mounted(this.folder / "small", f"size={size}k") as small:
        out = small / "runs"
        done = this.run(out, "--workers", this.random.choice([1, 2]))
        this.count = int(done.code != 0)
        this.told(done, 0, 4, names="No space left on device")
        kept = this.finished(out)
        enlarge(small, "size=200m")
        this.resumed(out, kept)


@fault("no-inodes", "the file system has no inodes left after a random number of files", 8, 0, ["mount"])
def no_inodes(this: Try) -> None:
    with mounted(this.folder / "small", f"size=200m,nr_inodes={this.random.randrange(3, 60)}") as small:
        out = small / "runs"
        done = this.run(out, "--workers", this.random.choice([1, 2]))
        this.count = int(done.code != 0)
        this.told(done, 0, 4, names="No space left on device")
        kept = this.finished(out)
        enlarge(small, "nr_inodes=10000")
        this.resumed(out, kept)


@fault("file-too-large", "files may have so many bytes only (a quota, RLIMIT_FSIZE)", 6, 0, ["linux"])
def file_too_large(this: Try) -> None:
    out = this.folder / "runs"
    size = this.random.randrange(100, 800_000)
    done = this.run(out, "--workers", this.random.choice([1, 2]), limits=[(resource.RLIMIT_FSIZE, size)])
    this.count = int(done.code != 0)
    this.told(done, 0, 4, names="File too large|can't be written")
    this.resumed(out)


@fault("read-only", "the runs folder can't be written: begun, finished, or looked at", 8, 0, ["mount"])
def read_only(this: Try) -> None:
    with mounted(this.folder / "small", "size=200m") as small:
        if this.index == 0:
            enlarge(small, "ro")
            this.told(this.run(small / "runs"), 4, names="[Rr]ead-only")
            return
        run = small / "runs" / this.bench.whole.name
        shutil.copytree(this.bench.whole, run)
        if this.index == 1:
            shutil.rmtree(run / "visit" / "fast" / "seed-0001")
            enlarge(small, "ro")
            this.told(this.run(small / "runs"), 4, names="[Rr]ead-only")
        else:
            enlarge(small, "ro")
            this.told(this.run(small / "runs"), 0)
            command, *options = READERS[this.index - 2]
            own = ("save" in " ".join(options)) or command == "export"
            arguments = (command, options[0], run, *options[1:]) if command == "runs" else (command, run, *options)
            this.told(this.visitlab(*arguments), 0, *(() if own else (4,)), names="[Rr]ead-only|damaged")
        enlarge(small, "rw")
        this.resumed(small / "runs")


@fault("open-files", "a process may have so many files open only (RLIMIT_NOFILE)", 8, 0, ["linux"])
def open_files(this: Try) -> None:
    out = this.folder / "runs"
    most = this.random.randrange(8, 40)
    done = this.run(out, "--workers", this.random.choice([1, 2]), limits=[(resource.RLIMIT_NOFILE, most)])
    this.count = int(done.code != 0)
    this.told(done, 0, 4, names="open files")
    this.resumed(out)


@fault("locks", "a file system that refuses locks: said once, and the run goes on", 6, 1, ["compiler"])
def locks(this: Try) -> None:
    out = this.folder / "runs"
    numbers = (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL, errno.EACCES, errno.EIO)
    env = {"LD_PRELOAD": this.bench.surroundings, "FAULTS_LOCKS": str(numbers[this.index % len(numbers)])}
    done = this.run(out, "--workers", this.random.choice([1, 2]), env=env)
    if this.told(done, 0):
        lines = [line for line in done.stderr.splitlines() if "lock" in line]
        this.wrong += [f"told {len(lines)} times that nothing can be locked"] * (len(lines) != 1)
        this.whole(out)


@fault("clock", "the clock jumps ahead and back, by an hour or ten years, twice a second", 6, 0, ["compiler"])
def clock(this: Try) -> None:
    out = this.folder / "runs"
    env = {"LD_PRELOAD": this.bench.surroundings, "FAULTS_CLOCK": this.random.choice(["3600", "315360000"])}
    first = this.bench.start("run", this.bench.config, "--out", out, "-q", "--workers", 1, cwd=this.folder, env=env)
    done = this.run(out, "--workers", this.random.choice([1, 2]), env=env)
    this.told(done, 0)
    this.told(this.bench.wait(first), 0)
    if this.told(this.visitlab("runs", "list", "--out", out, env=env), 0):
        this.whole(out)


def cache_folder(this: Try) -> Path:
    """The folder of compiled code that this program uses, filled."""
    code = "from visitlab_cli.compiled import cache_folder; print(cache_folder())"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=this.folder)
    return Path(found.stdout.strip())


def cut(data: bytes, this: Try) -> bytes:
    return data[: this.random.randrange(len(data))]


def flipped(data: bytes, this: Try) -> bytes:
    changed = bytearray(data)
    changed[this.random.randrange(len(changed))] ^= 1 << this.random.randrange(8)
    return bytes(changed)


CACHE_DAMAGE = {
    "cut": cut,
    "noise": lambda data, this: this.random.randbytes(len(data)),
    "empty": lambda data, this: b"",
}


@fault("cache-damaged", "files of the compiled code are cut, emptied or noise", 6, 0)
def cache_damaged(this: Try) -> None:
    cache, out = this.folder / "cache", this.folder / "runs"
    shutil.copytree(cache_folder(this), cache / cache_folder(this).name)
    (cache / cache_folder(this).name).chmod(0o700)
    damage = list(CACHE_DAMAGE.values())[this.index % len(CACHE_DAMAGE)]
    files = [file for file in sorted(cache.rglob("*.nb[ic]")) if file.is_file()]
    for file in this.random.sample(files, this.random.randrange(1, len(files) + 1)):
        this.edit(file, lambda data: damage(data, this))
    env = {"VISITLAB_CACHE": str(cache)}
    if this.told(this.run(out, "--workers", this.random.choice([1, 2]), env=env), 0):
        this.whole(out)


@fault("cache-full", "the folder of compiled code has no inodes, or is full, while it is written", 4, 0, ["mount"])
def cache_full(this: Try) -> None:
    room = (
        f"size=100m,nr_inodes={this.random.randrange(4, 40)}"
        if this.index % 2
        else f"size={this.random.randrange(65, 68)}m"
    )
    with mounted(this.folder / "small", room) as small:
        env = {"VISITLAB_CACHE": str(small)}
        out = this.folder / "runs"
        if this.index % 2:
            this.told(this.visitlab("optimum", env=env), 0)
        if this.told(this.run(out, env=env), 0):
            this.whole(out)


@fault("cache-foreign", "the folder of compiled code is another's, others may write it, or it is none", 4)
def cache_foreign(this: Try) -> None:
    cache, out = this.folder / "cache", this.folder / "runs"
    marker = this.folder / "pickle-was-run"
    kind = this.index % 4
    if kind == 0:
        cache.touch()
    elif kind == 1:
        cache.symlink_to("/dev/full")
    else:
        folder = cache / cache_folder(this).name
        shutil.copytree(cache_folder(this), folder)
        hostile = b"cposix\nsystem\n(S'touch " + str(marker).encode() + b"'\ntR."
        for file in folder.rglob("*.nbi"):
            version = file.read_bytes().split(b".", 1)[0]
            file.write_bytes(version + hostile if version.startswith(b"\x80") else hostile)
        if kind == 2 and os.getuid() == 0:
            os.chown(folder, 12345, 12345)
        else:
            folder.chmod(0o777)
    if this.told(this.run(out, env={"VISITLAB_CACHE": str(cache)}), 0):
        this.whole(out)
    this.wrong += ["a pickle of another's cache was run"] * marker.exists()


@fault("unreadable", "a file of a run can't be read (a broken disk gives EIO; here a folder lies in its place)", 6, 0)
def unreadable(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    names = ["steps.mcap", "model.npz", "trials.parquet", "cell.json", "timing.json", "versions.json", "config.yaml"]
    name = names[this.index % len(names)]
    file = run / name if (run / name).exists() else run / "social/mb/fast/seed-0000" / name
    file.unlink()
    file.mkdir()
    for command in (("runs", "show", run), ("runs", "verify", run), ("export", run, "--csv"), ("report", run)):
        this.told(this.visitlab(*command), 0, 4, 5)
    this.told(this.run(out), 0, 4)
