"""Controls Chromium through a pipe (the DevTools protocol) with the Python standard library only.
Opens single-file pages without a network. Used by `check_pages.py` and `pictures.py`.

Console messages, exceptions and external requests of a page are collected in `problems`.
"""
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

FLAGS = """--headless --no-sandbox --disable-quic --no-first-run --disable-background-networking
 --disable-component-update --disable-sync --disable-default-apps --hide-scrollbars --mute-audio
 --use-angle=swiftshader --enable-unsafe-swiftshader --remote-debugging-pipe""".split()
PATIENCE_S = 20


def chromium():
    """Returns the path of Chromium, or None."""
    return next(filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome"])), None)


class Browser:
    """A separate Chromium process with a temporary profile."""

    def __enter__(self):
        for left in (2, 1, 0):
            self.start()
            try:
                self.call("Browser.getVersion")
                return self
            except (OSError, RuntimeError):
                # Chromium sometimes ends as soon as it has begun.
                self.__exit__()
                if not left:
                    raise

    def start(self):
        """Starts Chromium with a new profile."""
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_child, self.out = os.pipe()
        self.inn, from_child = os.pipe()

        def three_and_four():
            # Moved away from 3 and 4 first, which may be among them.
            a, b = os.dup(to_child), os.dup(from_child)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.process = subprocess.Popen(
            [chromium(), *FLAGS, f"--user-data-dir={self.profile.name}", "about:blank"],
            preexec_fn=three_and_four, close_fds=False, stderr=subprocess.DEVNULL)
        os.close(to_child)
        os.close(from_child)
        self.number, self.rest, self.listeners = 0, b"", {}

    def __exit__(self, *_):
        try:
            self.call("Browser.close")
            self.process.wait(PATIENCE_S)
        except (OSError, RuntimeError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.out)
        os.close(self.inn)
        self.profile.cleanup()

    def call(self, method, session=None, **params):
        """Returns the response to a command; events before it are passed to their page."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            found = self.read()
            if found.get("id") == self.number:
                if "error" in found:
                    raise RuntimeError(f"{method}: {found['error']['message']}")
                return found["result"]
            if found.get("sessionId") in self.listeners:
                self.listeners[found["sessionId"]](found["method"], found["params"])

    def read(self):
        while b"\0" not in self.rest:
            more = os.read(self.inn, 1 << 20)
            if not more:
                raise RuntimeError("Chromium has exited")
            self.rest += more
        line, _, self.rest = self.rest.partition(b"\0")
        return json.loads(line)

    def open(self, file, width=1280, height=900, dark=False):
        return Page(self, Path(file), width, height, dark)


class Page:
    """One file in a separate tab."""

    def __init__(self, browser, file, width, height, dark):
        self.browser, self.problems = browser, []
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.target = target
        self.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.url = file.resolve().as_uri()
        browser.listeners[self.session] = self.heard
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                  mobile=width < 600)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])
        self.call("Page.navigate", url=self.url)
        self.wait("document.readyState === 'complete' && location.href !== 'about:blank'")
        self.rest()

    def call(self, method, **params):
        return self.browser.call(method, self.session, **params)

    def heard(self, method, params):
        if method == "Runtime.consoleAPICalled":
            self.problems.append("console: " + " ".join(str(a.get("value")) for a in params["args"]))
        elif method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.problems.append("error: " + details.get("exception", details).get("description", str(details)))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("warning", "error"):
            self.problems.append("log: " + params["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            url = params["request"]["url"]
            if url.split("#")[0] != self.url and not url.startswith("data:"):
                self.problems.append("request: " + url[:200])
        elif method == "Page.javascriptDialogOpening":
            self.problems.append("dialog: " + params["message"])
            self.call("Page.handleJavaScriptDialog", accept=True)

    def js(self, expression):
        """Returns the value of an expression; awaits promises."""
        found = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in found:
            raise RuntimeError(f"{expression}: {found['exceptionDetails']}")
        return found["result"].get("value")

    def wait(self, expression):
        end = time.monotonic() + PATIENCE_S
        while not self.js(f"Boolean({expression})"):
            if time.monotonic() > end:
                raise RuntimeError(f"not true within {PATIENCE_S} s: {expression}")
            time.sleep(0.05)

    def rest(self):
        """Waits until pending drawing is finished."""
        self.js("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def middle(self, selector):
        """Scrolls an element into view and returns its centre."""
        return self.js(f"""(() => {{ const e = document.querySelector({json.dumps(selector)});
            e.scrollIntoView({{block: "center", behavior: "instant"}});
            const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()""")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def hover(self, selector):
        x, y = self.middle(selector)
        self.mouse("mouseMoved", x, y)
        self.rest()

    def click(self, selector):
        x, y = self.middle(selector)
        self.mouse("mouseMoved", x, y)
        for kind in ["mousePressed", "mouseReleased"]:
            self.mouse(kind, x, y, button="left", clickCount=1)
        self.rest()

    def key(self, name, code=0):
        for kind in ["rawKeyDown", "keyUp"]:
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code)
        self.rest()

    def picture(self, file, whole=False, clip=None, scale=1):
        """Returns a PNG of the viewport, of the whole page, or of a part [x, y, width, height] of it."""
        if whole:
            clip = [0, 0, *self.js("[innerWidth, document.documentElement.scrollHeight]")]
        more = {}
        if clip:
            more = {"clip": dict(zip(["x", "y", "width", "height"], clip), scale=scale), "captureBeyondViewport": True}
        Path(file).write_bytes(base64.b64decode(self.call("Page.captureScreenshot", **more)["data"]))

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)
