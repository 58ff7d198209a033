"""A picture of one step as the viewer shows it, taken without a screen by Mesa's software Vulkan."""

import os
import tempfile
import time
from pathlib import Path

from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.origin import marked_png
from visitlab_cli.replay.program import LOOPBACK, answers, free_port, started
from visitlab_cli.replay.recording import record
from visitlab_cli.replay.stage import TIMELINE
from visitlab_cli.replay.viewer import recording_file, wait_until
from visitlab_cli.scene.trial import Trial
from visitlab_cli.whole_file import write_again

WIDTH, HEIGHT = 1600, 1000
DRIVER_VARIABLE = "VK_DRIVER_FILES"
DRIVER_FOLDERS = (Path("/usr/share/vulkan/icd.d"), Path("/etc/vulkan/icd.d"), Path("/usr/local/share/vulkan/icd.d"))
DRAWING = ("GALLIUM_", "LP_", "MESA_", "VK_", "WGPU_")
"""How the names of variables begin that could change the picture."""
SETTLES = 1.0
"""Seconds that the viewer is given to lay out and to draw a step."""
NO_DRIVER = "a picture needs a Vulkan driver; on Debian install mesa-vulkan-drivers"


def software_driver() -> Path | None:
    """Mesa's driver that needs no graphics card, if it is installed."""
    return next((file for folder in DRIVER_FOLDERS for file in sorted(folder.glob("lvp_icd*.json"))), None)


def save_picture(trial: Trial, step: int, target: Path) -> None:
    """Write the viewer's picture of a step as a PNG of `WIDTH` x `HEIGHT`.

    Raises:
        UsageError: the trial has no such step, the target is no .png, or what is there is not visitlab's.
        RunError: there is no driver, the viewer failed, or the target cannot be written.
    """
    if not 0 <= step <= trial.last_step:
        raise UsageError(f"--step {step}: the trial has steps 0 to {trial.last_step}")
    if target.suffix.lower() != ".png":
        raise UsageError(f"--png {target}: must end in .png")
    driver = software_driver()
    if driver is None and DRIVER_VARIABLE not in os.environ:
        raise RunError(NO_DRIVER)
    variables = {"RUST_LOG": "error", DRIVER_VARIABLE: os.environ.get(DRIVER_VARIABLE) or str(driver)}
    port = free_port()
    options = "--headless", "--hide-welcome-screen", "--window-size", f"{WIDTH}x{HEIGHT}", "--port", str(port)
    with (
        recording_file(record(trial)) as recording,
        tempfile.TemporaryDirectory(prefix="visitlab-") as folder,
        started(*options, environment={"XDG_RUNTIME_DIR": folder, **variables}, without=DRAWING) as viewer,
    ):
        wait_until(lambda: answers(port) or viewer.poll() is not None, "the viewer did not start")
        picture = Path(folder) / "picture.png"
        try:
            _take(port, recording, step, picture)
        except RunError:
            raise  # it was too slow, and says so
        except Exception as error:  # whatever the experimental client raises
            line = "".join(str(error).strip().splitlines()[:1]) or type(error).__name__
            why = NO_DRIVER if viewer.poll() is not None else "it runs, but is too slow or busy; try again"
            raise RunError(f"the viewer drew no picture: {line}; {why}") from error
        write_again(target, marked_png(picture.read_bytes()))


def _take(port: int, recording: Path, step: int, picture: Path) -> None:
    from rerun.experimental import ViewerClient

    viewer = ViewerClient.connect(f"rerun+http://{LOOPBACK}:{port}/proxy")
    viewer.open(str(recording))
    wait_until(lambda: not viewer.get_state().loading, "the viewer did not load the trial")
    time.sleep(SETTLES)
    viewer.set_time(TIMELINE, sequence=step, play_state="paused")
    time.sleep(SETTLES)
    viewer.save_screenshot(str(picture))
