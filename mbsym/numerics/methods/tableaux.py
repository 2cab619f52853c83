"""Coefficients of explicit Runge-Kutta methods, and of one of Rosenbrock's kind, as exact decimals and fractions.

Sources: Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (2nd ed.), II.1 (the classical method),
II.5 and II.6 (Dormand & Prince 5(4) with its continuous extension), and the coefficients of DOP853 that E. Hairer and
G. Wanner publish with their code to 30 digits (method of order 8, error estimates of orders 5 and 3, continuous
extension of order 7); G. Steinebach, Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within
the Julia Differential Equations package, BIT 63 (2023) 27.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from fractions import Fraction
from typing import Any

import numpy as np

from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.llvm import Scalar
from mbsym.numerics.kernels.writer import Function, Value, clock_kind

Row = tuple[Fraction, ...]


@dataclass(frozen=True)
class Tableau:
    """x_new = x + h sum_j b_j k_j,  k_i = f(t + c_i h, x + h sum_j a_ij k_j),  c_i = sum_j a_ij.

    ``errors`` weighs the k_j (and, last, f at the new point) into error estimates: one of them, or the two of DOP853.
    ``extra`` are further stages that only dense output needs, numbered after f at the new point, and ``dense`` the
    weights of its highest terms:  with s the fraction of the step,

        x(s) = x + s (F0 + (1 - s) (F1 + s (F2 + (1 - s) (F3 + ...)))),
        F0 = x_new - x,   F1 = h f_old - F0,   F2 = 2 F0 - h (f_old + f_new),   F3+i = h sum_j dense_ij k_j
    """

    name: str
    title: str
    order: int
    stages: tuple[Row, ...]
    weights: Row
    errors: tuple[Row, ...] = ()
    extra: tuple[Row, ...] = ()
    dense: tuple[Row, ...] = ()

    @property
    def first_same_as_last(self) -> bool:
        """Whether an error estimate uses f at the new point."""
        return any(row[-1] != 0 for row in self.errors)

    @property
    def terms(self) -> int:
        """How many terms F there are."""
        return 3 + (len(self.dense) or 2)

    @property
    def begin(self) -> int:
        """Which row of what is computed for a step holds f at its begin."""
        return 0


@dataclass(frozen=True)
class Rosenbrock:
    """A method for stiff systems that solves linear equations, all with one matrix a step: J = df/dx at its begin, and

        (1/(gamma h) - J) u_i = f(t + c_i h, x + sum_j a_ij u_j) + sum_j (C_ij/h) u_j + d_i h df/dt,    j < i,
        x_new = x + sum_j m_j u_j,     error = sum_j e_j u_j,

    in the form of Hairer & Wanner, Solving Ordinary Differential Equations II, IV.7.  ``stages`` has the a_ij,
    ``coupling`` the C_ij, ``times`` the c_i, ``slopes`` the d_i.  ``dense`` has the weights of F1, F2, F3 in

        x(s) = x + s (F0 + (1 - s) (F1 + s (F2 + (1 - s) F3))),     F0 = x_new - x,     Fk = sum_j dense_kj u_j.
    """

    name: str
    title: str
    order: int
    gamma: Fraction
    stages: tuple[Row, ...]
    coupling: tuple[Row, ...]
    times: Row
    slopes: Row
    weights: Row
    errors: tuple[Row, ...]
    dense: tuple[Row, ...]
    extra: tuple[Row, ...] = ()

    @property
    def terms(self) -> int:
        """How many terms F there are."""
        return 1 + len(self.dense)

    @property
    def begin(self) -> int:
        """Which row of what is computed for a step holds f at its begin."""
        return len(self.stages)


def _rows(text: str) -> tuple[Row, ...]:
    """The rows of a table, with semicolons between them."""
    return tuple(tuple(map(Fraction, row.split())) for row in text.split(";"))


def _row(text: str) -> Row:
    return _rows(text)[0]


RK4 = Tableau(
    name="rk4",
    title="the classical Runge-Kutta method",
    order=4,
    stages=_rows("; 1/2; 0 1/2; 0 0 1"),
    weights=_row("1/6 1/3 1/3 1/6"),
)

RK45 = Tableau(
    name="rk45",
    title="Dormand and Prince 5(4)",
    order=5,
    stages=_rows(
        """; 1/5; 3/40 9/40; 44/45 -56/15 32/9; 19372/6561 -25360/2187 64448/6561 -212/729;
        9017/3168 -355/33 46732/5247 49/176 -5103/18656"""
    ),
    weights=_row("35/384 0 500/1113 125/192 -2187/6784 11/84"),
    errors=_rows("-71/57600 0 71/16695 -71/1920 17253/339200 -22/525 1/40"),
    dense=_rows(
        """-12715105075/11282082432 0 87487479700/32700410799 -10690763975/1880347072 701980252875/199316789632
        -1453857185/822651844 69997945/29380423"""
    ),
)

_WEIGHTS = _row(
    """
    5.42937341165687622380535766363e-2 0 0 0 0 4.45031289275240888144113950566 1.89151789931450038304281599044
    -5.8012039600105847814672114227 3.1116436695781989440891606237e-1 -1.52160949662516078556178806805e-1
    2.01365400804030348374776537501e-1 4.47106157277725905176885569043e-2
    """
)
_THIRD_ORDER = _row(
    """
    0.244094488188976377952755905512 0 0 0 0 0 0 0 0.733846688281611857341361741547 0 0
    0.220588235294117647058823529412e-1 0
    """
)

DOP853 = Tableau(
    name="dop853",
    title="Dormand and Prince 8(5,3)",
    order=8,
    stages=_rows(
        """;
        5.26001519587677318785587544488e-2;
        1.97250569845378994544595329183e-2 5.91751709536136983633785987549e-2;
        2.95875854768068491816892993775e-2 0 8.87627564304205475450678981324e-2;
        2.41365134159266685502369798665e-1 0 -8.84549479328286085344864962717e-1 9.24834003261792003115737966543e-1;
        1/27 0 0 1.70828608729473871279604482173e-1 1.25467687566822425016691814123e-1;
        3.7109375e-2 0 0 1.70252211019544039314978060272e-1 6.02165389804559606850219397283e-2 -1.7578125e-2;
        3.70920001185047927108779319836e-2 0 0 1.70383925712239993810214054705e-1 1.07262030446373284651809199168e-1
        -1.53194377486244017527936158236e-2 8.27378916381402288758473766002e-3;
        6.24110958716075717114429577812e-1 0 0 -3.36089262944694129406857109825 -8.68219346841726006818189891453e-1
        2.75920996994467083049415600797e+1 2.01540675504778934086186788979e+1 -4.34898841810699588477366255144e+1;
        4.77662536438264365890433908527e-1 0 0 -2.48811461997166764192642586468 -5.90290826836842996371446475743e-1
        2.12300514481811942347288949897e+1 1.52792336328824235832596922938e+1 -3.32882109689848629194453265587e+1
        -2.03312017085086261358222928593e-2;
        -9.3714243008598732571704021658e-1 0 0 5.18637242884406370830023853209 1.09143734899672957818500254654
        -8.14978701074692612513997267357 -1.85200656599969598641566180701e+1 2.27394870993505042818970056734e+1
        2.49360555267965238987089396762 -3.0467644718982195003823669022;
        2.27331014751653820792359768449 0 0 -1.05344954667372501984066689879e+1 -2.00087205822486249909675718444
        -1.79589318631187989172765950534e+1 2.79488845294199600508499808837e+1 -2.85899827713502369474065508674
        -8.87285693353062954433549289258 1.23605671757943030647266201528e+1 6.43392746015763530355970484046e-1
        """
    ),
    weights=_WEIGHTS,
    errors=(
        _row(
            """
            0.1312004499419488073250102996e-01 0 0 0 0 -0.1225156446376204440720569753e+01
            -0.4957589496572501915214079952 0.1664377182454986536961530415e+01 -0.3503288487499736816886487290
            0.3341791187130174790297318841 0.8192320648511571246570742613e-01 -0.2235530786388629525884427845e-01 0
            """
        ),
        tuple(a - b for a, b in zip((*_WEIGHTS, Fraction(0)), _THIRD_ORDER, strict=True)),
    ),
    extra=_rows(
        """
        5.61675022830479523392909219681e-2 0 0 0 0 0 2.53500210216624811088794765333e-1
        -2.46239037470802489917441475441e-1 -1.24191423263816360469010140626e-1 1.5329179827876569731206322685e-1
        8.20105229563468988491666602057e-3 7.56789766054569976138603589584e-3 -8.298e-3;
        3.18346481635021405060768473261e-2 0 0 0 0 2.83009096723667755288322961402e-2
        5.35419883074385676223797384372e-2 -5.49237485713909884646569340306e-2 0 0 -1.08347328697249322858509316994e-4
        3.82571090835658412954920192323e-4 -3.40465008687404560802977114492e-4 1.41312443674632500278074618366e-1;
        -4.28896301583791923408573538692e-1 0 0 0 0 -4.69762141536116384314449447206 7.68342119606259904184240953878
        4.06898981839711007970213554331 3.56727187455281109270669543021e-1 0 0 0 -1.39902416515901462129418009734e-3
        2.9475147891527723389556272149 -9.15095847217987001081870187138
        """
    ),
    dense=_rows(
        """
        -0.84289382761090128651353491142e+01 0 0 0 0 0.56671495351937776962531783590
        -0.30689499459498916912797304727e+01 0.23846676565120698287728149680e+01 0.21170345824450282767155149946e+01
        -0.87139158377797299206789907490 0.22404374302607882758541771650e+01 0.63157877876946881815570249290
        -0.88990336451333310820698117400e-01 0.18148505520854727256656404962e+02 -0.91946323924783554000451984436e+01
        -0.44360363875948939664310572000e+01;
        0.10427508642579134603413151009e+02 0 0 0 0 0.24228349177525818288430175319e+03
        0.16520045171727028198505394887e+03 -0.37454675472269020279518312152e+03 -0.22113666853125306036270938578e+02
        0.77334326684722638389603898808e+01 -0.30674084731089398182061213626e+02 -0.93321305264302278729567221706e+01
        0.15697238121770843886131091075e+02 -0.31139403219565177677282850411e+02 -0.93529243588444783865713862664e+01
        0.35816841486394083752465898540e+02;
        0.19985053242002433820987653617e+02 0 0 0 0 -0.38703730874935176555105901742e+03
        -0.18917813819516756882830838328e+03 0.52780815920542364900561016686e+03 -0.11573902539959630126141871134e+02
        0.68812326946963000169666922661e+01 -0.10006050966910838403183860980e+01 0.77771377980534432092869265740
        -0.27782057523535084065932004339e+01 -0.60196695231264120758267380846e+02 0.84320405506677161018159903784e+02
        0.11992291136182789328035130030e+02;
        -0.25693933462703749003312586129e+02 0 0 0 0 -0.15418974869023643374053993627e+03
        -0.23152937917604549567536039109e+03 0.35763911791061412378285349910e+03 0.93405324183624310003907691704e+02
        -0.37458323136451633156875139351e+02 0.10409964950896230045147246184e+03 0.29840293426660503123344363579e+02
        -0.43533456590011143754432175058e+02 0.96324553959188282948394950600e+02 -0.39177261675615439165231486172e+02
        -0.14972683625798562581422125276e+03
        """
    ),
)

_SIXTH = _row("-7.502846399306121 2.561846144803919 -11.627539656261098 -0.18268767659942256 0.030198172008377946")
_ONE = Fraction(1)

#: Weights of k2, k3, k4 in x(s) = (1 - s) x + s (x_new + (1 - s) (k2 + s (k3 + s k4))), as they are published.
_RODAS5P_DENSE = _rows(
    """
    25.948786856663858 -2.5579724845846235 10.433815404888879 -2.3679251022685204 0.524948541321073 1.1241088310450404
    0.4272876194431874 -0.17202221070155493;
    -9.91568850695171 -0.9689944594115154 3.0438037242978453 -24.495224566215796 20.176138334709044 15.98066361424651
    -6.789040303419874 -6.710236069923372;
    11.419903575922262 2.8879645146136994 72.92137995996029 80.12511834622643 -52.072871366152654 -59.78993625266729
    -0.15582684282751913 4.883087185713722
    """
)

RODAS5P = Rosenbrock(
    name="rodas5p",
    title="Rodas5P of Steinebach, for stiff systems",
    order=5,
    gamma=Fraction("0.21193756319429014"),
    stages=(
        *_rows(
            """;
            3.0;
            2.849394379747939 0.45842242204463923;
            -6.954028509809101 2.489845061869568 -10.358996098473584;
            2.8029986275628964 0.5072464736228206 -0.3988312541770524 -0.04721187230404641
            """
        ),
        _SIXTH,
        (*_SIXTH, _ONE),
        (*_SIXTH, _ONE, _ONE),
    ),
    coupling=_rows(
        """;
        -14.155112264123755;
        -17.97296035885952 -2.859693295451294;
        147.12150275711716 -1.41221402718213 71.68940251302358;
        165.43517024871676 -0.4592823456491126 42.90938336958603 -5.961986721573306;
        24.854864614690072 -3.0009227002832186 47.4931110020768 5.5814197821558125 -0.6610691825249471;
        30.91273214028599 -3.1208243349937974 77.79954646070892 34.28646028294783 -19.097331116725623
        -28.087943162872662;
        37.80277123390563 -3.2571969029072276 112.26918849496327 66.9347231244047 -40.06618937091002
        -54.66780262877968 -9.48861652309627
        """
    ),
    times=_row("0 0.6358126895828704 0.4095798393397535 0.9769306725060716 0.4288403609558664 1 1 1"),
    slopes=_row(
        """
        0.21193756319429014 -0.42387512638858027 -0.3384627126235924 1.8046452872882734 2.325825639765069 0 0 0
        """
    ),
    weights=(*_SIXTH, _ONE, _ONE, _ONE),
    errors=_rows("0 0 0 0 0 0 0 1"),
    dense=(
        _RODAS5P_DENSE[0],
        tuple(a + b for a, b in zip(*_RODAS5P_DENSE[1:], strict=True)),
        tuple(-a for a in _RODAS5P_DENSE[2]),
    ),
)


# What the machine code of Runge-Kutta methods is written with: stages of a tableau, compensated sums, places.


# Places in the arrays that the machine code and Python share; what the code replies.
Clock = IntEnum("Clock", "TIME TIME_CARRY START STEP LAST UNTIL RELATIVE ABSOLUTE PREVIOUS LONGEST BASE SLACK", start=0)
Count = IntEnum(
    "Count",
    "STEPS REJECTED EVALUATIONS FRESH INFINITE CAREFUL LEFT NUMBER PREPARED REPLY SINGULARLY JACOBIANS",
    start=0,
)
Reply = IntEnum("Reply", "REACHED PAUSED STOPPED", start=0)


def clock_dtype(kind: str) -> Any:
    """NumPy's type of LLVM's type of a clock."""
    return np.longdouble if kind == "x86_fp80" else np.float64


class Stages:
    """Text for the stages of a tableau: state ``x``, slopes ``k`` stage by stage, (t, x) of a stage in ``argument``."""

    def __init__(self, function: Function, size: int, scalar: Scalar, apart: bool = False) -> None:
        self.f, self.size, self.scalar, self.apart = function, size, scalar, apart
        self.kind, self.clock = scalar.type, clock_kind(scalar)
        self.argument = function.slot(self.kind, size + 1)

    def slope(self, k: Value, stage: int) -> Value:
        """Where the slopes of a stage begin."""
        return self.f.at(self.kind, k, stage * self.size)

    def combination(self, k: Value, row: Row, i: Value | int) -> Value:
        """sum_j row_j k_j, component i."""
        total: Value | None = None
        for j, weight in enumerate(row):
            if weight:
                term = self.f.number(weight, self.kind) * self.f.load(self.kind, k, i + j * self.size)
                total = term if total is None else total + term
        assert total is not None
        return total

    def evaluate(self, time: Value, result: Value) -> None:
        """f at ``time`` and the states that ``argument`` holds."""
        self.f.store(time.converted(self.kind), self.kind, self.argument)
        self.f.do("rhs", self.argument, result, apart=self.apart)

    def stage(self, x: Value, k: Value, row: Row, number: int, time: Value, step: Value) -> None:
        """k_number = f(t + c h, x + h sum_j row_j k_j)."""
        h = step.converted(self.kind)
        for i in self.f.each(self.size):
            moved = self.f.load(self.kind, x, i) + h * self.combination(k, row, i)
            self.f.store(moved, self.kind, self.argument, i + 1)
        self.evaluate(time + step * sum(row, Fraction(0)), self.slope(k, number))

    def copy(self, source: Value, target: Value) -> None:
        for i in self.f.each(self.size):
            self.f.store(self.f.load(self.kind, source, i), self.kind, target, i)

    def state_argument(self, x: Value) -> None:
        """The argument's states are x."""
        self.copy(x, self.f.at(self.kind, self.argument, 1))


