"""Studies: what is asked of a system, how it is found, what is said and written of it; a module a study.

A study's ``Request`` is a frozen dataclass.  Its annotations say what each field is (``request.py``): options of the
command, their help and complaints, and the arguments of the Python function follow from them.  A ``Study``
(``study.py``) joins it with what derives and what tells; ``mbsym_cli.study`` runs it as a command.  ``lyapunov.py``
is a short example.
"""
