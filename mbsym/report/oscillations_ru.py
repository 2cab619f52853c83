"""Russian sentences of periodic solutions in powers of a small parameter."""

# ruff: noqa: E501

SENTENCES = {
    "Periodic solution up to order [[order]] of [[small]], led by [[leading]]": "Периодическое решение до порядка [[order]] по [[small]], ведущая переменная [[leading]]",
    "The rate of the phase": "Скорость фазы",
    "Variables that no equation needs, but for their initial values": "Переменные, не входящие в уравнения, без их начальных значений",
    "Secular terms are removed up to this order with any [[amplitude]]: the value of [[leading]] at the phase 0, where it has no term sin([[phase]]).": "Вековые члены устранены до этого порядка при любом [[amplitude]]: это значение [[leading]] при фазе 0; члена sin([[phase]]) в [[leading]] нет.",
    "Secular terms are removed for one amplitude only: in first approximation [[leading]] is [[value]]*cos([[phase]]).": "Вековые члены устраняются только при одной амплитуде: в первом приближении [[leading]] равно [[value]]*cos([[phase]]).",
    "[[names]]: the values of [[variables]] at the phase 0, which are constant where [[small]] = 0.": "[[names]]: значения [[variables]] при фазе 0; при [[small]] = 0 эти переменные постоянны.",
    "Put into the equations at random rational parameters, it leaves terms of order [[left]] of [[small]] (verified).": "При подстановке в уравнения со случайными рациональными параметрами остаются члены порядка [[left]] по [[small]] (проверено).",
    "Put into the equations at random rational parameters, it leaves nothing (verified).": "При подстановке в уравнения со случайными рациональными параметрами ничего не остаётся (проверено).",
    "Of the equations, terms up to degree [[degree]] in the deviations were taken; the others are of higher order.": "В уравнениях взяты члены до степени [[degree]] по отклонениям; остальные --- более высокого порядка.",
    "The frequency without [[small]] is real and not zero where [[square]] > 0.": "Частота при [[small]] = 0 вещественна и отлична от нуля там, где [[square]] > 0.",
    "It holds where the frequency without [[small]] is not zero: [[frequency]] != 0.": "Верно там, где частота при [[small]] = 0 отлична от нуля: [[frequency]] != 0.",
    "Resonance, and in general no such solution, where one of these vanishes: [[divisors]].": "Резонанс, при котором такого решения, вообще говоря, нет, --- там, где обращается в нуль одно из выражений: [[divisors]].",
    "[[value]] (harmonic [[harmonic]], order [[order]], [[names]])": "[[value]] (гармоника [[harmonic]], порядок [[order]], [[names]])",
    "Free oscillations of [[names]], whose frequency has the square [[square]], are left out.": "Свободные колебания [[names]] с квадратом частоты [[square]] не рассматриваются.",
    "Without [[small]], roots of [[names]] are not all imaginary: only what is forced of them is here.": "При [[small]] = 0 не все корни для [[names]] чисто мнимые: здесь только их вынужденное движение.",
    "Measured at the numbers of the description, over one period, against motions that begin in the same state: with [[small]] halved from [[from]] to [[to]] the errors fall by 2^k, k = [[orders]] (not proved).": "Измерено при числах описания на одном периоде в сравнении с движениями из того же состояния: при уменьшении [[small]] вдвое, с [[from]] до [[to]], погрешности уменьшаются в 2^k раз, k = [[orders]] (не доказано).",
    "k = [[expected]] or more is expected of a right solution to this order, where [[small]] is small enough.": "От верного решения этого порядка ожидается k = [[expected]] или больше, если [[small]] достаточно мало.",
    "The errors of [[names]] fall more slowly than expected: [[small]] is too large there, or something is wrong.": "Погрешности [[names]] убывают медленнее ожидаемого: [[small]] там слишком велико или есть ошибка.",
}