def add_compensated(f: Function, kind: str, x: Value, carry: Value, i: Value | int, change: Value) -> Value:
    """x_i + change with the rounding error of the last time put back in (Kahan); returns the new x_i."""
    old = f.load(kind, x, i)
    value = change - f.load(kind, carry, i)
    new = old + value
    f.store((new - old) - value, kind, carry, i)
    f.store(new, kind, x, i)
    return new


def aligned(shape: int | tuple[int, ...], dtype: Any) -> Any:
    """Zeros that begin a cache line: a vector register filled from two lines, one just written, takes twice as long."""
    count, width = int(np.prod(shape)), np.dtype(dtype).itemsize
    room = np.zeros(count * width + 64, np.uint8)
    first = -address(room) % 64
    return room[first : first + count * width].view(dtype).reshape(shape)


def address(array: Any) -> int:
    pointer: int = array.ctypes.data
    return pointer


def initial_state(dynamics: Dynamics, dtype: Any) -> Any:
    """The scenario's state, correctly rounded."""
    return np.array([exact_number(x, dtype) for x in dynamics.scenario.state], dtype)


def exact_number(value: Fraction, dtype: Any) -> Any:
    """A fraction as a number of NumPy's type (float64, float32, longdouble), correctly rounded or nearly so."""
    head = float(value)
    if dtype is np.longdouble:
        return np.longdouble(head) + np.longdouble(float(value - Fraction(head)))
    return head if dtype is np.float64 else dtype(head)
