"""The system's chromium, driven by playwright: where it is, and how it starts."""

import contextlib
import shutil

import pytest
from playwright.sync_api import sync_playwright

BROWSER = shutil.which("chromium")
OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
needs_browser = pytest.mark.skipif(BROWSER is None, reason="no chromium; on Debian install chromium")


@contextlib.contextmanager
def opened():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER, args=OPTIONS)
        try:
            yield browser
        finally:
            browser.close()
