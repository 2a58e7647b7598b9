"""The door of the app: each way around it that is known is tried."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

from gbeam.app import Door

from ..scenarios import FAST
from .conftest import HOST, PORT, Site

API = "/api/runs"


def test_the_address_gives_a_strict_cookie_once(site: Site) -> None:
    answer = site.call("GET", "/?token=the-token")
    assert answer.status_code == 303 and answer.headers["location"].startswith("/#")  # the token stays in no history
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
    assert "the-token" not in cookie + answer.headers["location"]
    assert site.call("GET", "/", site.opened).status_code == 200
    assert site.call("GET", API, site.opened).json() == []


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 401),
        ({"cookie": f"gbeam-session-{PORT}="}, 401),
        ({"cookie": f"gbeam-session-{PORT}=the-token"}, 401),
        ({"host": f"evil.example:{PORT}"}, 403),  # a name that was made to lead here
        ({"host": f"127.0.0.1:{PORT + 1}"}, 403),
        ({"host": "127.0.0.1"}, 403),
        ({"origin": "http://evil.example"}, 403),
        ({"origin": "null"}, 403),  # a frame in a sandbox, as a report is
        ({"origin": f"https://127.0.0.1:{PORT}"}, 403),
        ({"sec-fetch-site": "cross-site"}, 403),
        ({"sec-fetch-site": "same-site"}, 403),
    ],
)
def test_strangers_are_refused(site: Site, headers: dict[str, str], status: int) -> None:
    key = {"x-gbeam-key": site.opened["x-gbeam-key"]} if status == 401 else site.opened
    answer = site.call("GET", API, {**key, **headers})
    assert answer.status_code == status
    if status == 401:
        assert site.call("GET", "/?token=wrong", headers).status_code == 401


def test_a_server_on_another_port_can_use_no_cookie(site: Site) -> None:
    """The browser sends it the cookie, with which it may read the page, in which nothing is secret."""
    cookie = {"cookie": site.opened["cookie"]}
    number = site.call("POST", API, site.opened, json={"text": FAST}).json()["id"]
    file = f"{API}/{number}/scenario.toml"
    assert site.call("GET", "/", cookie).status_code == 200
    secrets = (site.opened["x-gbeam-key"], site.reader)
    assert not any(secret in site.call("GET", name, cookie).text for name in ("/", "/app.js") for secret in secrets)
    for path in (API, file, "/api/records", "/openapi.json"):
        assert site.call("GET", path, cookie).status_code == 401
    assert site.call("POST", API, {**cookie, "origin": HOST}, json={"text": FAST}).status_code == 401
    # The key in the address of a file opens files, and nothing else.
    read = {"params": {"key": site.reader}}
    assert site.call("GET", file, cookie, **read).text == FAST
    assert site.call("GET", file, **read).status_code == 401
    assert site.call("GET", file, cookie, params={"key": "x" * 43}).status_code == 401
    assert site.call("GET", API, cookie, **read).status_code == 401
    for method in ("DELETE", "POST"):
        assert site.call(method, f"{API}/{number}", {**cookie, "origin": HOST}, **read).status_code == 401


def test_two_servers_leave_each_others_sessions(site: Site, tmp_path: Path) -> None:
    pytest.importorskip("httpx")
    names = []
    for port in (PORT, PORT + 1):
        door = Door(None, port, "the-token")
        scope = {"type": "http", "method": "GET", "path": "/", "query_string": b"token=the-token"}
        answer: list[dict[str, Any]] = []

        async def keep(message: dict[str, Any], into: list[dict[str, Any]] = answer) -> None:
            into.append(message)

        asyncio.run(door({**scope, "headers": [(b"host", f"127.0.0.1:{port}".encode())]}, None, keep))
        names.append(dict(answer[0]["headers"])[b"set-cookie"].split(b"=")[0])
    assert len({*names}) == 2


def test_changes_need_an_origin(site: Site) -> None:
    without = {name: value for name, value in site.opened.items() if name != "origin"}
    assert site.call("POST", "/api/document", without, json={"text": ""}).status_code == 403
    assert site.call("POST", "/api/document", site.opened, json={"text": ""}).status_code == 200
    localhost = {**without, "host": f"localhost:{PORT}", "origin": f"http://localhost:{PORT}"}
    assert site.call("POST", "/api/document", localhost, json={"text": ""}).status_code == 200


def test_pages_have_a_policy_without_inline_script(site: Site) -> None:
    for path in ("/", "/app.js", "/app.css", API):
        headers = site.call("GET", path, site.opened).headers
        policy = headers["content-security-policy"]
        assert "default-src 'none'" in policy and "unsafe" not in policy and "script-src 'self'" in policy
        assert headers["x-content-type-options"] == "nosniff" and headers["referrer-policy"] == "no-referrer"
    page = site.call("GET", "/", site.opened).text
    assert '<script type="module" src=' in page and "style=" not in page


@pytest.mark.parametrize(
    "name", ["..", "../x", "..%2Fx.csv", "%2Fetc%2Fpasswd", "a%00.csv", ".hidden", "a%2Fb.csv", "a%5Cb.csv", "x" * 101]
)
def test_no_record_is_written_elsewhere(site: Site, name: str) -> None:
    answer = site.call("PUT", f"/api/records/{name}", site.opened, content=b"t,z\n0,1\n")
    assert answer.status_code in (404, 405, 422)
    assert not list((site.folder / "records").glob("*")) and {each.name for each in site.folder.iterdir()} <= {
        "records"
    }


def test_links_are_not_followed(site: Site, tmp_path_factory: pytest.TempPathFactory) -> None:
    outside = tmp_path_factory.mktemp("outside") / "secret.csv"
    outside.write_text("t,z\n0,1\n1,1\n")
    records = site.folder / "records"
    records.mkdir()
    (records / "link.csv").symlink_to(outside)
    assert site.call("GET", "/api/records", site.opened).json() == []
    scenario = FAST.replace(
        'acceleration = { z = { profile = "constant", level = "6 g" } }',
        'record = { file = "link.csv", time = "t", x = "0", y = "0", z = "z", unit = "g" }',
    )
    (problem,) = site.call("POST", "/api/document", site.opened, json={"text": scenario}).json()["errors"]
    assert problem["path"] == "motion.flight.record.file" and "is not there" in problem["message"]
    # A file of that name replaces the link and leaves what it led to.
    assert site.call("PUT", "/api/records/link.csv", site.opened, content=b"t,z\n0,2\n1,2\n").status_code == 200
    assert "0,1" in outside.read_text() and not (records / "link.csv").is_symlink()


@pytest.mark.parametrize("name", ["/etc/passwd", "../secret.csv", "x\x00.csv", "records/../x.csv", "C:\\\\x.csv"])
def test_scenarios_read_records_of_the_folder_only(site: Site, name: str) -> None:
    text = FAST.replace(
        'acceleration = { z = { profile = "constant", level = "6 g" } }',
        f'record = {{ file = "{name}", time = "t", x = "0", y = "0", z = "z", unit = "g" }}'.replace("\x00", "\\u0000"),
    )
    for path in ("/api/document", "/api/preview", API):
        answer = site.call("POST", path, site.opened, json={"text": text})
        (problem,) = answer.json()["errors"]
        assert problem["path"] in ("motion.flight.record.file", "") and "root" not in problem["message"]
    assert not (site.folder / "runs").exists()


@pytest.mark.parametrize("number", ["..", "%2e%2e", "20260101-000000-00000000", "x", "20260101-000000-0000000g"])
def test_no_run_is_looked_for_elsewhere(site: Site, number: str) -> None:
    for name in ("state.json", "scenario.toml", "..%2Fscenario.toml"):
        assert site.call("GET", f"/api/runs/{number}/{name}", site.opened).status_code in (404, 422)


@pytest.mark.parametrize(
    "name",
    ["numpy.py", "json.py", "types.py", "gbeam.py", "gbeam.PY", "a.pyc", "a.so", "a.pyd", "a.pth", "a.toml", "a"],
)
def test_files_of_other_kinds_than_scenarios_name_are_refused(site: Site, name: str) -> None:
    """The first four were run: Python imported them where the run began."""
    from gbeam.app import files

    answer = site.call("PUT", f"/api/records/{name}", site.opened, content=b"t,z\n0,1\n1,1\n")
    (problem,) = answer.json()["errors"]
    assert answer.status_code == 422 and not list(site.folder.glob("records/*"))
    assert problem["path"] == name and problem["message"] == f"ends in {Path(name).suffix or 'nothing'}"
    assert {".csv", ".mat", ".nc", ".uff", ".msh", ".npz", ".op4"} < {*files.READ} and ", ".join(files.READ) in problem[
        "hint"
    ]
    (site.folder / "records").mkdir()
    (site.folder / "records" / name).write_bytes(b"t,z\n0,1\n1,1\n")  # of an earlier version
    record = f'record = {{ file = "{name}", time = "t", x = "0", y = "0", z = "z", unit = "g" }}'
    text = FAST.replace('acceleration = { z = { profile = "constant", level = "6 g" } }', record)
    (problem,) = site.call("POST", API, site.opened, json={"text": text}).json()["errors"]
    assert problem["path"] == "motion.flight.record.file" and "ends in" in problem["message"]
    assert site.call("GET", f"/api/records/{name}", site.opened).status_code == 422
    fit = {"text": FAST, "verb": "fit", "options": [f"data={name}", "free=beam.damping_ratio"]}
    assert site.call("POST", API, site.opened, json=fit).status_code == 422 and not (site.folder / "runs").exists()


def test_uploads_are_limited(site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    import gbeam.app.access as access
    import gbeam.app.files as files

    monkeypatch.setattr(files, "LARGEST", 1000)
    answer = site.call("PUT", "/api/records/a.csv", site.opened, content=b"0" * 1001)
    assert answer.status_code == 422 and not list((site.folder / "records").glob("*"))
    monkeypatch.setattr(access, "LARGEST", 2000)
    assert site.call("PUT", "/api/records/a.csv", site.opened, content=b"0" * 2001).status_code == 413

    async def unannounced() -> Any:  # in pieces, without a length
        for _ in range(5):
            yield b"0" * 900

    for method, path in (("PUT", "/api/records/a.csv"), ("POST", "/api/document"), ("POST", "/api/runs")):
        assert site.call(method, path, site.opened, content=unannounced()).status_code == 413
    assert not list((site.folder / "records").glob("*"))
    assert site.call("PUT", "/api/records/b.csv", site.opened, content=b"t,z\n0,1\n1,1\n").status_code == 200
    monkeypatch.setattr(files, "MANY", 1)
    assert site.call("PUT", "/api/records/c.csv", site.opened, content=b"t,z\n0,1\n").status_code == 422


def test_reports_have_an_origin_of_their_own(site: Site) -> None:
    number = site.call("POST", API, site.opened, json={"text": FAST}).json()["id"]
    place = site.folder / "runs" / number
    (place / "out").mkdir()
    (place / "out" / "report.html").write_text("<script>parent.document</script>")
    answer = site.call("GET", f"/api/runs/{number}/report.html", site.opened)
    assert answer.headers["content-security-policy"].startswith("sandbox allow-scripts;")
    (place / "out" / "report.html").unlink()
    (place / "out" / "report.html").symlink_to(Path("/etc/hostname"))
    assert site.call("GET", f"/api/runs/{number}/report.html", site.opened).status_code == 422
    assert HOST in site.opened["origin"]
