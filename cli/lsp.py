"""``mbsym lsp``: a language server on standard input and output, for editors."""

from __future__ import annotations

import sys

import click

from mbsym.studies.study import Exit


@click.command("lsp")
def command() -> None:
    """Serve an editor: complaints as one types, completion, and what a word means, derived quantities included.

    Speaks the Language Server Protocol on standard input and output; editors start it themselves.  Needs the extra:
    pip install 'mbsym[lsp]'.

    \b
    Example (what an editor starts; in Neovim: vim.lsp.start({ name = "mbsym", cmd = { "mbsym", "lsp" } })):
      mbsym lsp
    """
    try:
        from mbsym_cli.language_server import serve
    except ImportError:
        print("the language server needs pygls: pip install 'mbsym[lsp]'", file=sys.stderr)
        sys.exit(Exit.BAD_INPUT)
    serve()
