"""``python -m mbsym_cli``: the command, of the same interpreter."""

from mbsym_cli.process import command

command()
