"""A headless Chromium that opens a page of the report and tells what goes on in it."""

import json
import os
import tempfile
import time
import unittest

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

LIMIT = 300.0


def executable(*names):
    for name in names:
        for folder in os.environ.get("PATH", os.defpath).split(os.pathsep):
            path = os.path.join(folder, name)
            if os.access(path, os.X_OK):
                return path
    return None


def may_lack_chromium(os_release):
    """Whether a system of this /etc/os-release has no Chromium to install: Ubuntu 20.04 has it as a snap only."""
    fields = dict(line.split("=", 1) for line in os_release.splitlines() if "=" in line)
    return (fields.get("ID", "").strip("\"'"), fields.get("VERSION_ID", "").strip("\"'")) == ("ubuntu", "20.04")


def require_chromium():
    """Skips the test where there can be no Chromium, and fails it where there is none though there could be one."""
    if executable("chromium", "chromium-browser", "google-chrome") and executable("chromedriver"):
        return
    with open("/etc/os-release", encoding="utf-8") as file:
        if may_lack_chromium(file.read()):
            raise unittest.SkipTest("there is no Chromium")
    raise AssertionError("there is no Chromium, or no chromedriver; install what scripts/dependencies names")


class Browser:
    """Chromium with a profile and a folder for downloads of its own, both gone at close()."""

    def __init__(self, width=1366, height=768):
        self.folder = tempfile.TemporaryDirectory()
        self.downloads = os.path.join(self.folder.name, "downloads")
        os.mkdir(self.downloads)
        options = webdriver.ChromeOptions()
        options.binary_location = executable("chromium", "chromium-browser", "google-chrome")
        for argument in (
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            "--no-first-run",
            "--window-size=%d,%d" % (width, height),
            "--user-data-dir=" + os.path.join(self.folder.name, "profile"),
        ):
            options.add_argument(argument)
        preferences = {
            "download.default_directory": self.downloads,
            "download.prompt_for_download": False,
            # A second download without a hand on the mouse would be asked about.
            "profile.default_content_setting_values.automatic_downloads": 1,
        }
        options.add_experimental_option("prefs", preferences)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        service = Service(executable("chromedriver"), log_path=os.devnull)
        self.driver = webdriver.Chrome(service=service, options=options)
        self.driver.set_script_timeout(LIMIT)
        self.driver.set_page_load_timeout(LIMIT)

    def close(self):
        self.driver.quit()
        self.folder.cleanup()

    def open(self, path):
        # What the browser's own first page asks for is not the page's doing.
        self.driver.get("about:blank")
        self.complaints()
        self.driver.get("file://" + os.path.abspath(path))

    def run(self, script, *arguments):
        """The value of an expression of JavaScript, awaited; its arguments are `given[0]`, ..."""
        return self.driver.execute_async_script(
            "const done = arguments[arguments.length - 1], given = arguments;(async () => ("
            + script
            + "))().then((value) => done({value}), (error) => done({error: String(error.stack || error)}));",
            *arguments,
        )

    def value(self, script, *arguments):
        answer = self.run(script, *arguments)
        if "error" in answer:
            raise AssertionError(answer["error"])
        return answer.get("value")

    def complaints(self):
        """What the console has said, and every request but that for the page itself."""
        said = [entry["message"] for entry in self.driver.get_log("browser")]
        asked = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                url = message["params"]["request"]["url"]
                page = url.startswith("file://") and message["params"].get("type") == "Document"
                if not page and not url.startswith(("data:", "blob:")):
                    asked.append(url[:200])
        return said, asked

    def wait(self, condition, what):
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            found = condition()
            if found:
                return found
            time.sleep(0.05)
        raise AssertionError("waited in vain for " + what)

    def downloaded(self, name):
        """The bytes of a file when it is there as a whole."""
        path = os.path.join(self.downloads, name)
        try:
            self.wait(lambda: os.path.exists(path) and not os.path.exists(path + ".crdownload"), "download " + name)
        except AssertionError as error:
            raise AssertionError(
                "%s; there are %s; the console says %s" % (error, os.listdir(self.downloads), self.complaints()[0])
            )
        with open(path, "rb") as file:
            return file.read()
