"""The real program without its imports, which are most of a short call: a fork of a process that has made them.

The fork has the folder, the variables, the streams and the arguments of the call, and ends as the program ends; the
processes that it starts are new ones. What a call finds imported is all that the program ever imports, so whatever is
about imports or about what libraries read as they are imported is tried with a process of its own: a call goes to one
by itself if its variables are others than those here, except for `READ_LATE`.
"""

import atexit
import gc
import json
import os
import selectors
import socket
import subprocess
import sys
from functools import cache
from pathlib import Path

READ_LATE = {"PATH", "VISITLAB_CACHE", "DISPLAY", "WAYLAND_DISPLAY", "PYTEST_CURRENT_TEST"}
"""Variables that no import looks at."""
PATH = "PYTHONPATH"
FIRST, REST = 1 << 16, 1 << 20
"""Bytes that are read of a call at a time: with its streams, and after."""
LONGEST = 1800
"""Seconds that a program may say nothing."""
NOT_IMPORTED = {"__main__", "gym", "replay"}
"""Rooms that lead to Rerun, or are no part of the program."""
HERE = Path(__file__).resolve().parents[1]


@cache
def _server():
    """The connection to the process that forks, and the variables that it has; one for each process of a session."""
    ours, theirs = socket.socketpair()
    variables = os.environ | {"NO_COLOR": "1", "COLUMNS": "200"}
    command = [sys.executable, "-m", "tests.forked", str(theirs.fileno())]
    process = subprocess.Popen(command, cwd=HERE, env=variables, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL)
    theirs.close()
    atexit.register(process.wait)
    atexit.register(ours.close)
    return ours, variables


def can_fork(environment):
    """Whether a call with these variables is the same in a fork; only on Linux do all libraries bear one."""
    if sys.platform != "linux":
        return False
    _, variables = _server()
    different = {name for name, _ in environment.items() ^ variables.items()} - READ_LATE
    return different <= {PATH} and all(any(Path(place).glob("*.dist-info")) for place in _added(environment))


def _added(environment):
    """Folders on Python's path; that of a package that is installed for a test takes the place of nothing of ours."""
    return environment.get(PATH, "").split(os.pathsep) if environment.get(PATH) != os.environ.get(PATH) else []


def run_forked(words, cwd, environment):
    """Run the program to its end, in a fork; see `tests.program.visitlab`."""
    server, _ = _server()
    (out, to_out), (err, to_err) = os.pipe(), os.pipe()
    path = [os.fspath(cwd or os.getcwd()), *_added(environment)]
    call = {"words": words, "path": path, "variables": environment}
    content = json.dumps(call).encode() + b"\n"
    sent = socket.send_fds(server, [content], [to_out, to_err])
    server.sendall(content[sent:])
    os.close(to_out)
    os.close(to_err)
    stdout, stderr = _read_all(out, err)
    code = int(server.makefile("rb", buffering=0).readline())
    return subprocess.CompletedProcess(words, code, stdout, stderr)


def _read_all(*pipes):
    """The texts of pipes, each to its end, which are closed."""
    found = dict.fromkeys(pipes, b"")
    with selectors.DefaultSelector() as waiting:
        for pipe in pipes:
            waiting.register(pipe, selectors.EVENT_READ)
        while waiting.get_map():
            for key, _ in waiting.select(LONGEST) or _too_long():
                if part := os.read(key.fd, REST):
                    found[key.fd] += part
                else:
                    waiting.unregister(key.fd)
                    os.close(key.fd)
    return [content.decode().replace("\r\n", "\n") for content in found.values()]


def _too_long():
    raise TimeoutError(f"the program said nothing for {LONGEST} s")


def _import_all():
    """What the program imports, but for what leads to Rerun, whose threads would not be there in a fork."""
    import importlib

    from visitlab_cli.same_pictures import same_pictures
    from visitlab_cli.sources import PACKAGE

    for file in sorted(PACKAGE.rglob("*.py")):
        room, *_ = parts = file.relative_to(PACKAGE).with_suffix("").parts
        if room not in NOT_IMPORTED:
            importlib.import_module(".".join((PACKAGE.name, *parts)).removesuffix(".__init__"))
    with same_pictures({}):
        importlib.import_module("matplotlib.figure")
        importlib.import_module("matplotlib.backends.backend_svg")
    assert "rerun" not in sys.modules, "a room that imports it belongs into NOT_IMPORTED"


def _serve(connection):
    """Fork for each call; return in the fork."""
    while True:
        content, streams, _, _ = socket.recv_fds(connection, FIRST, 2)
        while content and not content.endswith(b"\n"):
            content += connection.recv(REST)
        if not content:
            os._exit(0)
        child = os.fork()
        if not child:
            connection.close()
            _become(json.loads(content), streams)
            return
        for stream in streams:
            os.close(stream)
        _, status = os.waitpid(child, 0)
        connection.sendall(b"%d\n" % os.waitstatus_to_exitcode(status))


def _become(call, streams):
    for number, stream in enumerate(streams, 1):
        os.dup2(stream, number)
        os.close(stream)
    sys.stdout = sys.__stdout__ = _pipe(1, sys.stdout.encoding, -1, "strict")
    sys.stderr = sys.__stderr__ = _pipe(2, sys.stderr.encoding, 1, "backslashreplace")
    os.chdir(call["path"][0])
    os.environ.clear()
    os.environ.update(call["variables"])
    sys.argv = [sys.argv[0], *call["words"]]
    sys.path[:1] = call["path"]


def _pipe(number, encoding, buffering, errors):
    """A stream as Python opens it where it finds a pipe."""
    return open(number, "w", buffering, encoding, errors, closefd=False)


if __name__ == "__main__":
    from visitlab_cli.__main__ import main
    from visitlab_cli.surroundings import shut_out

    shut_out()
    _import_all()
    gc.freeze()  # a fork that looks for garbage need not copy all that was imported
    _serve(socket.socket(fileno=int(sys.argv[1])))
    main()
