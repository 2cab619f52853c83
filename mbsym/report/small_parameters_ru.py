"""Russian sentences of problem 12."""

# ruff: noqa: E501

SENTENCES = {
    "Problem 12. Small parameters": "Задача 12. Малые параметры",
    "Slow integral manifold up to order [[order]] of [[small]]: the fast variables [[fast]] as functions of the slow ones [[slow]], and the flow on it. The coefficient of the power k of [[small]] has the index (k).": "Медленное интегральное многообразие до порядка [[order]] по [[small]]: быстрые переменные [[fast]] как функции медленных [[slow]] и движение на нём. Коэффициент при степени k параметра [[small]] обозначен верхним индексом (k).",
    "The description names no small parameter, and no prescribed quantity has a parameter as its rate: nothing is expanded.": "В описании не назван малый параметр, и ни у одной заданной величины скорость не является параметром: раскладывать не по чему.",
    "The manifold attracts near this motion for all sufficiently small [[small]] > 0 (proved: Hurwitz's minors of the fast roots, by their first coefficients).": "Многообразие притягивает вблизи этого движения при всех достаточно малых [[small]] $> 0$ (доказано: миноры Гурвица быстрых корней, по их первым коэффициентам).",
    "The manifold attracts near this motion for all sufficiently small [[small]] > 0 where [[conditions]] (proved: Hurwitz's minors of the fast roots, by their first coefficients).": "Многообразие притягивает вблизи этого движения при всех достаточно малых [[small]] $> 0$, если [[conditions]] (доказано: миноры Гурвица быстрых корней, по их первым коэффициентам).",
    "The manifold does not attract near this motion for any sufficiently small [[small]] > 0 (proved: a Hurwitz minor of the fast roots is negative).": "Многообразие не притягивает вблизи этого движения ни при каких достаточно малых [[small]] $> 0$ (доказано: один из миноров Гурвица быстрых корней отрицателен).",
    "Whether the manifold attracts near this motion is undecided: a Hurwitz minor of the fast roots vanishes to the order of the expansion, or has no sign.": "Притягивает ли многообразие вблизи этого движения, не выяснено: один из миноров Гурвица быстрых корней равен нулю в пределах порядка разложения или не имеет определённого знака.",
    "All roots of the flow on it but [[zeros]] that are zero have negative real parts for all sufficiently small [[small]] > 0 (proved in first approximation).": "Все корни движения на нём, кроме нулевых (числом [[zeros]]), имеют отрицательные вещественные части при всех достаточно малых [[small]] $> 0$ (доказано в первом приближении).",
    "All roots of the flow on it but [[zeros]] that are zero have negative real parts for all sufficiently small [[small]] > 0 where [[conditions]] (proved in first approximation).": "Все корни движения на нём, кроме нулевых (числом [[zeros]]), имеют отрицательные вещественные части при всех достаточно малых [[small]] $> 0$, если [[conditions]] (доказано в первом приближении).",
    "Of the flow on it, not all roots but [[zeros]] that are zero have negative real parts for sufficiently small [[small]] > 0 (proved in first approximation).": "Не все корни движения на нём, кроме нулевых (числом [[zeros]]), имеют отрицательные вещественные части при достаточно малых [[small]] $> 0$ (доказано в первом приближении).",
    "Whether the roots of the flow on it have negative real parts is undecided: a Hurwitz minor vanishes to the order of the expansion, or has no sign.": "Имеют ли корни движения на нём отрицательные вещественные части, не выяснено: один из миноров Гурвица равен нулю в пределах порядка разложения или не имеет определённого знака.",
    "[[name]] is multiplied by the power [[power]] of [[small]].": "[[name]] умножается на степень [[power]] параметра [[small]].",
    "Put into the equations at a random rational state, it leaves terms of order [[left]] (verified).": "После подстановки в уравнения в случайном рациональном состоянии остаются члены порядка [[left]] (проверено).",
    "Put into the equations at a random rational state, it leaves nothing (verified).": "После подстановки в уравнения в случайном рациональном состоянии не остаётся ничего (проверено).",
    "It holds where these are not zero, which were divided by: [[provided]].": "Оно верно там, где отличны от нуля выражения, на которые производилось деление: [[provided]].",
    "Nothing is said of stability: [[missing]].": "Об устойчивости ничего не сообщается: [[missing]].",
    "The characteristic polynomial of all variables is divided by that of the flow without a remainder up to order [[known]] (verified).": "Характеристический многочлен всех переменных делится на многочлен движения на многообразии без остатка до порядка [[known]] (проверено).",
    "By the reduction principle (Strygin and Sobolev) a steady state on an attracting slow manifold is stable, asymptotically stable or unstable as it is in the flow on it. How small [[small]] has to be is not known from this: at given values problem 6 decides.": "По принципу сведения (Стрыгин, Соболев) стационарное движение на притягивающем медленном многообразии устойчиво, асимптотически устойчиво или неустойчиво так же, как и для движения на нём. Насколько мал должен быть [[small]], отсюда не известно: при заданных значениях решает задача 6.",
    "The error of the flow was not measured: [[why]].": "Погрешность движения на многообразии не измерена: [[why]].",
    "Measured against a simulation of all equations over a time of [[time]]: the distance of the slow variables is no larger than the errors of the integrations.": "Измерено в сравнении с численным интегрированием всех уравнений за время [[time]]: расстояние между медленными переменными не больше погрешностей интегрирования.",
    "Measured against a simulation of all equations over a time of [[time]], both from the manifold: the largest distance of the slow variables, as a part of their size, is [[distances]] at the given [[small]], a half and a quarter of it.": "Измерено в сравнении с численным интегрированием всех уравнений за время [[time]], оба движения начинаются на многообразии: наибольшее расстояние между медленными переменными, как доля их величины, равно [[distances]] при заданном [[small]], при половине и при четверти его.",
    "It shrinks like the power [[orders]] of [[small]]; [[expected]] is expected where [[small]] is small enough.": "Оно убывает как степень [[orders]] параметра [[small]]; при достаточно малом [[small]] ожидается [[expected]].",
    "Averaging over [[phase]] gives nothing: [[why]].": "Усреднение по [[phase]] ничего не даёт: [[why]].",
    "Averaged over the phase [[phase]] with the rate [[rate]], taken as of order 1/epsilon, and [[lengths]] as of order epsilon: for times of order 1 the motion stays within order epsilon of one in the effective potential below (averaging theorem).": "Усреднено по фазе [[phase]] со скоростью [[rate]] порядка $1/\\epsilon$ при [[lengths]] порядка $\\epsilon$: за времена порядка 1 движение отличается на величину порядка $\\epsilon$ от движения с эффективным потенциалом, указанным ниже (теорема об усреднении).",
    "What the shaking adds: [[formula]].": "Вклад вибрации: [[formula]].",
    "Effective potential: [[formula]].": "Эффективный потенциал: [[formula]].",
    "Of the stability of the averaged motion there is no result: [[why]].": "Об устойчивости усреднённого движения результата нет: [[why]].",
    "The averaged motion is there where [[conditions]].": "Усреднённое движение существует, если [[conditions]].",
    "The averaged motion, not the motion itself, by problem 6: [[names]]: [[word]].": "Усреднённое движение (не само движение) по задаче 6: [[names]]: [[word]].",
    "What problem 6 asks of the parameters: [[conditions]].": "Условия задачи 6 на параметры: [[conditions]].",
    "Further conditions are not written out here.": "Другие условия здесь не выписаны.",
    "At the given values: [[word]].": "При заданных значениях: [[word]].",
    "The distance to the averaged motion was not measured: [[why]].": "Расстояние до усреднённого движения не измерено: [[why]].",
    "Measured over a time of [[time]]: the largest distance of the motion from the averaged one, as a part of its size, is [[distances]] at the given values, and with epsilon a half and a quarter of it.": "Измерено за время [[time]]: наибольшее расстояние движения от усреднённого, как доля его величины, равно [[distances]] при заданных значениях, при половине и при четверти $\\epsilon$.",
    "It shrinks like the power [[orders]] of epsilon; 1 is expected where epsilon is small enough.": "Оно убывает как степень [[orders]] параметра $\\epsilon$; при достаточно малом $\\epsilon$ ожидается 1.",
    "No slow manifold was found in powers of [[small]]: [[why]].": "Медленное многообразие по степеням [[small]] не найдено: [[why]].",
}

WORDS = {
    "small parameters": "малые параметры",
    "a condition too long to be written out": "условие, слишком длинное, чтобы его выписать",
    "a denominator vanishes at the given numbers": "знаменатель обращается в нуль при заданных числах",
    "the description does not give all numbers and an initial state": "в описании даны не все числа и не всё начальное состояние",
}
