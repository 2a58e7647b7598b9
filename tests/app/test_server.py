"""The server as a process: strangers that hold its connections, a full disk, and another server."""

from __future__ import annotations

import http.client
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from ..guards.damaged import endless_exodus, large_med, large_vtu
from ..scenarios import FAST

SOON = 20.0  # s


@dataclass
class Server:
    """A server in a process of its own, and its one user."""

    process: subprocess.Popen[str]
    address: str
    said: Path  # on stderr
    port: int = 0
    headers: dict[str, str] | None = None

    def enter(self) -> None:
        """Open the address, as a browser does."""
        match = re.fullmatch(r"http://127\.0\.0\.1:(\d+)(/\?token=.*)", self.address)
        assert match is not None, (self.address, self.said.read_text())
        self.port = int(match[1])
        answer = self._answer("GET", match[2], None, {})
        key = answer.headers["location"].removeprefix("/#").split(".")[0]
        cookie = answer.headers["set-cookie"].split(";")[0]
        self.headers = {"cookie": cookie, "x-gbeam-key": key, "origin": f"http://127.0.0.1:{self.port}"}

    def call(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        """Status and answer of a request."""
        assert self.headers is not None
        answer = self._answer(method, path, body, self.headers)
        return answer.status, json.loads(answer.read())

    def put(self, name: str, content: bytes) -> tuple[int, Any]:
        """Status and answer of a file that is dropped."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=SOON)
        connection.request("PUT", f"/api/records/{name}", content, self.headers or {})
        answer = connection.getresponse()
        return answer.status, json.loads(answer.read())

    def _answer(self, method: str, path: str, body: Any, headers: dict[str, str]) -> http.client.HTTPResponse:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=SOON)
        kind = {"content-type": "application/json"} if body is not None else {}
        connection.request(method, path, None if body is None else json.dumps(body), headers | kind)
        return connection.getresponse()

    def submit(self, text: str = FAST) -> str:
        """Queue a run; return its id."""
        status, answer = self.call("POST", "/api/runs", {"text": text})
        assert status == 200, answer
        return str(answer["id"])

    def until(self, number: str, what: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Wait until something is true of a run."""
        begun = time.monotonic()
        while True:
            status, runs = self.call("GET", "/api/runs")
            assert status == 200, runs
            run = next((each for each in runs if each["id"] == number), {"state": "gone"})
            if what(run):
                return dict(run)
            assert time.monotonic() - begun < SOON, (run, self.said.read_text())
            time.sleep(0.05)


Start = Callable[..., Server]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Start servers, with code that is run before; they are ended."""
    pytest.importorskip("fastapi")
    pytest.importorskip("uvicorn")
    servers: list[Server] = []

    def started(folder: Path, before: str = "", *, port: int = 0, enter: bool = True) -> Server:
        said = tmp_path / f"stderr{len(servers)}.txt"
        code = f"{before}\nfrom gbeam.cli import main\nraise SystemExit(main())"
        command = [sys.executable, "-c", code, "app", "--folder", str(folder), "--port", str(port)]
        with said.open("w") as errors:
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True, cwd=tmp_path)
        assert process.stdout is not None
        servers.append(Server(process, process.stdout.readline().strip(), said))
        if enter:
            servers[-1].enter()
        return servers[-1]

    yield started
    for each in servers:
        each.process.kill()
        each.process.wait(SOON)
        assert each.process.stdout is not None
        each.process.stdout.close()


QUICK = """
import sys
from gbeam.app import jobs
jobs.PAUSE = 0.1
jobs._command = lambda state: [sys.executable, "-c", {code!r}]
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits of processes are POSIX's")
def test_strangers_hold_no_connection_and_no_descriptor(start: Start, tmp_path: Path) -> None:
    """Of 160 descriptors 400 connections, none of which asks for anything, would take more than there are."""
    few = "import resource; resource.setrlimit(resource.RLIMIT_NOFILE, (160, 160))"
    few += "\nfrom gbeam.app import access as connections\nconnections.PATIENCE = 0.5"
    server = start(tmp_path / "kept", few + QUICK.format(code="print('{}')"))
    idle = [socket.create_connection(("127.0.0.1", server.port), SOON) for _ in range(400)]
    server.until(server.submit(), lambda run: run["state"] == "done")  # soon, or it fails
    assert server.said.stat().st_size < 1000, server.said.read_text()[:1000]
    # Those that have waited are closed, all of them, and without one byte.
    for each in idle:
        each.settimeout(SOON)
        with suppress(ConnectionResetError):
            assert each.recv(1) == b""
        each.close()
    # A browser's connections stay while they are used.
    asked = http.client.HTTPConnection("127.0.0.1", server.port, timeout=SOON)
    for _ in range(4):
        time.sleep(0.3)
        asked.request("GET", "/", headers=server.headers or {})
        assert asked.getresponse().read().startswith(b"<!doctype html>")
    asked.close()


@pytest.mark.skipif(sys.platform == "win32", reason="limits of processes are POSIX's")
def test_the_queue_waits_for_descriptors(start: Start, tmp_path: Path) -> None:
    """Whatever has taken them; it says so once."""
    taken = "import resource, os; resource.setrlimit(resource.RLIMIT_NOFILE, (60, 60))\nheld = []"
    taken += QUICK.format(code="print('{}')")
    taken += """
from gbeam.app import server
create = server.create_app
def create_app(folder):
    app = create(folder)
    @app.get("/api/take")
    def take():
        try:
            while True:
                held.append(os.open("/dev/null", os.O_RDONLY))
        except OSError:
            os.close(held.pop()); os.close(held.pop())  # enough to answer, not to start a process
        return []
    @app.get("/api/give")
    def give():
        while held:
            os.close(held.pop())
        return []
    return app
server.create_app = create_app
"""
    server = start(tmp_path / "kept", taken)
    assert server.call("GET", "/api/take")[0] == 200
    number = None
    for _ in range(20):  # the request itself takes a descriptor or two
        status, answer = server.call("POST", "/api/runs", {"text": FAST})
        assert status in (200, 503), answer
        if status == 200:
            number = answer["id"]
        else:
            assert "Too many open files" in answer["errors"][0]["message"]
        time.sleep(0.05)
    assert server.call("GET", "/api/give")[0] == 200
    number = number or server.submit()
    server.until(number, lambda run: run["state"] == "done")
    assert server.said.read_text().count("Too many open files") <= 2, server.said.read_text()[:2000]


FILLS = "f = open('filler', 'wb', 0)\ntry:\n    while f.write(bytes(4096)): pass\nexcept OSError: pass"


@pytest.fixture
def small(tmp_path: Path) -> Iterator[Path]:
    """A folder on a disk of half a megabyte."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = ["mount", "-t", "tmpfs", "-o", "size=512k", "tmpfs", str(disk)]
    if sys.platform != "linux" or os.geteuid() != 0 or subprocess.run(mounted, check=False).returncode:
        pytest.skip("a small disk needs Linux, and root")
    yield disk
    subprocess.run(["umount", "--lazy", str(disk)], check=True)


def test_a_full_disk_loses_nothing(start: Start, small: Path) -> None:
    go = small.parent / "go"
    code = f"import os, time\nwhile not os.path.exists({str(go)!r}): time.sleep(0.02)\n"
    code += f"if not os.path.exists('../../full'):\n    open('../../full', 'w').close()\n    exec({FILLS!r})"
    server = start(small / "kept", QUICK.format(code=code))
    first, second = server.submit(), server.submit(FAST.replace('"fast"', '"second"'))
    go.touch()
    # The first has filled the disk: what is known of it is not lost, and the second waits and says why.
    assert server.until(first, lambda run: run["state"] != "queued" and run["state"] != "running")["state"] == "done"
    waiting = server.until(second, lambda run: "waits" in run["progress"])
    assert waiting["state"] == "queued" and "No space left" in waiting["progress"]
    before = sorted(each.name for each in (small / "kept" / "runs").iterdir())
    status, answer = server.call("POST", "/api/runs", {"text": FAST})
    assert (
        status == 503
        and "No space left" in answer["errors"][0]["message"]
        and "make room" in answer["errors"][0]["hint"]
    )
    assert sorted(each.name for each in (small / "kept" / "runs").iterdir()) == before == sorted([first, second])
    assert server.said.read_text().count("No space left") == 1
    states = [json.loads((small / "kept" / "runs" / each / "state.json").read_text())["state"] for each in before]
    assert states == ["running", "queued"]  # whole, of before
    next(small.rglob("filler")).unlink()
    server.until(second, lambda run: run["state"] == "done")
    server.process.kill()
    server.process.wait(SOON)
    states = [json.loads((small / "kept" / "runs" / each / "state.json").read_text())["state"] for each in before]
    assert states == ["done", "done"]


def test_a_folder_has_one_server(start: Start, tmp_path: Path) -> None:
    folder = tmp_path / "kept"
    first = start(folder)
    second = start(folder, enter=False)
    assert second.process.wait(SOON) == 2 and second.address == ""
    said = second.said.read_text()
    assert f"{folder} is in use by process {first.process.pid}" in said and "another folder" in said
    third = start(tmp_path / "other", port=first.port, enter=False)
    assert third.process.wait(SOON) == 2 and "--port" in third.said.read_text()
    # Of one that was killed nothing is left that would keep the next from starting.
    first.process.kill()
    first.process.wait(SOON)
    assert start(folder).call("GET", "/api/runs") == (200, [])


def test_a_server_starts_on_any_folder_of_runs(start: Start, tmp_path: Path) -> None:
    runs = tmp_path / "kept" / "runs"
    shutil.copytree(Path(__file__).parent, runs / "20260101-000000-00000000", ignore=shutil.ignore_patterns("*.pyc"))
    (runs / "20260101-000000-00000000" / "state.json").write_text("")
    (runs / "elsewhere").mkdir()
    server = start(tmp_path / "kept", QUICK.format(code="print('{}')"))
    _, (run,) = server.call("GET", "/api/runs")
    assert run["state"] == "damaged"
    server.until(server.submit(), lambda run: run["state"] == "done")


PATIENT = "from gbeam.guards import processes\nprocesses.READER_SECONDS = processes.UPLOAD_SECONDS = 3600"


@pytest.mark.skipif(sys.platform != "linux", reason="other systems limit no address space")
def test_files_that_are_read_for_ever_or_hold_too_much_stop_nobody(start: Start, tmp_path: Path) -> None:
    """A mesh of 6.6 kB froze every request for good, and one of 5 kB took the server to 1.5 GB; both were kept."""
    server = start(tmp_path / "kept", PATIENT)

    def largest() -> int:
        """Most memory that the server had, kB."""
        status = Path(f"/proc/{server.process.pid}/status").read_text(encoding="utf-8")
        return int(re.findall(r"VmHWM:\s+(\d+)", status)[0])

    before = largest()
    for path in (large_med(tmp_path), large_vtu(tmp_path)):
        status, answer = server.put(path.name, path.read_bytes())
        assert status == 422 and "MB of memory to read" in answer["errors"][0]["message"]
    assert largest() < before + 50_000
    endless_exodus(tmp_path / "a.exo")
    content = (tmp_path / "a.exo").read_bytes()

    def drop() -> None:
        with suppress(http.client.RemoteDisconnected):  # the server ends
            server.put("a.exo", content)

    with ThreadPoolExecutor() as threads:
        for _ in range(3):
            threads.submit(drop)
        time.sleep(1)  # they are read
        begun = time.monotonic()
        assert server.call("GET", "/api/records") == (200, [])
        assert server.call("POST", "/api/document", {"text": FAST})[1]["errors"] == []
        assert time.monotonic() - begun < SOON
        server.process.terminate()
        assert server.process.wait(SOON) == 143
    assert start(tmp_path / "kept").call("GET", "/api/records") == (200, [])
    assert not [*(tmp_path / "kept" / "records").iterdir()]
