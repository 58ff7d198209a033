"""What is made once for all processes of a test session."""

import fcntl
import os
import shutil


def made_once(factory, name, make):
    """The folder `name`, filled by `make(folder)` in the first process that asks for it; not to be changed.

    `factory` is pytest's `tmp_path_factory`; of its folders those of a session's processes lie side by side.
    """
    session = factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        session = session.parent
    folder, whole = session / name, session / f"{name}.whole"
    with (session / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not whole.exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            make(folder)
            whole.touch()
    return folder
