"""A headless chromium that is asked for pictures of a page until one is good; nothing but its debugging pipe."""

import base64
import contextlib
import itertools
import json
import os
import shutil
import subprocess
import time

BROWSER = shutil.which("chromium")
OPTIONS = """
    --headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --ignore-gpu-blocklist
    --disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync
    --window-size=1600,1000 --remote-debugging-pipe
"""
ITS_INPUT, ITS_OUTPUT = 3, 4
END = b"\0"


class Browser:
    """The program, and the two pipes by which it takes commands and answers."""

    def __init__(self, profile):
        orders, self._orders = os.pipe()
        self._answers, answers = os.pipe()

        def place_pipes():
            spare = [os.dup(end) for end in (orders, answers)]  # 3 and 4 may be in use
            for end, place in zip(spare, (ITS_INPUT, ITS_OUTPUT), strict=True):
                os.dup2(end, place)

        command = [BROWSER, *OPTIONS.split(), f"--user-data-dir={profile}", "about:blank"]
        self.process = subprocess.Popen(
            command,
            preexec_fn=place_pipes,
            close_fds=False,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(orders)
        os.close(answers)
        self._numbers = itertools.count(1)
        self._rest = b""

    def ask(self, method, session=None, **parameters):
        number = next(self._numbers)
        order = {"id": number, "method": method, "params": parameters} | ({"sessionId": session} if session else {})
        os.write(self._orders, json.dumps(order).encode() + END)
        while True:
            while END not in self._rest:
                more = os.read(self._answers, 1 << 20)
                assert more, "the browser ended"
                self._rest += more
            answer, _, self._rest = self._rest.partition(END)
            told = json.loads(answer)
            if told.get("id") == number:
                assert "error" not in told, told
                return told["result"]

    def close(self):
        self.process.terminate()
        self.process.wait(20)
        os.close(self._orders)
        os.close(self._answers)


@contextlib.contextmanager
def opened(profile):
    browser = Browser(profile)
    try:
        yield browser
    finally:
        browser.close()


def picture_of(address, target, profile, is_good, within):
    """Write a picture of the page at `address` as soon as `is_good(target)`, at the latest `within` seconds."""
    end = time.monotonic() + within
    with opened(profile) as browser:
        page = browser.ask("Target.createTarget", url=address)["targetId"]
        session = browser.ask("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        while time.monotonic() < end:
            time.sleep(2)
            shot = browser.ask("Page.captureScreenshot", session, format="png")
            target.write_bytes(base64.b64decode(shot["data"]))
            if is_good(target):
                return
