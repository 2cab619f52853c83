"""``mbsym edit``: the editor, a page on this machine."""

from __future__ import annotations

import sys
import threading
from collections.abc import Mapping
from pathlib import Path

import click

from mbsym.expressions.message import Message
from mbsym.studies.study import Exit
from mbsym_cli.console import complain, printable
from mbsym_cli.files import deliver, folder_for, obstacle
from mbsym_cli.options import Options


@click.command("edit")
@click.argument("file", required=False, type=click.Path(path_type=Path))
@click.option("--port", default="0", metavar="N", help="Of the page's address.  [default: a free one]")
@click.option("--no-browser", is_flag=True, help="Print the address only.")
def command(file: Path | None, port: str, no_browser: bool) -> None:
    """Draw, describe and understand a mechanism in one window: structure, forms, text, picture and results.

    Opens a page in the browser that this machine alone can see; nothing leaves it.  FILE need not be there yet; without
    one a new description is begun.  Saving writes FILE, exporting writes reports/NAME, and nothing else is written but
    a journal of what is not saved (.FILE.mbsym-journal), which is offered at the next start.  Ctrl-C ends it.  Needs
    the extra:  pip install 'mbsym[edit]'.

    \b
    Examples:
      mbsym edit systems/satellite.yaml
      mbsym edit crane.yaml --no-browser --port 8321
    """
    try:
        from mbsym.serving.application import Services
        from mbsym.serving.server import serve
    except ImportError as error:
        if (error.name or "").partition(".")[0] not in ("starlette", "uvicorn", "anyio", "h11", "click"):
            raise
        print("the editor needs Starlette and Uvicorn: pip install 'mbsym[edit]'", file=sys.stderr)
        sys.exit(Exit.BAD_INPUT)
    options = Options()
    number = options.whole("--port", port, 0, 65535)
    if options.refused() or number is None:
        sys.exit(Exit.BAD_INPUT)
    path = file or _unused()
    reason = _unfit(path)
    if reason:
        complain(path, reason)
        sys.exit(Exit.BAD_INPUT)
    folder = path.absolute().parent / folder_for(path, None)

    def write(place: Path, texts: Mapping[str, str | bytes], what: str, gone: list[str]) -> list[Path]:
        against = obstacle(place, place.parent)
        if against:
            raise OSError(0, against)
        return deliver(place, texts, what, gone)

    def ready(address: str) -> None:
        print(address, flush=True)
        print(f"{printable(path)} is edited there; Ctrl-C ends it", file=sys.stderr)
        if not no_browser:
            import webbrowser

            threading.Timer(0.3, webbrowser.open, (address,)).start()

    try:
        serve(path, Services(folder, write), number, ready)
    except OSError as error:
        complain(path, Message("port [[number]]: [[why]]", number=number, why=error.strerror or error))
        sys.exit(Exit.BAD_INPUT)
    except KeyboardInterrupt:
        sys.exit(Exit.INTERRUPTED)


def _unused() -> Path:
    """mechanism.yaml, or the first of its numbered siblings that is not there."""
    path, count = Path("mechanism.yaml"), 1
    while path.exists():
        count += 1
        path = Path(f"mechanism-{count}.yaml")
    return path


def _unfit(path: Path) -> str:
    """Why a file cannot be edited; "" where nothing speaks against it."""
    from mbsym.serving.storage import Storage, Unreadable

    if not path.absolute().parent.is_dir():
        return "there is no such folder"
    try:
        Storage(path).read()
    except Unreadable as error:
        return str(error)
    except (OSError, ValueError) as error:
        return str(error)
    return ""
