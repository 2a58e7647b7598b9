"""The routes of the app, and the server on 127.0.0.1."""

from __future__ import annotations

import asyncio
import errno
import secrets
import signal
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager, nullcontext
from importlib.resources import files as resources
from pathlib import Path
from types import FrameType
from typing import Annotated, Any

from fastapi import Body, FastAPI, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.exceptions import RequestValidationError
from fastapi.responses import FileResponse, JSONResponse, Response
from pydantic import AfterValidator, Field
from starlette.requests import ClientDisconnect

from gbeam.app import documents, files
from gbeam.app.access import ASSETS, AT_ONCE, REPORT_POLICY, Connections, Door, listening
from gbeam.app.documents import head, load_curves
from gbeam.app.jobs import Jobs
from gbeam.app.verbs import arguments as arguments_of
from gbeam.app.verbs import records as records_of
from gbeam.app.verbs import verb_facts
from gbeam.cli.process import end_on_signals
from gbeam.errors import GbeamError, InputError
from gbeam.guards.limits import SCENARIO_BYTES
from gbeam.guards.processes import hold_lock, upload_limits
from gbeam.io.netcdf import csv_of, read_stored
from gbeam.numerics.sparse import solver
from gbeam.scenario.text.source import parse

_KINDS = {".js": "text/javascript", ".css": "text/css", ".html": "text/html; charset=utf-8"}
_BINARY = {".nc": "application/octet-stream", ".mat": "application/octet-stream", ".png": "image/png"}
REFUSALS = "x-gbeam-refusal"  # header of a request that accepts a refusal with status 200, and of each refusal


def _check_text(text: str) -> str:
    """Refuse a lone surrogate, half a character, which JSON can escape but no file can hold."""
    if any("\ud800" <= character <= "\udfff" for character in text):
        raise ValueError("half a character")
    return text


Word = Annotated[str, AfterValidator(_check_text)]
Text = Annotated[Word, Body(embed=True, max_length=SCENARIO_BYTES)]
Line = Annotated[Word, Field(max_length=1000)]
Short = Annotated[Word, Body(embed=True, max_length=1000)]


