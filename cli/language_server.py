"""The language server: what :mod:`mbsym.editing` knows, in the words of the protocol."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from lsprotocol import types
from pygls.lsp.server import LanguageServer

import mbsym
from mbsym.analysis import Analysis
from mbsym.editing import explanation, suggestions
from mbsym.expressions.place import Complaint
from mbsym.model.system import System
from mbsym.source import read
from mbsym.source.text_lines import says_so

_SEVERITIES = {"error": types.DiagnosticSeverity.Error, "warning": types.DiagnosticSeverity.Warning}

_KINDS = {
    "key": types.CompletionItemKind.Property,
    "name": types.CompletionItemKind.Variable,
    "body": types.CompletionItemKind.Class,
    "function": types.CompletionItemKind.Function,
    "word": types.CompletionItemKind.EnumMember,
}


@dataclass
class Seen:
    """The last text of a document that could be read, and what is derived from it when somebody asks."""

    system: System
    analysis: Analysis


class Server(LanguageServer):
    """One for each editor."""

    def __init__(self) -> None:
        super().__init__("mbsym", mbsym.__version__)
        self.seen: dict[str, Seen] = {}

    def look(self, uri: str) -> None:
        """Reads a document and publishes what there is to complain about."""
        document = self.workspace.get_text_document(uri)
        text = document.source
        parts = urlsplit(uri)
        path = Path(unquote(parts.path))
        diagnostics: list[types.Diagnostic] = []
        if says_so(text):
            system, complaints = read(text, path.name, path.parent if parts.scheme == "file" else None)
            if system is not None and (uri not in self.seen or self.seen[uri].system != system):
                self.seen[uri] = Seen(system, Analysis(system))
            lines = text.splitlines()
            diagnostics = [_diagnostic(complaint, lines) for complaint in complaints.sorted()]
        self.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri=uri, diagnostics=diagnostics, version=document.version)
        )


def _diagnostic(complaint: Complaint, lines: list[str]) -> types.Diagnostic:
    hint = f"\n{complaint.hint}" if complaint.hint else ""
    return types.Diagnostic(
        range=_range(complaint, lines),
        message=complaint.message + hint,
        severity=_SEVERITIES[complaint.severity],
        code=complaint.code,
        source="mbsym",
    )


def _range(complaint: Complaint, lines: list[str]) -> types.Range:
    span = complaint.span
    if span is None or span.line > len(lines):
        return types.Range(types.Position(0, 0), types.Position(0, 1))
    line = lines[span.line - 1]
    first, last = (units(line, column) for column in (span.column - 1, span.column - 1 + span.length))
    return types.Range(types.Position(span.line - 1, first), types.Position(span.line - 1, max(last, first + 1)))


def units(line: str, column: int) -> int:
    """A column in characters as the protocol counts it, in units of UTF-16."""
    return len(line[:column].encode("utf-16-le", "surrogatepass")) // 2


def characters(line: str, column: int) -> int:
    """The inverse of :func:`units`."""
    return len(line.encode("utf-16-le", "surrogatepass")[: 2 * column].decode("utf-16-le", "ignore"))


def placed(text: str, position: types.Position) -> tuple[int, int]:
    """(line, column in characters) of a position.  Beyond the end of a line it is that end, beyond the last line the
    end of the text."""
    lines = text.split("\n")
    if position.line >= len(lines):
        return len(lines) - 1, len(lines[-1])
    line = max(position.line, 0)
    return line, characters(lines[line], max(position.character, 0))


def server() -> Server:
    """A server with everything that it can do."""
    made = Server()

    def asked(parameters: Any) -> tuple[tuple[str, int, int], Any]:
        """The text, its line and column that are asked about, and what was seen of the text."""
        uri = parameters.text_document.uri
        text = made.workspace.get_text_document(uri).source
        return (text, *placed(text, parameters.position)), made.seen.get(uri)

    @made.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def opened(parameters: types.DidOpenTextDocumentParams) -> None:
        made.look(parameters.text_document.uri)

    @made.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def changed(parameters: types.DidChangeTextDocumentParams) -> None:
        made.look(parameters.text_document.uri)

    @made.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def closed(parameters: types.DidCloseTextDocumentParams) -> None:
        made.seen.pop(parameters.text_document.uri, None)

    @made.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=[" ", "[", "{"]))
    def complete(parameters: types.CompletionParams) -> list[types.CompletionItem]:
        place, seen = asked(parameters)
        return [
            types.CompletionItem(
                label=suggestion.label,
                kind=_KINDS[suggestion.kind],
                documentation=suggestion.meaning or None,
                insert_text=suggestion.insert or suggestion.label,
                sort_text=f"{number:05}",
            )
            for number, suggestion in enumerate(suggestions(*place, seen.system if seen else None))
        ]

    @made.feature(types.TEXT_DOCUMENT_HOVER)
    def hover(parameters: types.HoverParams) -> types.Hover | None:
        place, seen = asked(parameters)
        markdown = explanation(*place, seen.analysis if seen else None)
        return None if markdown is None else types.Hover(types.MarkupContent(types.MarkupKind.Markdown, markdown))

    return made


def serve() -> None:
    """On standard input and output, until the editor ends it."""
    server().start_io()
