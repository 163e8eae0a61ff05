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
# Longest wait for a page or for the end of Chromium, s.
TIMEOUT_S = 20


def chromium():
    """Returns the path of Chromium, or None."""
    return next(filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome"])), None)


class Browser:
    """A separate Chromium process with a temporary profile."""

    def __enter__(self):
        for retries_left in (2, 1, 0):
            self.start()
            try:
                self.call("Browser.getVersion")
                return self
            except (OSError, RuntimeError):
                # Chromium sometimes exits right after its start.
                self.__exit__()
                if not retries_left:
                    raise

    def start(self):
        """Starts Chromium with a new profile."""
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_child, self.commands = os.pipe()
        self.responses, from_child = os.pipe()

        def connect_pipes():
            # Chromium reads from descriptor 3 and writes to 4. Duplicated first: the originals may be 3 or 4.
            a, b = os.dup(to_child), os.dup(from_child)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.process = subprocess.Popen(
            [chromium(), *FLAGS, f"--user-data-dir={self.profile.name}", "about:blank"],
            preexec_fn=connect_pipes, close_fds=False, stderr=subprocess.DEVNULL)
        os.close(to_child)
        os.close(from_child)
        self.last_id, self.buffer, self.listeners = 0, b"", {}

    def __exit__(self, *_):
        try:
            self.call("Browser.close")
            self.process.wait(TIMEOUT_S)
        except (OSError, RuntimeError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.commands)
        os.close(self.responses)
        self.profile.cleanup()

    def call(self, method, session=None, **params):
        """Sends a command and returns its result; passes events received meanwhile to their page.

        Raises RuntimeError if the command fails or Chromium has exited.
        """
        self.last_id += 1
        message = {"id": self.last_id, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        os.write(self.commands, json.dumps(message).encode() + b"\0")
        while True:
            reply = self.read()
            if reply.get("id") == self.last_id:
                if "error" in reply:
                    raise RuntimeError(f"{method}: {reply['error']['message']}")
                return reply["result"]
            if reply.get("sessionId") in self.listeners:
                self.listeners[reply["sessionId"]](reply["method"], reply["params"])

    def read(self):
        """Reads one message: a response or an event."""
        while b"\0" not in self.buffer:
            more = os.read(self.responses, 1 << 20)
            if not more:
                raise RuntimeError("Chromium has exited")
            self.buffer += more
        line, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(line)

    def open(self, file, width=1280, height=900, dark=False):
        """Opens a file in a new tab; width and height of the viewport in px."""
        return Page(self, Path(file), width, height, dark)


class Page:
    """One file in a separate tab."""

    def __init__(self, browser, file, width, height, dark):
        self.browser, self.problems = browser, []
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.target = target
        self.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.url = file.resolve().as_uri()
        browser.listeners[self.session] = self.on_event
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                  mobile=width < 600)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])
        self.call("Page.navigate", url=self.url)
        self.wait("document.readyState === 'complete' && location.href !== 'about:blank'")
        self.wait_for_drawing()

    def call(self, method, **params):
        return self.browser.call(method, self.session, **params)

    def on_event(self, method, params):
        """Records console messages, exceptions, requests and dialogs in `problems`."""
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
        """Returns the value of a JavaScript expression; awaits promises."""
        reply = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in reply:
            raise RuntimeError(f"{expression}: {reply['exceptionDetails']}")
        return reply["result"].get("value")

    def wait(self, expression):
        """Waits until a JavaScript expression is true; raises RuntimeError after TIMEOUT_S."""
        end = time.monotonic() + TIMEOUT_S
        while not self.js(f"Boolean({expression})"):
            if time.monotonic() > end:
                raise RuntimeError(f"not true within {TIMEOUT_S} s: {expression}")
            time.sleep(0.05)

    def wait_for_drawing(self):
        """Waits until pending drawing is finished."""
        self.js("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def centre_of(self, selector):
        """Scrolls an element into view and returns its centre [x, y], px."""
        return self.js(f"""(() => {{ const e = document.querySelector({json.dumps(selector)});
            e.scrollIntoView({{block: "center", behavior: "instant"}});
            const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()""")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def hover(self, selector):
        x, y = self.centre_of(selector)
        self.mouse("mouseMoved", x, y)
        self.wait_for_drawing()

    def click(self, selector):
        x, y = self.centre_of(selector)
        self.mouse("mouseMoved", x, y)
        for kind in ["mousePressed", "mouseReleased"]:
            self.mouse(kind, x, y, button="left", clickCount=1)
        self.wait_for_drawing()

    def key(self, name, code=0):
        for kind in ["rawKeyDown", "keyUp"]:
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code)
        self.wait_for_drawing()

    def picture(self, file, whole=False, clip=None, scale=1):
        """Writes a PNG of the viewport, of the whole page, or of the rectangle `clip` [x, y, width, height], px."""
        if whole:
            clip = [0, 0, *self.js("[innerWidth, document.documentElement.scrollHeight]")]
        more = {}
        if clip:
            more = {"clip": dict(zip(["x", "y", "width", "height"], clip), scale=scale), "captureBeyondViewport": True}
        Path(file).write_bytes(base64.b64decode(self.call("Page.captureScreenshot", **more)["data"]))

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)
