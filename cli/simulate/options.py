"""The options of ``mbsym simulate``, in the order of its help; those that Python has, too, are fields of a request."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from mbsym.studies.request import fields_of
from mbsym.studies.simulate import Request
from mbsym_cli.console import OutPath
from mbsym_cli.requests import option_of

#: ``--certify`` without a number; the narrowest and the widest that can be asked for.
USUAL_WIDTH, NARROWEST, WIDEST = "1e-10", 1e-100, 1e-3

#: What a proof may cost where no seconds are given: counted work, worth about so many seconds.
WORK = 600.0

#: Words of ``--gravity``.
ORDERS = ("2", "3", "4", "exact")


def _option(name: str, help: str = "", metavar: str | None = None, **further: Any) -> click.Option:
    return click.Option(name.split(), help=help or None, metavar=metavar, **further)


def _flag(name: str, help: str) -> click.Option:
    return _option(name, help, is_flag=True)


def _fields(*names: str) -> Iterator[click.Option]:
    by_name = {field.name: field for field in fields_of(Request)}
    return (option_of(by_name[name]) for name in names)


OPTIONS: tuple[click.Option, ...] = (
    *_fields("time", "values", "samples", "every"),
    _option("--input laws", 'An input of the file: "u=sin(3*t)"; repeatable.', "NAME=LAW", multiple=True),
    *_fields("method", "tolerance", "step", "max_step", "arithmetic", "step_limit", "invariants", "estimate", "whole"),
    _option(
        "--accuracy",
        "Tolerable relative error over the whole time (1e-6; theta=1e-6,energy=1e-9): model, method, "
        "tolerance and arithmetic are chosen for it.",
        "X",
    ),
    _flag("--plan", "Print what --accuracy chooses and its bound; run nothing."),
    _option(
        "--gravity",
        "Order of Newtonian gravity.  [default: as described; chosen by --accuracy]",
        f"[{'|'.join(ORDERS)}]",
    ),
    _flag("--linear", "Integrate the equations linearised about the unperturbed motion."),
    _option("--without", "Take a parameter as zero; repeatable.", "NAME", multiple=True),
    _option(
        "--vary",
        "Many motions at once: theta=0:pi/2:1000 (a grid), theta=normal(0.3, 0.01), m=uniform(1, 2); repeatable.",
        "NAME=RANGE",
        multiple=True,
    ),
    _option("--members", "How many members to draw at random, for example --members 1000.", "N"),
    _option("--seed", "Of what is drawn at random.", "N", default="1", show_default=True),
    _option("--sampling", metavar="[random|sobol]", default="random", show_default=True),
    _option(
        "--sensitivity", "Derivatives of the motion by initial values and parameters: --sensitivity theta,m1.", "NAMES"
    ),
    _option(
        "--certify width",
        "Prove where the exact solution is, to this part of each size, and how far the run is from it.  "
        f"[default: {USUAL_WIDTH}]",
        "[WIDTH]",
        is_flag=False,
        flag_value=USUAL_WIDTH,
    ),
    _option(
        "--certify-seconds",
        "How long the proof may take; ends early where a tenth of it shows that ten times as much would not do.  "
        f"[default: counted work, worth about {WORK:g} s]",
        "S",
    ),
    _option("--event events", 'Record when: "theta = 0 rising"; repeatable.', "CONDITION", multiple=True),
    _option("--stop stops", 'End the run when: "r < 1/10"; repeatable.', "CONDITION", multiple=True),
    _option("--section", 'Poincare section: "t = 0 mod 2*pi/Omega", "q1 = 0 rising".', "CONDITION"),
    _option("--axes", 'Of the section: "q2, q2_dot".  [default: the first free coordinate]', "X,Y"),
    _option(
        "--continue path",
        "Go on from where an earlier run of FILE ended, up to T; its rows come first.",
        "simulation.json",
        type=click.Path(path_type=Path),
    ),
    _option("--fixed", "Initial values that stay while the others are fitted to the constraints.", "NAMES"),
    _option(
        "--variables",
        "Of a description with speeds: integrate these, and unit vectors or quaternions in place of angles, or "
        "coordinates and their velocities.  [default: declared]",
        "[declared|coordinates]",
    ),
    _option("--format -f formats", default="csv,svg,png", show_default=True),
    _flag("--bodies", "What each body does, in bodies.csv; the same as format bodies-csv."),
    _flag("--animate", "animation.html and animation.gif; the same as formats html,gif."),
    _option("--out -o", "Folder.  [default: reports/NAME]", type=OutPath(path_type=Path, file_okay=False)),
    _flag("--quiet -q", "Print only what went wrong."),
    _flag("--verbose -v", "Tell how it was done, too: method, setting, work, what rests."),
)
