"""``mbsym show``: one formula to the screen, or into another program."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from mbsym.expressions.message import Message, joined
from mbsym.report.language import Language
from mbsym_cli.assignments import reduction_of, scaling_of, with_settings
from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, printable, read_description, status
from mbsym_cli.letters import read_letters, with_letters
from mbsym_cli.options import Options

#: Equations of more characters, some screens, are printed only where they are asked for.
MOST_UNASKED = 8000


@click.command("show")
@click.argument("file", type=click.Path(path_type=Path))
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--latex", "language", flag_value="latex", help="Write LaTeX.")
@click.option("--wolfram", "language", flag_value="wolfram", help="Write Wolfram Language.")
@click.option("--python", "language", flag_value="python", help="Write Python, with the names of the description.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option("--scale", metavar="LIST", help="Dimensionless variables: x=L*x1,t=tau/omega0,k=m*omega0**2*kappa.")
@click.option(
    "--reduce", "steps", metavar="STEPS", help="Equations in fewer variables: r=1 by integrals; q by p; O(eps**3)."
)
@click.option("--terms", metavar="N", default="1000000", show_default=True, help="Longest formula that is derived.")
@with_letters
def command(
    file: Path,
    names: tuple[str, ...],
    language: str | None,
    settings: tuple[str, ...],
    scale: str | None,
    steps: str | None,
    terms: str,
    letters: str | None,
) -> None:
    """Print formulas of FILE by their NAMEs: its equations of motion, or what is asked for.

    \b
    equations       M q'' - f = 0              T U L         energies
    accelerations   solved for q''             M f           of M q'' = f
    motion          does it satisfy them       constraints   in velocities
    M0 D G K N B    first approximation
    characteristic  polynomials                determinants  and what they come from
    conditions      of stability               integrals     first integrals
    eigenvalues     at the given values

    The name of a body or frame prints its place, its kinematics and its part of T, that of a coordinate (a speed) its
    equation, terms with accelerations first.  Equations that fill screens are printed where they are asked for by name.
    Without --latex, --wolfram or --python formulas are written as people write them: theta'' is the second derivative,
    a space multiplies.  Exit codes: 0 printed, 1 there is no such result, 2 something is wrong.

    --reduce prints the equations in fewer variables, step by step, each step checked in the original equations:

    \b
    r=1,h=1 by integrals   first integrals solved for r and h, which are 1 at first (exactly: without a value and O())
    q,s by p,h             the equations of p and h solved for q and s: equations of second order are left
    p=p1+eps*a,a=x/(1-b)   a change of variables, and letters that stand in it
    O(eps**3)              series in eps, without terms of this power

    \b
    Examples:
      mbsym show systems/spherical-pendulum.yaml --reduce "psi_dot by integrals"
      mbsym show systems/simple-pendulum.yaml
      mbsym show systems/double-pendulum.yaml T U equations
      mbsym show systems/satellite.yaml conditions --latex
      mbsym show systems/satellite.yaml determinants theta
      mbsym show systems/spring-pendulum.yaml --scale "r=l0*x,t=tau/omega0,k=m*omega0**2,g=l0*omega0**2*nu"
    """
    system = read_description(file)
    asked = Options()
    asked.say = Language("" if system is None else system.language).say
    budget = asked.whole("--terms", terms, 1, 10**12)
    if system is not None and settings:
        system = with_settings(file, system, settings, asked)
    chosen = None if system is None else read_letters(letters, system, asked)
    scaling = scaling_of(scale, system, asked) if system is not None and scale is not None else None
    reducing = None if steps is None else reduction_of(steps, asked)
    if reducing is not None and names:
        asked.complain("--reduce", "not-both", "the reduction prints what it finds, and no NAMEs", "leave them out")
    if asked.refused(file) or system is None or budget is None:
        sys.exit(BAD_INPUT)
    from mbsym.algebra.failures import Failure, message_of
    from mbsym.analysis import Analysis
    from mbsym.expressions.tree import text
    from mbsym.report.formulas_by_name import carried_lines, known_names, lines, reduced_lines, remarked, written
    from mbsym.report.letters import in_letters, letters_of

    formulas = reduction = None
    if scaling is not None:
        from mbsym.analysis.scaled import Formulas, NoDescription
        from mbsym.studies.groups import in_scale

        try:
            with status(False, "scaling"):
                system = in_scale(system, scaling)
        except NoDescription:
            formulas = Formulas(system, scaling, budget)
        except Failure as error:
            complain(file, joined(("--scale", message_of(error)), ": "))
            sys.exit(FAILED)
    analysis = Analysis(system, terms=budget) if formulas is None else formulas.analysis
    if reducing is not None:
        from mbsym.analysis.reducing import reduced

        try:
            with status(False, "reducing"):
                reduction = reduced(analysis, reducing, formulas, system.claims)
        except Failure as error:
            complain(file, joined(("--reduce", message_of(error)), ": "))
            sys.exit(FAILED)
        system = reduction.system
    known = known_names(analysis)
    wanted = names or (("equations",) if system.linear is None else ("M0", "D", "G", "K", "N"))
    unknown = [name for name in wanted if name not in known]
    for name in unknown:
        nothing = Message("nothing is called '[[name]]' here", name=name)
        asked.complain("NAME", "unknown-name", nothing, _nearest(name, known))
    if asked.refused(file):
        sys.exit(BAD_INPUT)
    if chosen is None and language in ("python", "wolfram"):
        chosen = ()  # other programs know no letters, unless somebody asks for them
    worst = OK
    with in_letters(system, chosen) as used:
        for name in wanted:
            try:
                with status(False, f"deriving {name}"):
                    if reduction is not None:
                        found = list(reduced_lines(reduction))
                    else:
                        found = list(lines(analysis, name) if formulas is None else carried_lines(formulas, name))
                    told = [written(line, language or "text") for line in found]
            except Failure as error:
                complain(file, joined((name, message_of(error)), ": "))
                worst = FAILED
                continue
            length = sum(map(len, told))
            if not names and reduction is None and language is None and length > MOST_UNASKED and name == "equations":
                many = "equations: [[count]], of [[length]] characters together; one of them, or all:"
                click.echo(asked.say(Message(many, count=len(found), length=length)))
                click.echo(f"  mbsym show {file} {known[-1]}\n  mbsym show {file} {name}")
                sys.exit(OK)
            for line, text_of_it in zip(found, told, strict=True):
                if line.remark:
                    click.echo(remarked(printable(line.remark), language or "text"))
                click.echo(text_of_it)
    if used:
        click.echo(remarked(asked.say("where"), language or "text"))
        for name, value in letters_of(system).definitions(used):
            click.echo(remarked(f"{name} = {text(value)}", language or "text"))
    sys.exit(worst)


def _nearest(name: str, known: list[str]) -> Message:
    from difflib import get_close_matches

    near = get_close_matches(name, known, 1)
    if near:
        return Message("did you mean '[[other]]'?", other=near[0])
    return Message("there are [[names]]", names=", ".join(known))