def create_app(folder: Path) -> FastAPI:
    """Return the application on the records and runs of a folder; a `Door` is to guard it."""
    records, jobs = folder / "records", Jobs(folder / "runs")

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        asyncio.get_running_loop().set_exception_handler(_exception_handler(jobs.complain))
        files.tidy(records)
        jobs.start()
        yield
        await jobs.stop()

    solver()  # RSLAB's allocator ends the process where the thread that imported it has ended
    app = FastAPI(title="gbeam", docs_url=None, redoc_url=None, lifespan=lifespan)
    app.add_middleware(_Tight)

    @app.exception_handler(GbeamError)
    async def refuse(request: Request, error: GbeamError, status: int = 422) -> JSONResponse:
        # The page shows it at its place, and asks for status 200: browsers log others in their console as errors.
        status = 200 if REFUSALS in request.headers else status
        return JSONResponse({"errors": documents.problems(error)}, status, {REFUSALS: "1"})

    @app.exception_handler(OSError)
    async def fail(request: Request, error: OSError) -> JSONResponse:
        problem = f"cannot be reached: {error.strerror or error}"
        fix = f"make room on the disk of {folder}" if error.errno == errno.ENOSPC else "try again in a moment"
        return await refuse(request, InputError("folder", problem, fix), 503)

    @app.exception_handler(ClientDisconnect)
    async def leave(_: Request, __: ClientDisconnect) -> Response:
        return Response(status_code=400)  # nobody receives it

    @app.exception_handler(RequestValidationError)
    async def misread(_: Request, error: RequestValidationError) -> JSONResponse:
        # FastAPI would repeat the input, which may be text that no answer can hold.
        problems = [
            {"loc": problem["loc"], "msg": problem["msg"], "type": problem["type"]} for problem in error.errors()
        ]
        return JSONResponse({"detail": problems}, 422)

    app.add_api_route("/", _asset("index.html", "gbeam.app"), include_in_schema=False)
    for name, package in ASSETS.items():
        app.add_api_route(f"/{name}", _asset(name, package), include_in_schema=False)

    @app.get("/api/examples")
    def offered_examples() -> Sequence[str]:
        """The names of scenarios to start from."""
        return files.EXAMPLES

    @app.post("/api/example")
    def example(name: Short) -> dict[str, Any]:
        """A scenario to start from, whose record is kept."""
        return documents.described(files.example(name, records), records)

    @app.post("/api/document")
    def document(text: Text) -> dict[str, Any]:
        """The form of a scenario, and what is wrong with it."""
        return documents.described(text, records)

    @app.post("/api/edit")
    def edit(text: Text, path: Short, value: Short) -> dict[str, Any]:
        """A scenario with another value at a path, or without it where that is empty."""
        return documents.described(documents.edited(text, path, value), records)

    @app.post("/api/add")
    def add(text: Text, path: Short, choice: Short) -> dict[str, Any]:
        """A scenario with a new table at a path, or another kind of table."""
        return documents.described(documents.added(text, path, choice), records)

    @app.post("/api/remove")
    def remove(text: Text, path: Short) -> dict[str, Any]:
        """A scenario without what is written at a path."""
        return documents.described(documents.removed(text, path), records)

    @app.post("/api/record")
    def map_record(text: Text, motion: Short, record: Annotated[dict[Word, Word], Body(embed=True)]) -> dict[str, Any]:
        """A scenario whose flight follows a record."""
        return documents.described(documents.with_record(text, motion, record), records)

    @app.post("/api/mesh")
    def map_mesh(
        text: Text, body: Short, mesh: Annotated[dict[Word, Word | Sequence[Word]], Body(embed=True)]
    ) -> dict[str, Any]:
        """A scenario whose specimen, or one of whose bodies, is a mesh."""
        return documents.described(documents.with_mesh(text, body, mesh), records)

    @app.post("/api/preview")
    def preview(text: Text) -> dict[str, Any]:
        """The load of every flight of a scenario over time."""
        documents.records(parse(documents.NAME, text), records)
        return load_curves(text, records)

    @app.get("/api/records")
    def stored() -> list[str]:
        """The records that scenarios may name."""
        return files.names(records)

    @app.put("/api/records/{name}", openapi_extra={"requestBody": {"content": {"application/octet-stream": {}}}})
    async def upload(name: str, request: Request) -> dict[str, Any]:
        """Keep a record or a mesh; what its columns are, or its skin."""
        files.check_kind(name)
        content = await request.body()
        return await run_in_threadpool(files.store, records, name, content, head)

    @app.get("/api/records/{name}")
    def described_record(name: str) -> dict[str, Any]:
        """Columns of a record that is kept, or the skin of a mesh."""
        return head(files.regular(records, files.check_kind(name)))

    @app.get("/api/runs")
    def runs() -> list[dict[str, Any]]:
        """All runs, the latest first."""
        return jobs.list()

    @app.get("/api/verbs")
    def offered() -> dict[str, Any]:
        """Verbs for a scenario, with their options."""
        return verb_facts()

    @app.post("/api/runs")
    def submit(
        text: Text,
        verb: Annotated[Word, Body(embed=True, max_length=100)] = "run",
        options: Annotated[Sequence[Line], Body(embed=True, max_length=20)] = (),
        case: Annotated[Word, Body(embed=True, max_length=100)] = "",
    ) -> dict[str, str]:
        """Queue a verb on a scenario; of a sweep's case the run that is there."""
        document = documents.described(text, records, distributions=verb == "sweep")
        if document["errors"]:
            raise documents.Unfit(document["errors"])
        data = parse(documents.NAME, text)
        arguments = arguments_of(verb, options, data)
        title = str(data.get("title", ""))[:200]
        files_named = [files.regular(records, files.check_kind(name)) for name in records_of(verb, options)]
        inputs = [*documents.records(data, records), *files_named]
        last_text = jobs.last_text(title)
        changes = documents.changes(last_text, text) if last_text else ""
        return {"id": jobs.submit(text, title, inputs, verb, arguments, case, changes)}

    @app.delete("/api/runs/{number}")
    def cancel(number: str) -> dict[str, Any]:
        """End a run, or take it out of the queue."""
        jobs.cancel(number)
        return jobs.state(number)

    @app.get("/api/runs/{number}/histories.csv")
    def histories(number: str) -> Response:
        """The histories of a run as text."""
        table = csv_of(read_stored(jobs.file(number, "result.nc")))
        headers = {"content-disposition": f'attachment; filename="{number}-histories.csv"'}
        return Response(table, media_type="text/csv; charset=utf-8", headers=headers)

    @app.get("/api/runs/{number}/{name}")
    def download(number: str, name: str) -> FileResponse:
        """A file of a run."""
        file = jobs.file(number, name)
        options: dict[str, Any] = {"headers": {"content-security-policy": REPORT_POLICY}, "stat_result": file.stat()}
        if file.suffix == ".html":
            return FileResponse(file, media_type="text/html; charset=utf-8", **options)
        kind = _BINARY.get(file.suffix, "text/plain; charset=utf-8")
        return FileResponse(file, media_type=kind, filename=f"{number}-{name}", **options)

    return app


