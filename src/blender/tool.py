"""The crease tool as a process in the background."""

import json
import os
import queue
import shutil
import signal
import subprocess
import sys
import threading

import bpy


class ToolError(Exception):
    """The tool cannot be started, or it failed; the text is what it said."""


def command():
    """The words that start the tool: of the preferences, of the search path, or the package in this Python."""
    addon = bpy.context.preferences.addons.get(__package__)
    chosen = addon.preferences.command if addon and addon.preferences else ""
    if chosen:
        return [bpy.path.abspath(chosen)]
    found = os.environ.get("CREASE_COMMAND") or shutil.which("crease")
    if found:
        return [found]
    try:
        import crease  # noqa: F401  the module of the package crease-bake
    except ImportError:
        raise ToolError("The crease tool is not installed: pip install crease-bake, or set its path in the preferences") from None
    return [sys.executable, "-m", "crease"]


class Process:
    """A running command; `poll` reads its progress."""

    def __init__(self, arguments):
        try:
            self.process = subprocess.Popen([*command(), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                            text=True, encoding="utf-8", errors="replace")
        except OSError as error:
            raise ToolError(f"The crease tool cannot be started: {error}") from error
        self.fraction = 0.0
        self.stage = "read"
        self.messages = []
        self.report = ""
        self.lines = queue.Queue()
        self.threads = [threading.Thread(target=self._read_progress, daemon=True),
                        threading.Thread(target=self._read_report, daemon=True)]
        for thread in self.threads:
            thread.start()

    def _read_progress(self):
        for line in self.process.stderr:
            self.lines.put(line.strip())

    def _read_report(self):
        self.report = self.process.stdout.read()

    def poll(self):
        """Takes in what the tool wrote; true once it has ended."""
        ended = self.process.poll() is not None
        if ended:
            for thread in self.threads:
                thread.join()
        while not self.lines.empty():
            self._take(self.lines.get())
        return ended

    def _take(self, line):
        try:
            news = json.loads(line)
        except ValueError:
            if line:
                self.messages.append(line)
            return
        self.stage = news.get("stage", self.stage)
        if news.get("total_s"):
            self.fraction = min(news["simulated_s"] / news["total_s"], 1.0)

    def cancel(self):
        """Ends the tool; it leaves no half-written files."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT if os.name == "posix" else signal.SIGTERM)
            try:
                self.process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()

    def check(self):
        """Raises what the tool reported. Exit code 3 means a result that did not converge: it is kept, with its warning."""
        if self.process.returncode not in (0, 3):
            raise ToolError("\n".join(self.messages[-6:]) or f"The crease tool ended with code {self.process.returncode}")
