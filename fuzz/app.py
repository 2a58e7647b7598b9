"""The app: requests that are malformed, over folders whose records and runs are damaged or vanish meanwhile."""

from __future__ import annotations

import asyncio
import json
import shutil
from pathlib import Path
from typing import Any

from fuzz.cases import Case, Random
from fuzz.damage import damaged
from fuzz.records import BINARIES, SCENARIO, binary, text
from fuzz.results import written
from fuzz.scenarios import NUMBERS, ODD, WORDS, corrupted, texts

NUMBER = "20260102-030405-00000000"
PORT = 4321
RECORD = 'file = "r.csv", time = "t", x = "ax", y = "ay", z = "az", unit = "g"'
STATE = {"state": "done", "title": "turn", "verb": "run", "case": "", "changes": "", "arguments": []}
STATES = ("done", "failed", "running", "queued", "cancelled", "refused", "x", "", None, 1)
WHERE = ("state.json", "input/scenario.toml", "out/result.nc", "progress.txt", "out", "")


def app(chosen: Random) -> Case:
    """Some requests to the app over a folder with a run and a few records."""
    suffix = chosen.choice(list(BINARIES))
    place = f"home/runs/{NUMBER}"
    files = {
        "home/records/r.csv": text(chosen), f"home/records/r{suffix}": binary(chosen.choice(BINARIES[suffix])),
        f"{place}/input/scenario.toml": SCENARIO.replace("RECORD", RECORD).encode(),
        f"{place}/out/result.nc": written("run")["result.nc"], f"{place}/state.json": json.dumps(STATE).encode(),
        f"{place}/progress.txt": b"gbeam: 10% of run\n",
    }  # fmt: skip
    for _ in range(chosen.choice((0, 1, 1, 2, 4))):
        name = chosen.choice(list(files))
        match chosen.randrange(4):
            case 0:
                files[name] = b""
            case 1 if name.endswith("state.json"):
                key = chosen.choice((*STATE, "pid", "outcome"))
                value = chosen.choice(STATES if key == "state" else (*WORDS, *NUMBERS, *ODD))
                files[name] = json.dumps({**STATE, key: value}).encode()
            case _:
                files[name] = damaged(chosen, files[name])
    steps = [_step(chosen, suffix) for _ in range(chosen.choice((1, 2, 4, 6)))]
    return Case("app", ["app"], {"steps.json": json.dumps(steps).encode(), **files})


def _step(chosen: Random, suffix: str) -> dict[str, Any]:
    word = chosen.choice(WORDS)
    number = NUMBER if chosen.random() < 0.8 else word
    document = chosen.choice(texts()) if chosen.random() < 0.5 else SCENARIO.replace("RECORD", RECORD)
    if chosen.random() < 0.5:
        document = corrupted(chosen, document.encode()).decode("utf-8", chosen.choice(("replace", "surrogateescape")))
    name = f"r{suffix}" if chosen.random() < 0.7 else chosen.choice(("r.csv", "new.csv", "a/b", "..", word, "n.zarr"))
    file = chosen.choice(("result.nc", "histories.csv", "report.html", "scenario.toml", "state.json", "..", word))
    match chosen.randrange(9):
        case 0:
            where = (
                f"runs/{NUMBER}/{chosen.choice(WHERE)}" if chosen.random() < 0.8 else chosen.choice(("runs", "records"))
            )
            return {"delete": where}
        case 1:
            return {"method": "GET", "path": f"/api/runs/{number}/{file}"}
        case 2:
            return {"method": chosen.choice(("DELETE", "GET", "PUT")), "path": f"/api/runs/{number}"}
        case 3:
            body = binary(chosen.choice(BINARIES[suffix])) if chosen.random() < 0.7 else text(chosen)
            body = damaged(chosen, body)
            return {"method": "PUT", "path": f"/api/records/{name}", "body": body.decode("latin-1")}
        case 4:
            return {"method": "GET", "path": f"/api/records/{name}"}
        case 5:
            return {
                "method": "GET",
                "path": chosen.choice(("/api/runs", "/api/records", "/api/verbs", "/api/examples")),
            }
    verb = chosen.choice(("document", "edit", "add", "remove", "record", "preview", "example", "runs"))
    body = {"text": document, "path": chosen.choice(("beam.length", "motion.flight", "model.modes.y", "sweep", word))}
    body |= {"value": chosen.choice(("1 m", word)), "choice": chosen.choice(("hub", word)), "name": word}
    record = dict(each.split(" = ") for each in RECORD.replace('"', "").split(", ")) | {"file": name}
    body |= {"motion": chosen.choice(("flight", word)), "record": record}
    if verb == "runs":
        body = {"text": document, "verb": chosen.choice(("run", "static", "sweep", "app", word))}
        body |= {"options": [chosen.choice(("--at=1 s", "--out=/", word))], "case": word}
    if chosen.random() < 0.3:
        body[chosen.choice(list(body))] = chosen.choice((*NUMBERS, *ODD))
    raw = json.dumps(body)
    if chosen.random() < 0.1:
        raw = corrupted(chosen, raw.encode()).decode("latin-1")
    return {"method": "POST", "path": f"/api/{verb}", "body": raw, "json": True}


def play(_: list[str]) -> int:
    """Make the requests that a file of the folder lists; an answer of 500 is the exception behind it."""
    import httpx

    from gbeam.app import Door, create_app

    home, host = Path("home").absolute(), f"http://127.0.0.1:{PORT}"
    steps = json.loads(Path("steps.json").read_text(encoding="utf-8"))
    server = create_app(home)

    async def whole() -> None:
        door = Door(server, PORT, "token")
        async with (
            server.router.lifespan_context(server),
            httpx.AsyncClient(transport=httpx.ASGITransport(door), base_url=host, timeout=None) as client,
        ):
            page = await client.get("/?token=token")
            session = {
                "cookie": page.headers["set-cookie"].split(";")[0], "origin": host,
                "x-gbeam-key": page.headers["location"].removeprefix("/#").split(".")[0],
            }  # fmt: skip
            for step in steps:
                if "delete" in step:
                    target = home / step["delete"]
                    shutil.rmtree(target, ignore_errors=True) if target.is_dir() else target.unlink(missing_ok=True)
                    continue
                headers = session | ({"content-type": "application/json"} if "json" in step else {})
                content = step.get("body", "").encode("latin-1", "replace")
                try:
                    url = httpx.URL(host).copy_with(raw_path=_path(step["path"]))
                    answer = await client.request(step["method"], url, headers=headers, content=content)
                except httpx.InvalidURL:
                    continue
                print(answer.status_code, step["method"], ascii(step["path"]))

    asyncio.run(whole())
    return 0


def _path(path: str) -> bytes:
    """A path as a browser would send it."""
    from urllib.parse import quote

    return quote(path, safe="/.").encode()