class _Tight:
    """Reads files, all of which were sent, within the limits of uploads."""

    def __init__(self, app: Any) -> None:
        self._app = app

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Answer a request."""
        with upload_limits() if scope["type"] == "http" else nullcontext():
            await self._app(scope, receive, send)


def _asset(name: str, package: str) -> Callable[[], Response]:
    def asset() -> Response:
        content = (resources(package) / "assets" / name).read_bytes()
        return Response(content, media_type=_KINDS[name[name.rindex(".") :]])

    return asset


def _exception_handler(complain: Callable[[str], None]) -> Callable[[asyncio.AbstractEventLoop, dict[str, Any]], None]:
    """Return a handler of the event loop's exceptions that complains once, not at every connection, of lacking
    descriptors, disk or memory.
    """

    def handle(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        error = context.get("exception")
        if isinstance(error, OSError) and error.errno in files.SHORT:
            complain(error.strerror or str(error))
        else:
            loop.default_exception_handler(context)

    return handle


def serve(folder: Path, port: int, announce: Callable[[str], None]) -> None:
    """Serve the app on 127.0.0.1 until it is interrupted. Call `announce` with the address before it begins."""
    import uvicorn

    class Server(uvicorn.Server):
        """Ends its runs and itself at once when it is told to: a request may read a file for long."""

        def handle_exit(self, sig: int, frame: FrameType | None) -> None:
            self.told = sig
            super().handle_exit(sig, frame)

        async def shutdown(self, sockets: Any = None) -> None:
            await self.lifespan.shutdown()
            end_on_signals()
            signal.raise_signal(self.told)

    with hold_lock(
        files.ensure_folder(folder) / ".lock", "--folder", "open the address that it printed, or name another folder"
    ):
        try:
            opened = listening(port)
        except OSError as error:
            problem = f"cannot be listened on ({error.strerror})"
            raise InputError("--port", problem, "leave it out, or give another") from None
        port = opened.getsockname()[1]
        token = secrets.token_urlsafe(24)
        guarded: Any = Connections(Door(create_app(folder), port, token))
        config = uvicorn.Config(
            guarded,
            http=guarded.protocol,
            backlog=AT_ONCE,
            log_level="error",
            access_log=False,
            ws="none",
            server_header=False,
        )
        announce(f"http://127.0.0.1:{port}/?token={token}")
        Server(config).run(sockets=[opened])
