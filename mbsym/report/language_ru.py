"""Russian sentences and words of the LaTeX reports."""

# ruff: noqa: E501 (Cyrillic letters look like Latin ones)

from mbsym.problems.stability.theorems import (
    CHETAEV,
    CONVERSE,
    KELVIN_CHETAEV,
    LAGRANGE,
    LINEAR,
    LYAPUNOV,
    MALKIN,
    ROUTH,
)
from mbsym.problems.stability.word import Word

_ROUTES = "Эти результаты получены вторым, независимым путём и сравнены."

SENTENCES = {
    "Routh's form": "Форма Рауса",
    "Hamilton's form": "Форма Гамильтона",
    "Poisson brackets": "Скобки Пуассона",
    "$L$ does not contain $[[ignored]]$, on which no other force acts: the momenta $\\beta = ([[momenta]])$ are constants. Routh's function $R = L - \\beta \\cdot \\dot c$, with the velocities $\\dot c$ of these in terms of $\\beta$, belongs to the others, $s = ([[left]])$: $\\frac{d}{dt} \\frac{\\partial R}{\\partial \\dot s} - \\frac{\\partial R}{\\partial s} = Q$, that is $M^R \\ddot s = f^R$.": "$L$ не содержит $[[ignored]]$, и другие силы на них не действуют: импульсы $\\beta = ([[momenta]])$ постоянны. Функция Рауса $R = L - \\beta \\cdot \\dot c$, где скорости $\\dot c$ этих координат выражены через $\\beta$, относится к остальным, $s = ([[left]])$: $\\frac{d}{dt} \\frac{\\partial R}{\\partial \\dot s} - \\frac{\\partial R}{\\partial s} = Q$, то есть $M^R \\ddot s = f^R$.",
    "With $R = \\frac12 \\dot s \\cdot M^R \\dot s + b \\cdot \\dot s - W$, $W$ the reduced potential:": "При $R = \\frac12 \\dot s \\cdot M^R \\dot s + b \\cdot \\dot s - W$, где $W$ --- приведённый потенциал:",
    "Then by integration:": "Затем интегрированием:",
    "Momenta $p = \\partial L/\\partial \\dot q$, Hamilton's function $H = p \\cdot \\dot q - L$ and the canonical equations $\\dot q = \\partial H/\\partial p$, $\\dot p = -\\partial H/\\partial q + Q$ with the forces $Q$ that have no force function.": "Импульсы $p = \\partial L/\\partial \\dot q$, функция Гамильтона $H = p \\cdot \\dot q - L$ и канонические уравнения $\\dot q = \\partial H/\\partial p$, $\\dot p = -\\partial H/\\partial q + Q$ с силами $Q$, не имеющими силовой функции.",
    "The first integrals of problem 7 in coordinates and momenta:": "Первые интегралы задачи 7 в координатах и импульсах:",
    "They are in involution: all Poisson brackets $\\{F_i, F_j\\} = \\frac{\\partial F_i}{\\partial q} \\cdot \\frac{\\partial F_j}{\\partial p} - \\frac{\\partial F_i}{\\partial p} \\cdot \\frac{\\partial F_j}{\\partial q}$ are zero.": "Они находятся в инволюции: все скобки Пуассона $\\{F_i, F_j\\} = \\frac{\\partial F_i}{\\partial q} \\cdot \\frac{\\partial F_j}{\\partial p} - \\frac{\\partial F_i}{\\partial p} \\cdot \\frac{\\partial F_j}{\\partial q}$ равны нулю.",
    "Poisson brackets $\\{F_i, F_j\\} = \\frac{\\partial F_i}{\\partial q} \\cdot \\frac{\\partial F_j}{\\partial p} - \\frac{\\partial F_i}{\\partial p} \\cdot \\frac{\\partial F_j}{\\partial q}$; those that are not written are zero, or follow by a change of sign.": "Скобки Пуассона $\\{F_i, F_j\\} = \\frac{\\partial F_i}{\\partial q} \\cdot \\frac{\\partial F_j}{\\partial p} - \\frac{\\partial F_i}{\\partial p} \\cdot \\frac{\\partial F_j}{\\partial q}$; невыписанные равны нулю или отличаются знаком.",
    "The system is given by the matrices of its linear equations $M \\ddot q + (D + G)\\, \\dot q + (K + N)\\, q = [[right]]$; what is said of stability is about these equations, which are exactly linear.": "Система задана матрицами своих линейных уравнений $M \\ddot q + (D + G)\\, \\dot q + (K + N)\\, q = [[right]]$; сказанное об устойчивости относится к этим уравнениям, в точности линейным.",
    "The matrix $[[matrix]]$ is read from the file": "Матрица $[[matrix]]$ прочитана из файла",
    "Given by its matrices; degrees of freedom: [[freedom]].": "Задана матрицами; степеней свободы: [[freedom]].",
    "In speeds and positions: $\\dot x = A x$ with the deviations $x$ of $([[names]])$ from $([[values]])$.": "В квазискоростях и положениях: $\\dot x = A x$ для отклонений $x$ величин $([[names]])$ от $([[values]])$.",
    "Unit vectors keep their lengths and the angles between them: zero roots of $A$ that belong to no motion: [[count]].": "Единичные векторы сохраняют длины и углы между собой: нулевых корней $A$, не отвечающих никакому движению, столько: [[count]].",
    "Problems 4 to 6 are told in generalised coordinates and velocities. Near the motion these and the state in speeds (and unit vectors) are smooth functions of each other, so that stability is the same in both.": "Задачи 4--6 изложены в обобщённых координатах и скоростях. Вблизи движения они и состояние в квазискоростях (и единичных векторах) --- гладкие функции друг друга, поэтому устойчивость в тех и других одна и та же.",
    "Kane's equations (equally those of Boltzmann and Hamel) in the speeds $[[speeds]]$: what the motion needs is what the loads supply.": "Уравнения Кейна (то же — уравнения Больцмана — Гамеля) в квазискоростях $[[speeds]]$: слева — то, чего требует движение, справа — то, что дают нагрузки.",
    "Kinematic equations:": "Кинематические уравнения:",
    "No equation above depends on $[[names]]$, which follow by integration:": "Ни одно из этих уравнений не зависит от $[[names]]$; они находятся интегрированием:",
    "As $M \\dot u = f$ with $u = ([[speeds]])$; $M$ is symmetric, entries that are not written are zero.": "В виде $M \\dot u = f$, где $u = ([[speeds]])$; матрица $M$ симметрична, невыписанные элементы равны нулю.",
    "speeds": "квазискорости",
    "orientation told by the quaternion $([[names]]) = (\\cos\\frac{\\phi}{2},\\, n \\sin\\frac{\\phi}{2})$ of norm 1, scalar part first: its axes are those of the frame that it hangs on turned by $\\phi$ about $n$; $v = e \\circ v_b \\circ e^*$ brings components in body axes to that frame": "ориентация задана кватернионом $([[names]]) = (\\cos\\frac{\\phi}{2},\\, n \\sin\\frac{\\phi}{2})$ единичной нормы, скалярная часть первая: оси тела --- оси предыдущей системы, повёрнутые на $\\phi$ вокруг $n$; $v = e \\circ v_b \\circ e^*$ переводит проекции на оси тела в проекции на оси этой системы",
    "Quaternions keep their norm: zero roots of $A$ that belong to no motion: [[count]].": "Кватернионы сохраняют норму: нулевых корней $A$, не отвечающих никакому движению, столько: [[count]].",
    "told by unit vectors, in its axes, along the axes of the frame that it hangs on": "ориентация задана единичными векторами осей предыдущей системы, в осях тела",
    "axis": "ось",
    "with": "где",
    "written out [[terms]] terms, of degree [[degree]]; in full in results.json": "в развёрнутом виде слагаемых: [[terms]], степень [[degree]]; целиком --- в results.json",
    "where $T_2 = \\frac12 \\sum M_{ij}\\, \\dot q_i \\dot q_j$ and $T_0$, the value of $T$ at $\\dot q = 0$, are the parts of $T$ that are quadratic in the velocities and free of them; $T$ and $U$ are those of problem 2, $M$ is that of problem 3.": "где $T_2 = \\frac12 \\sum M_{ij}\\, \\dot q_i \\dot q_j$ и $T_0$ (значение $T$ при $\\dot q = 0$) --- части $T$, квадратичная по скоростям и свободная от них; $T$ и $U$ --- из задачи 2, $M$ --- из задачи 3.",
    "Simulation until $t = [[until]]$ by [[method]]; values and initial state are in simulation.json.": "Расчёт движения до $t = [[until]]$, метод: [[method]]; значения параметров и начальное состояние --- в simulation.json.",
    "It ended early.": "Расчёт прервался раньше срока.",
    "Through intermediate quantities, each defined once, in the order of the recursion. Their first index is the number of a body, the numbers at the end are components, in its axes unless others are named; components that are not listed are zero, or so short that they are written where they occur. Accelerations, forces and moments are those at $\\ddot q = 0$.": "Через промежуточные величины, каждая определена один раз, в порядке рекурсии. Первый индекс --- номер тела, последние цифры --- номера компонент, в его осях, если не названы другие; не перечисленные компоненты равны нулю или так коротки, что написаны там, где встречаются. Ускорения, силы и моменты --- при $\\ddot q = 0$.",
    "$T = \\frac12 \\sum A_{ij}\\, \\dot q_i \\dot q_j + \\sum A_i\\, \\dot q_i + A_0$ is written as a whole.": "$T = \\frac12 \\sum A_{ij}\\, \\dot q_i \\dot q_j + \\sum A_i\\, \\dot q_i + A_0$ записана целиком.",
    "Written out there are [[count]] terms.": "В развёрнутом виде слагаемых: [[count]].",
    "Self-check": "Самопроверка",
    "These results were derived a second time by an independent route and compared.": _ROUTES,
    "result": "результат",
    "first route": "первый путь",
    "second route": "второй путь",
    "agreement": "согласие",
    "Claims": "Утверждения публикаций",
    "Formulas and numbers as they were printed, compared with what is derived here.": (
        "Формулы и числа, как они напечатаны, в сравнении с полученными здесь."
    ),
    "Abbreviations": "Сокращения",
    "place": "место",
    "claim": "утверждение",
    "outcome": "итог",
    "claimed": "утверждается",
    "On the equations of motion": "В силу уравнений движения",
    "With the factor": "С множителем",
    "claimed minus $k$ times derived is": "утверждаемое минус $k$, умноженное на полученное, равно",
    "Claimed minus derived is": "Утверждаемое минус полученное равно",
    "at": "при",
    "right with this added to": "верно, если это прибавить к",
    "right with this taken from": "верно, если это вычесть из",
    "Conventions": "Соглашения",
    "Direction cosines are passive, $v^k = R^{jk} v^j$; the new axes are the rows.": (
        "Направляющие косинусы пассивны, $v^k = R^{jk} v^j$; строки матрицы --- новые оси."
    ),
    "Axes $\\{a_1, a_2, a_3\\}$ with angles $\\{x_1, x_2, x_3\\}$ mean $R = C_{a_3}(x_3)\\, C_{a_2}(x_2)\\, "
    "C_{a_1}(x_1)$; axis $0$ means no rotation.": (
        "Оси $\\{a_1, a_2, a_3\\}$ с углами $\\{x_1, x_2, x_3\\}$ означают $R = C_{a_3}(x_3)\\, C_{a_2}(x_2)\\, "
        "C_{a_1}(x_1)$; ось $0$ --- нет поворота."
    ),
    "Vectors of body $k$ are in its own axes.": "Векторы тела $k$ --- в его собственных осях.",
    "An inertia tensor $\\Theta$ is that of $T = \\frac12\\, \\omega \\cdot \\Theta\\, \\omega$, so its products carry "
    "the minus sign.": (
        "Тензор инерции $\\Theta$ --- из $T = \\frac12\\, \\omega \\cdot \\Theta\\, \\omega$, так что центробежные "
        "моменты входят в него со знаком минус."
    ),
    "$L = T + U$ with the force function $U = -(\\text{potential energy})$.": (
        "$L = T + U$, где $U$ --- силовая функция (потенциальная энергия с обратным знаком)."
    ),
    "Linear form: $M \\ddot q + (D + G)\\, \\dot q + (K + N)\\, q = 0$ with $M$, $D$ (dissipative) and $K$ (potential) "
    "symmetric, $G$ (gyroscopic) and $N$ (circulatory) skew.": (
        "Линейные уравнения: $M \\ddot q + (D + G)\\, \\dot q + (K + N)\\, q = 0$, где $M$, $D$ (диссипативные силы) и "
        "$K$ (потенциальные) симметричны, $G$ (гироскопические) и $N$ (неконсервативные позиционные) кососимметричны."
    ),
    "Problem 1. Kinematics": "Задача 1. Кинематика",
    "Problem 2. Kinetic energy and force function": "Задача 2. Кинетическая энергия и силовая функция",
    "with $A_{ij} = M_{ij}$ of problem 3": "где $A_{ij} = M_{ij}$ из задачи 3",
    "with $A_{ij} = M_{ij}$ and": "где $A_{ij} = M_{ij}$ и",
    "$L$ does not contain $[[names]]$: cyclic.": "$L$ не содержит $[[names]]$: циклические координаты.",
    "Problem 3. Equations of motion": "Задача 3. Уравнения движения",
    "Lagrange's equations of the second kind, $M(q)\\, \\ddot q = f(q, \\dot q, t)$; $M$ is symmetric, entries that are "
    "not written are zero.": (
        "Уравнения Лагранжа второго рода, $M(q)\\, \\ddot q = f(q, \\dot q, t)$; $M$ симметрична, ненаписанные "
        "элементы равны нулю."
    ),
    "Lagrange's equations of the second kind, $M(q)\\, \\ddot q = f(q, \\dot q, t)$, as a straight-line program; $M$ is "
    "symmetric.": (
        "Уравнения Лагранжа второго рода, $M(q)\\, \\ddot q = f(q, \\dot q, t)$, в виде программы без ветвлений; $M$ "
        "симметрична."
    ),
    "Problem 4. The unperturbed motion": "Задача 4. Невозмущённое движение",
    "The unperturbed motion": "Невозмущённое движение",
    "satisfies the equations of motion identically.": "тождественно удовлетворяет уравнениям движения.",
    "does not satisfy the equations of motion: these can never vanish.": (
        "не удовлетворяет уравнениям движения: эти выражения не могут обратиться в нуль."
    ),
    "satisfies the equations of motion if and only if": (
        "удовлетворяет уравнениям движения тогда и только тогда, когда"
    ),
    "which problems 5 and 6 use in the form": "что в задачах 5 и 6 используется в виде",
    "Problem 5. First approximation": "Задача 5. Первое приближение",
    "Inputs, functions of time that are chosen later": "Входы, функции времени, которые выбираются позже",
    "Outputs": "Выходы",
    "With the deviations $v$ of the inputs $([[inputs]])$ from the values at which they are held, the right side is $B v$ instead of zero.": "Если $v$ — отклонения входов $([[inputs]])$ от их постоянных значений, то справа вместо нуля стоит $B v$.",
    "In first-order form, in physical time, with the state $x = (q, \\dot q)$ and the deviations $w$ of the outputs $([[outputs]])$:": "В форме уравнений первого порядка, в физическом времени, с состоянием $x = (q, \\dot q)$ и отклонениями $w$ выходов $([[outputs]])$:",
    "In first-order form, in physical time, with the state $x = (q, \\dot q)$:": "В форме уравнений первого порядка, в физическом времени, с состоянием $x = (q, \\dot q)$:",
    "There is no first-order form": "Формы уравнений первого порядка нет",
    "In physical time and the declared parameters, $q = ([[q]])$ meaning deviations; entries that are not written are "
    "zero.": (
        "В физическом времени и объявленных параметрах, $q = ([[q]])$ --- отклонения; ненаписанные элементы равны нулю."
    ),
    "The equations split into subsystems: [[count]].": "Уравнения распадаются на подсистемы, их число: [[count]].",
    "Derivatives are with respect to $\\tau = [[scale]]\\, t$.": "Производные берутся по $\\tau = [[scale]]\\, t$.",
    "Notation": "Обозначения",
    "No result": "Нет результата",
    "Problem 6. Stability": "Задача 6. Устойчивость",
    "Subsystem": "Подсистема",
    "The characteristic polynomial $[[symbol]]$, freed of a positive factor, is": (
        "Характеристический многочлен $[[symbol]]$, без положительного множителя:"
    ),
    "Number of its factors: [[count]]. A label with $k$ below and $(j)$ above belongs to the power $k$ of $[[variable]]$ in factor $j$.": "Число его множителей: [[count]]. Обозначение с индексом $k$ внизу и $(j)$ наверху относится к степени $k$ величины $[[variable]]$ в множителе $j$.",
    "Conditions": "Условия",
    "Otherwise": "Иначе",
    "if all of these hold": "если выполнено всё следующее",
    "if at least one of these holds": "если выполнено хотя бы одно из условий",
    "if": "если",
    "and at least one of these holds": "и выполнено хотя бы одно из условий",
    "and": "и",
    "Verdict": "Заключение",
    "see the cases.": "см. случаи выше.",
    "Each of these verdicts is about coordinates of one subsystem while the others keep to the unperturbed motion.": (
        "Каждое из этих заключений относится к координатам одной подсистемы, пока остальные следуют невозмущённому "
        "движению."
    ),
    "For the whole system": "Для всей системы",
    "At the given values of the parameters": "При заданных значениях параметров",
    "Eigenvalues there, in physical time, of $[[names]]$": "Собственные значения при них, в физическом времени, для $[[names]]$",
    "On the theorems": "О теоремах",
    "Problem 7. First integrals": "Задача 7. Первые интегралы",
    "None in closed form of the kinds that are looked for.": "Интегралов тех видов, которые разыскиваются, в замкнутом виде нет.",
    "What was found": "Что получено",
    "Bodies and frames: [[bodies]]; degrees of freedom: [[freedom]].": (
        "Тела и системы координат: [[bodies]]; степени свободы: [[freedom]]."
    ),
    "Constraints": "Связи",
    "Coordinates: [[n]]; independent constraints on positions: [[h]], on velocities: [[r]] in all; degrees of freedom: [[f]].": "Координаты: [[n]]; независимые связи на положения: [[h]], на скорости (всего): [[r]]; степени свободы: [[f]].",
    "The ranks were taken at certified enclosures of points that keep the constraints.": "Ранги взяты в доказанных интервальных оболочках точек, удовлетворяющих связям.",
    "Redundant: [[row]] follows from [[others]] ([[sure]]).": "Лишняя связь: [[row]] следует из [[others]] ([[sure]]).",
    "The constraints can be kept only where the parameters satisfy further relations; their number: [[k]].": "Связи совместны, только если параметры удовлетворяют дополнительным соотношениям; их число: [[k]].",
    "The first approximation is about the independent velocities, those of [[free]], and what they depend on.": "Первое приближение составлено для независимых скоростей [[free]] и величин, от которых они зависят.",
    "Dependent coordinates are expanded about the motion, not solved for: [[names]].": "Зависимые координаты разложены в окрестности движения, а не выражены явно: [[names]].",
    "On the motion the constraints demand [[rates]].": "На движении связи требуют [[rates]].",
    "The equations depend on [[names]], of which the velocities are dependent: each of them has an equation of first order of its own, and M has a row of zeros for it.": "Уравнения зависят от [[names]], скорости которых зависимы: для каждой из этих координат есть собственное уравнение первого порядка, а в M ей отвечает нулевая строка.",
    "Dependent speeds: [[dependent]]; independent ones: [[free]].": "Зависимые скорости: [[dependent]]; независимые: [[free]].",
    "Kane's equations (equally those of Boltzmann and Hamel) in the speeds $[[speeds]]$, of the bodies without constraints: what the motion needs is what the loads supply; constraints add $J^T \\lambda$ on the right.": "Уравнения Кейна (равносильные уравнениям Больцмана и Гамеля) в квазискоростях $[[speeds]]$ для тел без связей: то, чего требует движение, дают нагрузки; связи добавляют справа $J^T \\lambda$.",
    "$M$ and $f$ of these equations sorted by $\\dot u$, $u = ([[speeds]])$; $M$ is symmetric, entries that are not written are zero.": "$M$ и $f$ этих уравнений, упорядоченных по $\\dot u$, $u = ([[speeds]])$; матрица $M$ симметрична, невыписанные элементы равны нулю.",
    "$J = \\partial (\\dot\\varphi, \\chi)/\\partial u$, a row for each of these, and $\\gamma$, their second rates (of $\\chi$ the rates) at $\\dot u = 0$; with the multipliers $\\lambda$ of the independent ones, $M \\dot u = f + J^T \\lambda$ and $J \\dot u + \\gamma = 0$.": "$J = \\partial (\\dot\\varphi, \\chi)/\\partial u$, по строке на каждую из них, и $\\gamma$ --- их вторые производные по времени (для $\\chi$ первые) при $\\dot u = 0$; с множителями $\\lambda$ независимых связей $M \\dot u = f + J^T \\lambda$ и $J \\dot u + \\gamma = 0$.",
    "With the independent speeds $v = ([[free]])$: $u = Y v + y_0$, $\\dot u = Y \\dot v + a_0$.": "С независимыми квазискоростями $v = ([[free]])$: $u = Y v + y_0$, $\\dot u = Y \\dot v + a_0$.",
    "With the independent speeds $v = ([[free]])$: $u = Y v + y_0$, $\\dot u = Y \\dot v + a_0$, regular where $[[where]] \\neq 0$.": "С независимыми квазискоростями $v = ([[free]])$: $u = Y v + y_0$, $\\dot u = Y \\dot v + a_0$ там, где $[[where]] \\neq 0$.",
    "Equations without multipliers (Maggi), $\\bar M \\dot v = \\bar f$ with $\\bar M = Y^T M Y$ and $\\bar f = Y^T (f - M a_0)$, the dependent speeds expressed; $\\bar M$ is symmetric, entries that are not written are zero.": "Уравнения без множителей (Маджи), $\\bar M \\dot v = \\bar f$, где $\\bar M = Y^T M Y$ и $\\bar f = Y^T (f - M a_0)$, зависимые квазискорости исключены; матрица $\\bar M$ симметрична, невыписанные элементы равны нулю.",
    "The velocity constraints are integrable (Frobenius; proved): they keep relations between the coordinates, [[k]] in number, and the first approximation is that of disturbances that keep the values of these; the zero roots of others, as many, are not among those below.": "Связи на скорости интегрируемы (Фробениус; доказано): они сохраняют соотношения между координатами, числом [[k]], а первое приближение составлено для возмущений, сохраняющих их значения; нулевые корни остальных возмущений, в том же числе, ниже не приводятся.",
    "No equation of these velocities depends on [[names]].": "Ни одно из уравнений для этих скоростей не зависит от [[names]].",
    "This holds where [[value]].": "Это верно там, где [[value]].",
    "Velocities are constrained besides coordinates, so D, G, K and N are taken as no more than the symmetric and skew parts of two matrices: nothing is said about forces of a kind.": "Связи наложены не только на координаты, но и на скорости, поэтому D, G, K и N — понимаются лишь как симметричные и кососимметричные части двух матриц: о природе сил ничего не утверждается.",
    "Dependent velocities: those of [[dependent]]; independent ones: those of [[free]].": "Зависимые скорости: [[dependent]]; независимые: [[free]].",
    "Whether the velocity constraints are integrable is undecided: the formulas outgrew their budget.": "Интегрируемость связей на скорости не решена: формулы превысили отведённый размер.",
    "The constraints determine all velocities: nothing is left to be integrated.": "Связи определяют все скорости: интегрировать нечего.",
    "The velocity constraints are integrable (Frobenius; [[sure]]): the system is holonomic, and the configurations that can be reached at any one time are of dimension [[k]].": "Связи на скорости интегрируемы (Фробениус; [[sure]]): система голономна, конфигурации, достижимые в каждый момент времени, имеют размерность [[k]].",
    "The velocity constraints are integrable (Frobenius; [[sure]]): the system is holonomic, and the configurations that can be reached are of dimension [[k]].": "Связи на скорости интегрируемы (Фробениус; [[sure]]): система голономна, достижимые конфигурации имеют размерность [[k]].",
    "The velocity constraints are integrable in part ([[sure]]): they keep [[kept]] further relations between the coordinates; the fields and their Lie brackets span [[growth]] dimensions.": "Связи на скорости интегрируемы частично ([[sure]]): они сохраняют ещё соотношений между координатами: [[kept]]; поля и их скобки Ли порождают размерности [[growth]].",
    "The system is nonholonomic ([[sure]]): no relation between the coordinates follows from the velocity constraints; the fields and their Lie brackets span [[growth]] dimensions.": "Система неголономна ([[sure]]): из связей на скорости не следует ни одного соотношения между координатами; поля и их скобки Ли порождают размерности [[growth]].",
    "$J = \\partial (\\dot\\varphi, \\chi)/\\partial \\dot q$, a row for each of these, and $\\gamma$, their second rates (of $\\chi$ the rates) at $\\ddot q = 0$:": "$J = \\partial (\\dot\\varphi, \\chi)/\\partial \\dot q$, по строке на каждую, и $\\gamma$, их вторые производные по времени (от $\\chi$ первые) при $\\ddot q = 0$:",
    "With the velocities $u$ of $[[free]]$: $\\dot q = Y u + y_0$, $\\ddot q = Y \\dot u + a_0$, regular where $[[where]] \\neq 0$.": "Через скорости $u$ координат $[[free]]$: $\\dot q = Y u + y_0$, $\\ddot q = Y \\dot u + a_0$, регулярно при $[[where]] \\neq 0$.",
    "Equations without multipliers (Maggi), $\\bar M \\dot u = \\bar f$ with $\\bar M = Y^T M Y$ and $\\bar f = Y^T (f - M a_0)$, the dependent velocities expressed; $\\bar M$ is symmetric, entries that are not written are zero.": "Уравнения без множителей (Маджи), $\\bar M \\dot u = \\bar f$, где $\\bar M = Y^T M Y$ и $\\bar f = Y^T (f - M a_0)$, зависимые скорости исключены; $\\bar M$ симметрична, невыписанные элементы равны нулю.",
    "The equations without multipliers are longer than the budget of terms.": "Уравнения без множителей длиннее отведённого числа членов.",
    "$M(q)\\, \\ddot q = f(q, \\dot q, t) + J^T \\lambda$, $J \\ddot q + \\gamma = 0$: $M$ and $f$ are those of the bodies without constraints, $\\lambda$ the multipliers of the independent constraints; $M$ is symmetric, entries that are not written are zero.": "$M(q)\\, \\ddot q = f(q, \\dot q, t) + J^T \\lambda$, $J \\ddot q + \\gamma = 0$: $M$ и $f$ относятся к телам без связей, $\\lambda$ — множители независимых связей; $M$ симметрична, невыписанные элементы равны нулю.",
    "With the velocities $u$ of $[[free]]$: $\\dot q = Y u + y_0$, $\\ddot q = Y \\dot u + a_0$.": "Через скорости $u$ координат $[[free]]$: $\\dot q = Y u + y_0$, $\\ddot q = Y \\dot u + a_0$.",
    "$L$ does not contain $[[names]]$; whether a momentum is kept depends on the constraints.": "Лагранжиан $L$ не содержит $[[names]]$; сохраняется ли импульс, зависит от связей.",
    "Reactions in joints": "Реакции в шарнирах",
    "Force $R$ and moment $L$ about the connection point that the joint exerts on the body, in its axes; all that acts across the joint is in them.": "Сила $R$ и момент $L$ относительно точки соединения, с которыми шарнир действует на тело, в его осях; в них входит всё, что действует через шарнир.",
    "With the multipliers, $R + \\sum \\lambda_i R^{(i)}$ and $L + \\sum \\lambda_i L^{(i)}$.": "С множителями: $R + \\sum \\lambda_i R^{(i)}$ и $L + \\sum \\lambda_i L^{(i)}$.",
    "Integrable by itself (proved): [[rows]].": "Интегрируема сама по себе (доказано): [[rows]].",
    "Not integrable by itself (proved): [[rows]].": "Не интегрируема сама по себе (доказано): [[rows]].",
    "Two points coincide: [[first]] and [[second]].": "Две точки совпадают: [[first]] и [[second]].",
    "Two axes are parallel: [[first]] of [[body]] and [[second]] of [[other]].": "Две оси параллельны: [[first]], [[body]], и [[second]], [[other]].",
    "Two points keep the distance [[length]]: [[first]] and [[second]].": "Две точки сохраняют расстояние [[length]]: [[first]] и [[second]].",
    "Rolling without slipping of [[body]] on [[on]]: the contact is at [[contact]] from the connection point, in the axes of [[axes]].": "Качение без проскальзывания: [[body]] по [[on]]; радиус-вектор контакта от точки соединения [[contact]] в осях [[axes]].",
    "Relation between coordinates: [[equation]].": "Соотношение между координатами: [[equation]].",
    "Relation between velocities: [[equation]].": "Соотношение между скоростями: [[equation]].",
    "Bodies and frames: [[bodies]]; coordinates: [[coordinates]]; constraints: [[constraints]].": (
        "Тела и системы координат: [[bodies]]; координаты: [[coordinates]]; связи: [[constraints]]."
    ),
    "Cyclic coordinates: $[[names]]$.": "Циклические координаты: $[[names]]$.",
    "The unperturbed motion satisfies the equations of motion identically.": (
        "Невозмущённое движение тождественно удовлетворяет уравнениям движения."
    ),
    "The unperturbed motion does not satisfy the equations of motion.": (
        "Невозмущённое движение не удовлетворяет уравнениям движения."
    ),
    "The unperturbed motion satisfies the equations of motion under conditions; their number: [[count]].": (
        "Невозмущённое движение удовлетворяет уравнениям движения при условиях; их число: [[count]]."
    ),
    "Stability": "Устойчивость",
    "while the others keep to the unperturbed motion": "пока остальные следуют невозмущённому движению",
    "Stability of the whole system": "Устойчивость всей системы",
    "First integrals": "Первые интегралы",
    "none in closed form of the kinds that are looked for": "тех видов, которые разыскиваются, в замкнутом виде нет",
    "Claims: [[held]] hold, [[refuted]] do not, [[open]] undecided.": (
        "Утверждения публикаций: верны --- [[held]], неверны --- [[refuted]], не решено --- [[open]]."
    ),
    "Problem [[number]]: no result": "Задача [[number]]: нет результата",
    "The system": "Система",
    "Source": "Источник",
    "Generalised coordinates": "Обобщённые координаты",
    "Prescribed": "Заданное движение",
    "Table": "Таблица",
    "a natural cubic spline": "естественный кубический сплайн",
    "straight lines": "прямые отрезки",
    "zero outside": "вне её нуль",
    "its end values outside": "вне её крайние значения",
    "outside as its end pieces go on": "вне её продолжены крайние отрезки",
    "undefined outside": "вне её не определена",
    "[[count]] points": "точек: [[count]]",
    "from the file": "из файла",
    "Parameters": "Параметры",
    "on the inertial frame": "(на инерциальной системе координат)",
    "on body [[body]]": "(на теле: [[body]])",
    "rotation $[[axes]]$ by $[[angles]]$": "поворот $[[axes]]$ на $[[angles]]$",
    "no rotation": "без поворота",
    "connection point": "точка крепления",
    "mass centre": "центр масс",
    "mass": "масса",
    "inertia about the joint": "тензор инерции относительно точки крепления",
    "inertia about the mass centre": "тензор инерции относительно центра масс",
    "accepted as given (identified values)": "принят как задан (идентифицированные значения)",
    "although no body has it": "хотя такого тела нет",
    "gyrostatic moment $h = [[h]]$, the constant angular momentum of rotors inside it: $T$ contains $h \\cdot \\omega$, "
    "as Routh's function of the rotors": (
        "гиростатический момент $h = [[h]]$, постоянный кинетический момент роторов внутри тела: $T$ содержит $h \\cdot "
        "\\omega$, как функция Рауса для роторов"
    ),
    "Loads": "Силы",
    "No loads.": "Активных сил нет.",
    "Relations": "Соотношения",
    "(used from problem 4 on)": "(используются начиная с задачи 4)",
    "Limits of the coordinates, which no force keeps": "Пределы координат, которые никакая сила не удерживает",
    "Assumptions": "Предположения",
    "Unperturbed motion": "Невозмущённое движение",
    "Initial values": "Начальные значения",
    "mbsym [[version]], description SHA-256 [[digest]]": "mbsym [[version]], описание SHA-256 [[digest]]",
    "Interconnection of the bodies, each with its number. Dashed: without mass; double lines: the connection point "
    "moves in the previous body; dotted lines: loads between two bodies; dotted frames: drawn before. At the lines: "
    "axes of rotation with their angles, and other coordinates.": (
        "Структура взаимосвязи тел, каждое со своим номером. Штриховая рамка: без массы; двойная линия: точка крепления "
        "движется в предыдущем теле; пунктирная линия: силы между двумя телами; пунктирная рамка: показано ранее. У "
        "линий: оси поворотов с углами и другие координаты."
    ),
    "Simulations": "Расчёты движения",
    "References": "Литература",
    "the point $[[place]]$ of [[frame]]": "точка $[[place]]$ (тело: [[frame]])",
    "the inertial frame": "инерциальная система координат",
    "inertial frame": "инерц. система",
    "Newtonian field of a centre at the origin of [[centre]], approximate, with $[[nu]]$, expanded to order [[order]] "
    "about the origin $O$ of [[about]]: \\[ [[formula]] \\] over the bodies that this frame carries, with $R$ the "
    "distance of $O$ from the centre, $e$ the unit vector from the centre to $O$, $c$ the mass centre seen from "
    "$O$[[symbols]] and $\\Theta_C$ the inertia about the mass centre.": (
        "Приближённое ньютоновское поле тяготения с центром в начале системы ([[centre]]), $[[nu]]$, разложенное до "
        "порядка [[order]] около начала $O$ системы ([[about]]); силовая функция \\[ [[formula]] \\] по телам, "
        "связанным с этой системой, где $R$ --- расстояние от центра до $O$, $e$ --- единичный вектор от центра к $O$, "
        "$c$ --- радиус-вектор центра масс из $O$[[symbols]], $\\Theta_C$ --- тензор инерции относительно центра масс."
    ),
    "Newtonian field of a centre at the origin of [[centre]], with $[[nu]]$ and exact distances: \\[ [[formula]] \\] "
    "over the bodies that [[about]] carries, with $r$ the mass centre seen from the attracting centre and $\\Theta_C$ "
    "the inertia about the mass centre (MacCullagh's formula: exact for point masses; of an extended body the third and "
    "higher moments are dropped).": (
        "Ньютоновское поле тяготения с центром в начале системы ([[centre]]), $[[nu]]$, с точными расстояниями; силовая "
        "функция \\[ [[formula]] \\] по телам, связанным с системой ([[about]]), где $r$ --- радиус-вектор центра масс "
        "из притягивающего центра, $\\Theta_C$ --- тензор инерции относительно центра масс (формула Мак-Куллага: точна "
        "для точечных масс; моменты тела третьего и высших порядков отброшены)."
    ),
    "Uniform gravity, $g = [[g]]$ in inertial axes: $U = \\sum m\\, g \\cdot r_C$.": (
        "Однородное поле тяжести, $g = [[g]]$ в инерциальных осях: $U = \\sum m\\, g \\cdot r_C$."
    ),
    "Spring of $[[q]]$, stiffness $[[k]]$, rest at $[[rest]]$: $[[u]]$.": (
        "Пружина по координате $[[q]]$, жёсткость $[[k]]$, не напряжена при $[[rest]]$: $[[u]]$."
    ),
    "Spring between [[first]] and [[second]], stiffness $[[k]]$, natural length $[[length]]$: $[[u]]$ with the distance "
    "$d$.": (
        "Пружина между точками: [[first]] --- [[second]], жёсткость $[[k]]$, длина без натяжения $[[length]]$: "
        "$[[u]]$, $d$ --- расстояние."
    ),
    "Damper of $[[q]]$, coefficient $[[c]]$: dissipation function $[[r]]$.": (
        "Демпфер по координате $[[q]]$, коэффициент $[[c]]$: диссипативная функция $[[r]]$."
    ),
    "Damper along the line between [[first]] and [[second]], coefficient $[[c]]$: dissipation function $[[r]]$ with the "
    "distance $d$.": (
        "Демпфер вдоль линии между точками: [[first]] --- [[second]], коэффициент $[[c]]$: диссипативная функция "
        "$[[r]]$, $d$ --- расстояние."
    ),
    "Isotropic damper between [[first]] and [[second]], coefficient $[[c]]$: dissipation function $[[r]]$ with their "
    "relative velocity $v$.": (
        "Изотропный демпфер между точками: [[first]] --- [[second]], коэффициент $[[c]]$: диссипативная функция "
        "$[[r]]$, $v$ --- относительная скорость."
    ),
    "Force $[[force]]$ in the axes of [[axes]], at [[point]].": (
        "Сила $[[force]]$ (в осях: [[axes]]), приложена: [[point]]."
    ),
    "Torque $[[torque]]$ in the axes of [[axes]], on [[body]]; the opposite one on [[other]].": (
        "Момент $[[torque]]$ (в осях: [[axes]]), на тело: [[body]]; противоположный --- на тело: [[other]]."
    ),
    "Torque $[[torque]]$ in the axes of [[axes]], on [[body]].": (
        "Момент $[[torque]]$ (в осях: [[axes]]), на тело: [[body]]."
    ),
    "Dissipation function": "Диссипативная функция",
    "Force function": "Силовая функция",
    "Potential": "Потенциальная энергия",
    "Generalised force": "Обобщённая сила",
    "Generalised forces": "Обобщённые силы",
    "Figure [[name]] of mbsym simulate": "Рисунок [[name]] (mbsym simulate)",
}

