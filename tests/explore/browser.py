"""Headless Chromium over a pipe, with the DevTools protocol and nothing installed beside it."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
#: No graphics processor is asked for: a software one draws the same picture.
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--no-first-run",
    "--disable-background-networking",
    "--remote-debugging-pipe",
)


class Page:
    """One page of a browser.

    Attributes:
        problems: What the console called an error, exceptions, and what the policy refused.
        asked: Addresses that were asked for.
    """

    def __init__(self, send, receive):
        self._send, self._receive, self._count = send, receive, 0
        self._session = None
        self.problems, self.asked = [], []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        """A command of the protocol; events before its answer are noted."""
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        self._send(json.dumps(message))
        while True:
            answer = json.loads(self._receive())
            if answer.get("id") == self._count:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self._note(answer.get("method"), answer.get("params", {}))

    def _note(self, event, given):
        match event:
            case "Runtime.exceptionThrown":
                self.problems.append(json.dumps(given["exceptionDetails"])[:900])
            case "Log.entryAdded" if given["entry"]["level"] in ("error", "warning"):
                self.problems.append(given["entry"]["text"])
            case "Runtime.consoleAPICalled" if given["type"] in ("error", "warning", "assert"):
                self.problems.append(json.dumps(given["args"])[:500])
            case "Network.requestWillBeSent":
                self.asked.append(given["request"]["url"])

    def resize(self, width, height, dark=False, calm=False):
        """The size of the window, and what the person prefers."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 700,
        )
        features = [
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
            {"name": "prefers-reduced-motion", "value": "reduce" if calm else "no-preference"},
        ]
        self.call("Emulation.setEmulatedMedia", features=features)

    def open(self, path):
        """Load a file, and wait until its script has run."""
        self.call("Page.navigate", url=Path(path).as_uri())
        self.wait("document.readyState === 'complete'")

    def run(self, script):
        """The value of an expression in the page."""
        found = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in found:
            raise RuntimeError(json.dumps(found["exceptionDetails"])[:900])
        return found["result"].get("value")

    def wait(self, script, seconds=60):
        """Wait until an expression is true."""
        until = time.monotonic() + seconds
        while not self.run(script):
            if time.monotonic() > until:
                raise TimeoutError(script)
            time.sleep(0.05)

    def shoot(self):
        """The picture of the window, as PNG."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def mouse(self, kind, x, y, pressed=True):
        """One event of the mouse: ``mousePressed``, ``mouseMoved`` or ``mouseReleased``."""
        button = {"button": "left", "buttons": 1, "clickCount": 1} if pressed else {}
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **button)

    def drag(self, start, end):
        """Press, move and release."""
        self.mouse("mousePressed", *start)
        for part in (0.3, 0.6, 1.0):
            at = [a + part * (b - a) for a, b in zip(start, end, strict=True)]
            self.mouse("mouseMoved", *at)
        self.mouse("mouseReleased", *end)

    def key(self, key, code, text=""):
        """A key pressed and released."""
        given = {"key": key, "code": code, "windowsVirtualKeyCode": ord(text) if text else 0}
        self.call("Input.dispatchKeyEvent", type="keyDown", text=text, **given)
        self.call("Input.dispatchKeyEvent", type="keyUp", **given)


@contextmanager
def browser():
    """A page of a browser of its own, which ends with the block."""
    to_read, to_write = os.pipe()
    back_read, back_write = os.pipe()
    # Chromium reads from 3 and writes to 4, whatever these numbers are here.
    command = f'exec 3<&{to_read} 4>&{back_write}; exec "$@"'
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        process = subprocess.Popen(
            ["bash", "-c", command, "-", CHROMIUM, *FLAGS, f"--user-data-dir={profile}"],
            pass_fds=(to_read, back_write),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_read)
        os.close(back_write)
        buffer = bytearray()

        def send(text):
            os.write(to_write, text.encode() + b"\0")

        def receive():
            while b"\0" not in buffer:
                read = os.read(back_read, 1 << 20)
                if not read:
                    raise RuntimeError("the browser ended")
                buffer.extend(read)
            end = buffer.index(0)
            text = bytes(buffer[:end])
            del buffer[: end + 1]
            return text

        try:
            yield Page(send, receive)
        finally:
            process.terminate()
            process.wait(20)
            os.close(to_write)
            os.close(back_read)
