"""Opens a page in a headless Chromium, without a network, and tells what its console said.

Chromium is spoken to through two pipes (`--remote-debugging-pipe`: messages of the DevTools protocol, JSON, each ended
by a zero byte), so nothing but the standard library is needed and no port is opened.
"""

import base64
import contextlib
import fcntl
import json
import os
import pathlib
import select
import shutil
import subprocess
import tempfile
import time

PROGRAMS = ("chromium-headless-shell", "chromium")
# Software rendering, for WebGL on machines without a graphics card; as root Chromium runs only without its sandbox.
OPTIONS = [
    "--headless", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", "--no-first-run",
    "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking",
    "--host-resolver-rules=MAP * ~NOTFOUND", "--remote-debugging-pipe",
]  # fmt: skip
LOCAL = ("file:", "data:", "blob:", "about:")
KEYS = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Enter": 13, "Escape": 27, "Home": 36,
        "End": 35, " ": 32, "Tab": 9, "PageUp": 33, "PageDown": 34}  # fmt: skip


def open_page(path, screenshot=None, **options):
    """Opens the file at `path`, waits until it is drawn, and returns what its console said: lines "level: text",
    network requests that were tried included ("network: address"). A page in order gives an empty list.

    screenshot: where to put a PNG of the whole page; options: as of browsing().
    """
    with browsing(path, **options) as page:
        if screenshot:
            page.screenshot(screenshot)
        return page.messages


@contextlib.contextmanager
def browsing(path, width=1200, height=900, scale=1, phone=False, timeout=240, dark=False, address=""):
    """The file at `path` as an open Page of `width` by `height` CSS pixels; TimeoutError after `timeout` seconds,
    which only a browser that hangs needs. dark: for a reader who prefers dark colours; address: what follows the
    file's, "#..."."""
    program = next((found for found in map(shutil.which, PROGRAMS) if found), None)
    if not program:
        raise FileNotFoundError(f"none of {', '.join(PROGRAMS)} is installed; scripts/setup installs the first")
    # The child's ends must become 3 and 4: all four are moved above them first.
    ours_read, theirs_write = (_moved(end) for end in os.pipe())
    theirs_read, ours_write = (_moved(end) for end in os.pipe())

    def wire():
        os.dup2(theirs_read, 3)
        os.dup2(theirs_write, 4)

    # Chromium's helpers may still write to the profile for a moment after it has ended.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [program, *OPTIONS, f"--user-data-dir={profile}"]
        process = subprocess.Popen(command, close_fds=False, preexec_fn=wire, stderr=subprocess.DEVNULL)
        os.close(theirs_read)
        os.close(theirs_write)
        try:
            page = Page(ours_read, ours_write, time.monotonic() + timeout)
            page._open(pathlib.Path(path).resolve().as_uri() + address, width, height, scale, phone, dark)
            yield page
            page._call("Browser.close", session=False)
        finally:
            process.kill()
            process.wait()
            os.close(ours_read)
            os.close(ours_write)


def _moved(end):
    high = fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10)
    os.close(end)
    return high


class Page:
    """messages: what the console said so far, as open_page returns it."""

    def __init__(self, read, write, end):
        self.messages = []
        self._read, self._write, self._end = read, write, end
        self._number, self._session, self._rest, self._events = 0, None, b"", []

    def evaluate(self, expression):
        """The value of a JavaScript expression (a promise is awaited) as Python's; RuntimeError when it throws."""
        answer = self._call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(_thrown(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def settle(self):
        """Waits until two frames are drawn."""
        self.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done())))")

    def click(self, x, y, button="left"):
        """A click at CSS pixels of the window."""
        self.drag([(x, y)], button)

    def click_on(self, selector):
        """A click at the middle of the first element that a CSS selector finds; it is scrolled into view before."""
        x, y = self.evaluate(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView({{block:"
            " 'center'}); const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()"
        )
        self.click(x, y)

    def drag(self, points, button="left"):
        """Pressed at the first of `points`, moved through the others, released at the last."""
        mouse = {"button": button, "clickCount": 1}
        (x, y), *others = points
        self._call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        self._call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, **mouse)
        for x, y in others:
            held = {"left": 1, "right": 2, "middle": 4}[button]
            self._call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, button=button, buttons=held)
        self._call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, **mouse)
        self.settle()

    def wheel(self, x, y, down):
        """Turns the wheel at (x, y); `down` in CSS pixels, negative upwards."""
        self._call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=down)
        self.settle()

    def press(self, key):
        """A key by its name in JavaScript's KeyboardEvent.key: "a", "ArrowRight", "Enter", ..."""
        code = KEYS.get(key, ord(key.upper()) if len(key) == 1 else 0)
        text = {"text": key} if len(key) == 1 else {"text": "\r"} if key == "Enter" else {}
        common = {"key": key, "windowsVirtualKeyCode": code, "code": key if len(key) > 1 else f"Key{key.upper()}"}
        self._call("Input.dispatchKeyEvent", type="keyDown", **common, **text)
        self._call("Input.dispatchKeyEvent", type="keyUp", **common)
        self.settle()

    def prefer(self, scheme):
        """Colours that the reader prefers: "light" or "dark"."""
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self._call("Emulation.setEmulatedMedia", features=features)

    def screenshot(self, path, whole=True):
        """A PNG of the whole page, or of what the window shows."""
        shot = self._call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        pathlib.Path(path).write_bytes(base64.b64decode(shot["data"]))

    def pdf(self, path):
        """The page as it is printed, on A4."""
        options = {"paperWidth": 8.27, "paperHeight": 11.69, "printBackground": False}
        pathlib.Path(path).write_bytes(base64.b64decode(self._call("Page.printToPDF", **options)["data"]))

    def _open(self, address, width, height, scale, phone, dark):
        target = self._call("Target.createTarget", session=False, url="about:blank")["targetId"]
        attached = self._call("Target.attachToTarget", session=False, targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._call(f"{domain}.enable")
        size = {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": phone}
        self._call("Emulation.setDeviceMetricsOverride", **size)
        self.prefer("dark" if dark else "light")
        failed = self._call("Page.navigate", url=address).get("errorText")
        if failed:
            raise OSError(f"{address}: {failed}")
        while "Page.loadEventFired" not in self._events:
            self._take(self._receive())
        self.settle()

    def _call(self, method, session=True, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._write, data) :]
        while True:
            answer = self._receive()
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self._take(answer)

    def _receive(self):
        while b"\0" not in self._rest:
            if not select.select([self._read], [], [], max(0, self._end - time.monotonic()))[0]:
                raise TimeoutError("Chromium did not answer in time")
            data = os.read(self._read, 1 << 20)
            if not data:
                raise ConnectionError("Chromium ended")
            self._rest += data
        message, _, self._rest = self._rest.partition(b"\0")
        return json.loads(message)

    def _take(self, event):
        method, values = event.get("method"), event.get("params", {})
        self._events.append(method)
        if method == "Runtime.consoleAPICalled":
            words = [str(word.get("value", word.get("description", ""))) for word in values["args"]]
            self.messages.append(f"{values['type']}: {' '.join(words)}")
        elif method == "Runtime.exceptionThrown":
            self.messages.append(f"error: {_thrown(values['exceptionDetails'])}")
        elif method == "Log.entryAdded":
            self.messages.append(f"{values['entry']['level']}: {values['entry']['text']}")
        elif method == "Network.requestWillBeSent" and not values["request"]["url"].startswith(LOCAL):
            self.messages.append(f"network: {values['request']['url']}")


def _thrown(details):
    return details.get("exception", {}).get("description") or details["text"]