WORDS = {
    "Routh's equations": "уравнения Рауса",
    "canonical equations": "канонические уравнения",
    "Poisson brackets": "скобки Пуассона",
    "Hamilton, closed form": "Гамильтон, в замкнутом виде",
    "Routh, closed form": "Раус, в замкнутом виде",
    "rates of first integrals along the canonical equations": "скорости изменения первых интегралов по каноническим уравнениям",
    "zero, as problem 7 found them": "нуль, как нашла их задача 7",
    "first approximation in speeds": "первое приближение в квазискоростях",
    str(Word.ASYMPTOTIC): "асимптотически устойчиво",
    str(Word.ASYMPTOTIC_BUT_TURNED): "асимптотически устойчиво с точностью до поворота пространства",
    str(Word.ASYMPTOTIC_BUT_CYCLIC): (
        "асимптотически устойчиво по отношению к остальным переменным; циклические координаты могут уходить"
    ),
    str(Word.ASYMPTOTIC_BUT_STEADY): (
        "асимптотически устойчиво с точностью до перехода к близкому стационарному движению"
    ),
    str(Word.STABLE): "устойчиво",
    str(Word.STABLE_BUT_CYCLIC): (
        "устойчиво по отношению к остальным переменным; циклические координаты могут уходить"
    ),
    str(Word.GYROSCOPIC): "только гироскопическая стабилизация",
    str(Word.CRITICAL): "устойчиво лишь в первом приближении, критический случай",
    str(Word.UNDECIDED): "не решено",
    str(Word.DEPENDS): "зависит от параметров",
    str(Word.UNSTABLE): "неустойчиво",
    str(Word.UNSTABLE_BUT_BORDERS): "неустойчиво, кроме граничных случаев",
    LAGRANGE: "теорема Лагранжа-Дирихле",
    ROUTH: "теорема Рауса",
    KELVIN_CHETAEV: "теоремы Томсона-Тэта-Четаева",
    LYAPUNOV: "первый метод Ляпунова",
    MALKIN: "теорема Ляпунова-Малкина",
    CHETAEV: "метод связки интегралов Четаева",
    CONVERSE: "обращение теоремы Лагранжа-Дирихле",
    LINEAR: "теория линейных уравнений",
    "conservative": "консервативная",
    "constrained in velocities": "со связями на скорости",
    "gyroscopic conservative": "гироскопическая консервативная",
    "dissipative": "с диссипативными силами",
    "gyroscopic dissipative": "с гироскопическими и диссипативными силами",
    "circulatory": "с неконсервативными позиционными силами",
    "gyroscopic circulatory": "с гироскопическими и неконсервативными позиционными силами",
    "dissipative circulatory": "с диссипативными и неконсервативными позиционными силами",
    "gyroscopic dissipative circulatory": "с гироскопическими, диссипативными и неконсервативными позиционными силами",
    "all roots in lambda^2 real, negative and simple: coefficients and discriminants": (
        "все корни по lambda^2 вещественны, отрицательны и просты: коэффициенты и дискриминанты"
    ),
    "all roots to the left of the imaginary axis: Lienard-Chipart": (
        "все корни слева от мнимой оси: критерий Льенара-Шипара"
    ),
    "all roots but the zero ones to the left of the imaginary axis: Lienard-Chipart": (
        "все корни, кроме нулевых, слева от мнимой оси: критерий Льенара-Шипара"
    ),
    "all roots but the zero ones and those of a turned spin to the left of the imaginary axis: Lienard-Chipart": (
        "все корни, кроме нулевых и корней повёрнутого вращения, слева от мнимой оси: критерий Льенара-Шипара"
    ),
    "holds: the kinetic energy is positive definite": "выполнено: кинетическая энергия положительно определена",
    "never holds": "не выполняется никогда",
    "too long to be written out": "слишком длинно для записи",
    "necessary in the first approximation": "необходимо в первом приближении",
    "while the inputs are held at constant values": "пока входы сохраняют постоянные значения",
    "while the inputs are held at constant values for which the condition of problem 4 holds": "пока входы сохраняют постоянные значения, при которых выполнено условие задачи 4",
    "while the inputs are held at constant values for which the conditions of problem 4 hold": "пока входы сохраняют постоянные значения, при которых выполнены условия задачи 4",
    "provided the condition of problem 4 holds": "при условии задачи 4",
    "provided the conditions of problem 4 hold": "при условиях задачи 4",
    ", decided exactly": ", точно",
    ", decided by rigorous enclosures": ", строгими оценками",
    "coincide": "совпадение",
    "parallel": "параллельность",
    "distance": "расстояние",
    "relation": "соотношение",
    "rolling": "качение",
    "velocity": "скорости",
    "component": "компонента",
    "proved": "доказано",
    "verified numerically": "проверено численно",
    "undecided": "не решено",
    "singular": "вырождена",
    "exact": "точно",
    "FAILED": "РАСХОЖДЕНИЕ",
    "positive": "положительный",
    "negative": "отрицательный",
    "nonnegative": "неотрицательный",
    "nonpositive": "неположительный",
    "nonzero": "не нуль",
    "real": "вещественный",
    "constraints": "связи",
    "constrained motion": "движение со связями",
    "reactions": "реакции",
    "Newton-Euler recursion": "рекурсия Ньютона — Эйлера",
    "kinematics": "кинематика",
    "energy": "энергия",
    "equations of motion": "уравнения движения",
    "straight-line program": "программа без ветвлений",
    "mass matrix": "матрица масс",
    "equilibrium": "невозмущённое движение",
    "linearisation": "линеаризация",
    "perturbed motion": "возмущённое движение",
    "first integrals": "первые интегралы",
    "identical polynomials": "тождественные многочлены",
    "identical polynomials where the conditions of problem 4 hold": (
        "тождественные многочлены при выполнении условий задачи 4"
    ),
    "random parameters": "случайные параметры",
    "regular": "невырождена",
    "holds": "верно",
}
