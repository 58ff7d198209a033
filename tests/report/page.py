"""A report in a headless chromium: real clicks and keys, what the page then shows, and what it complained of."""

import base64
import json
import time

KEYS = {" ": ("Space", 32), "ArrowRight": ("ArrowRight", 39), "ArrowLeft": ("ArrowLeft", 37), "Tab": ("Tab", 9)}
COMPLAINTS = """
    window.complaints = [];
    addEventListener("error", (event) => complaints.push(event.message));
    addEventListener("unhandledrejection", (event) => complaints.push(String(event.reason)));
    addEventListener("securitypolicyviolation", (event) => complaints.push("policy: " + event.violatedDirective));
"""
WITHIN = 20.0


class Page:
    """A tab that shows a file."""

    def __init__(self, browser, file, width=1200, height=900, dark=False):
        self._browser = browser
        target = browser.ask("Target.createTarget", url="about:blank")["targetId"]
        self._session = browser.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        phone = width < 600
        self._ask("Page.enable")
        self._ask("Page.bringToFront")
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": phone}
        self._ask("Emulation.setDeviceMetricsOverride", **size)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self._ask("Emulation.setEmulatedMedia", features=[scheme])
        self._ask("Page.addScriptToEvaluateOnNewDocument", source=COMPLAINTS)
        self._ask("Page.navigate", url=file.absolute().as_uri())
        self.until("document.readyState === 'complete'")

    def _ask(self, method, **parameters):
        return self._browser.ask(method, self._session, **parameters)

    def value(self, script):
        """What an expression is, waiting for it where it is a promise."""
        told = self._ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in told, told
        return told["result"].get("value")

    def until(self, script):
        end = time.monotonic() + WITHIN
        while not self.value(f"!!({script})"):
            assert time.monotonic() < end, f"never came: {script}"
            time.sleep(0.05)

    def text(self, selector):
        return self.value(f"document.querySelector({json.dumps(selector)}).textContent")

    def count(self, selector):
        return self.value(f"document.querySelectorAll({json.dumps(selector)}).length")

    def _place(self, selector, share):
        """Where on the screen an element is, `share` of its width from its left, scrolled into view."""
        box = self.value(
            f"(() => {{ const node = document.querySelector({json.dumps(selector)});"
            "document.documentElement.style.scrollBehavior = 'auto'; node.scrollIntoView({block: 'center'});"
            "const box = node.getBoundingClientRect(); return [box.x, box.y, box.width, box.height]; })()"
        )
        return {"x": box[0] + box[2] * share, "y": box[1] + box[3] / 2}

    def hover(self, selector, share=0.5):
        self._ask("Input.dispatchMouseEvent", type="mouseMoved", **self._place(selector, share))

    def click(self, selector, share=0.5, shift=False):
        place = self._place(selector, share)
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            button = {"button": "none" if kind == "mouseMoved" else "left", "clickCount": 1, "modifiers": 8 * shift}
            self._ask("Input.dispatchMouseEvent", type=kind, **place, **button)

    def press(self, key, times=1):
        code, number = KEYS[key]
        facts = {"key": key, "code": code, "windowsVirtualKeyCode": number}
        for _ in range(times):
            self._ask("Input.dispatchKeyEvent", type="keyDown", **facts, **({"text": " "} if key == " " else {}))
            self._ask("Input.dispatchKeyEvent", type="keyUp", **facts)

    def picture(self, target, whole=True):
        shot = self._ask("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        target.write_bytes(base64.b64decode(shot["data"]))

    def complaints(self):
        return self.value("window.complaints")
