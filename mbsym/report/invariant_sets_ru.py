"""Russian sentences of problem 10."""

# ruff: noqa: E501

SENTENCES = {
    "Pieces that are not invariant by themselves, left aside: [[n]].": "Части, сами по себе не инвариантные, оставлены в стороне: [[n]].",
    "What is said of stability is about these variables: [[names]].": "Сказанное об устойчивости относится к этим переменным: [[names]].",
    "Multipliers of the geometry are Lagrange's: along a motion only the others are constant.": "Множители геометрических связей — множители Лагранжа: вдоль движения постоянны только остальные.",
    "Branches on which the coordinates are singular, left aside: [[n]]; some may have no real points.": "Ветви, на которых координаты вырождаются, оставлены в стороне: [[n]]; на некоторых может не быть вещественных точек.",
    "Problem 10. Steady motions and invariant manifolds": "Задача 10. Стационарные движения и инвариантные многообразия",
    "Families K of first integrals with constant multipliers; a motion that begins where grad K = 0 stays there.": "Семейства K первых интегралов с постоянными множителями; движение, начавшееся там, где grad K = 0, там и остаётся.",
    "V[[k]], [[name]]: [[formula]].": "V[[k]], [[name]]: [[formula]].",
    "Between the variables: [[relations]].": "Между переменными: [[relations]].",
    "It has no stationary points for almost all parameters (proved).": "Стационарных точек при почти всех параметрах нет (доказано).",
    "Branches left aside, because they are beyond the budget or no point of them was found: [[n]]; some may be empty, and there may be further sets.": "Ветви, оставленные в стороне, потому что они выходят за пределы бюджета или на них не найдено ни одной точки: [[n]]; некоторые могут быть пустыми, возможны и другие множества.",
    "Set [[number]], steady motions: [[equations]].": "Множество [[number]], стационарные движения: [[equations]].",
    "They form a family of dimension [[union]].": "Они образуют семейство размерности [[union]].",
    "Set [[number]], an invariant manifold of dimension [[dimension]] for fixed multipliers: [[equations]].": "Множество [[number]], инвариантное многообразие размерности [[dimension]] при фиксированных множителях: [[equations]].",
    "There [[nonzero]].": "На нём [[nonzero]].",
    "Multipliers: [[told]].": "Множители: [[told]].",
    "On it: [[motion]].": "Движение на нём: [[motion]].",
    "No real point was found at the parameters that were tried: whether it has any is open.": "При испытанных параметрах вещественных точек не найдено: есть ли они, не выяснено.",
    "It is invariant (proved: d/dt of its equations vanishes on it).": "Оно инвариантно (доказано: производная его уравнений по времени на нём равна нулю).",
    "That it is invariant was not verified: d/dt of its equations could not be reduced on it.": "Инвариантность не проверена: производную его уравнений не удалось привести на нём.",
    "It is NOT invariant by the equations of motion: this is a defect of mbsym.": "По уравнениям движения оно НЕ инвариантно: это ошибка mbsym.",
    "Stable (proved: the second variation of K on the level of the integrals is definite).": "Устойчивы (доказано: вторая вариация K на уровне интегралов знакоопределена).",
    "Stable as a set, near motions on it that stay bounded (proved: K is definite across it).": "Устойчиво как множество вблизи ограниченных движений на нём (доказано: K знакоопределена поперёк него).",
    "Sufficient for stability, for some value of [[chosen]]: [[first]].": "Достаточно для устойчивости при некотором значении [[chosen]]: [[first]].",
    "Sufficient for stability: [[first]].": "Достаточно для устойчивости: [[first]].",
    "Sufficient for stability as a set, near motions on it that stay bounded: [[first]].": "Достаточно для устойчивости множества вблизи ограниченных движений на нём: [[first]].",
    "Or, with K of the other sign: [[second]].": "Или, при другом знаке K: [[second]].",
    "The second variation is never definite: this family decides nothing about stability.": "Вторая вариация никогда не знакоопределена: это семейство об устойчивости ничего не говорит.",
    "The second variation is degenerate: this family decides nothing about stability.": "Вторая вариация вырождена: это семейство об устойчивости ничего не говорит.",
    "The second variation was not looked at: it is beyond the budget.": "Вторая вариация не рассмотрена: она превышает бюджет.",
    "First approximation: roots of [[factors]].": "Первое приближение: корни многочленов [[factors]].",
    "First approximation: zero roots: [[zeros]]; the others are roots of [[factors]].": "Первое приближение: нулевых корней [[zeros]]; остальные --- корни многочленов [[factors]].",
    "Unstable (proved by the first approximation).": "Неустойчивы (доказано по первому приближению).",
    "Necessary for stability: [[conditions]].": "Необходимо для устойчивости: [[conditions]].",
    "Necessary for stability: [[condition]], unless [[unless]].": "Необходимо для устойчивости: [[condition]], если не [[unless]].",
    "Further necessary conditions were not written out.": "Дальнейшие необходимые условия не выписаны.",
    "All this is for parameters with [[zeros]]; others were not looked at.": "Всё это --- для параметров, при которых [[zeros]]; другие не рассмотрены.",
    "Between them is a gap: a point was found at which what is necessary holds strictly and what is sufficient does not; there this family decides nothing.": "Между ними зазор: найдена точка, где необходимое выполнено строго, а достаточное нет; там это семейство ничего не решает.",
    "Between them is perhaps a gap: a point was found at which what is necessary holds strictly and what is sufficient for no multipliers that were tried.": "Между ними, возможно, зазор: найдена точка, где необходимое выполнено строго, а достаточное --- ни при одном из испытанных множителей.",
    "At every point that was tried where the necessary conditions held strictly the sufficient ones held, too: no gap was found, which is no proof that there is none.": "Во всех испытанных точках, где необходимые условия выполнены строго, выполнены и достаточные: зазор не найден, но это не доказательство его отсутствия.",
}

WORDS = {
    "geometry": "геометрия",
}
