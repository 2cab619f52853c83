"""Russian sentences of periodic solutions in powers of a small parameter."""

# ruff: noqa: E501

SENTENCES = {
    "Periodic solution up to order [[order]] of [[small]], led by [[leading]]": "Периодическое решение до порядка [[order]] по [[small]], ведущая переменная [[leading]]",
    "The rate of the phase": "Скорость фазы",
    "Variables that no equation needs, but for their initial values": "Переменные, не входящие в уравнения, без их начальных значений",
    "[[names]]: the values of [[variables]] at the phase 0, which are constant where [[small]] = 0.": "[[names]]: значения [[variables]] при фазе 0; при [[small]] = 0 эти переменные постоянны.",
    "Put into the equations at random rational parameters, it leaves terms of order [[left]] of [[small]] (verified).": "При подстановке в уравнения со случайными рациональными параметрами остаются члены порядка [[left]] по [[small]] (проверено).",
    "Put into the equations at random rational parameters, it leaves nothing (verified).": "При подстановке в уравнения со случайными рациональными параметрами ничего не остаётся (проверено).",
    "Of the equations, terms up to degree [[degree]] in the deviations were taken; the others are of higher order.": "В уравнениях взяты члены до степени [[degree]] по отклонениям; остальные --- более высокого порядка.",
    "Whether some remain in higher orders, so that there is no such periodic motion, is not looked at: it is periodic up to this order.": "Остаются ли они в более высоких порядках, так что такого периодического движения нет, не исследовано: решение периодично до этого порядка.",
    "Other amplitudes are left out, at which they are removed, too: those of [[condition]], where real.": "Другие амплитуды, при которых вековые члены тоже устраняются, не рассматриваются: это вещественные корни уравнения [[condition]].",
    "Put into the equations cut off so, at random rational parameters, it leaves terms of order [[left]] of [[small]] (verified).": "При подстановке в уравнения, обрезанные таким образом, со случайными рациональными параметрами остаются члены порядка [[left]] по [[small]] (проверено).",
    "Put into the equations cut off so, at random rational parameters, it leaves nothing (verified); of those that are not cut off it may leave terms of order [[next]] of [[small]].": "При подстановке в уравнения, обрезанные таким образом, со случайными рациональными параметрами ничего не остаётся (проверено); в необрезанных могут остаться члены порядка [[next]] по [[small]].",
    "Free oscillations of [[names]], whose frequency has the square [[square]], are left out.": "Свободные колебания [[names]] с квадратом частоты [[square]] не рассматриваются.",
    "Without [[small]], roots of [[names]] are not all imaginary: free motions that belong to the others are left out.": "При [[small]] = 0 не все корни для [[names]] чисто мнимые: свободные движения, отвечающие остальным, не рассматриваются.",
    "Without [[small]], [[names]] have the root zero: free displacements and drifts that belong to it are left out.": "При [[small]] = 0 у [[names]] есть нулевой корень: отвечающие ему свободные смещения и уходы не рассматриваются.",
    "Without [[small]], not all roots of [[names]] were found: free motions that belong to the others are left out.": "При [[small]] = 0 найдены не все корни для [[names]]: свободные движения, отвечающие остальным, не рассматриваются.",
    "Resonance, and in general no such solution, where [[condition]] and [[other]] (harmonic [[harmonic]], order [[order]], of [[names]]).": "Резонанс, при котором такого решения, вообще говоря, нет, --- там, где [[condition]] и [[other]] (гармоника [[harmonic]], порядок [[order]], переменные [[names]]).",
    "The errors of [[names]] fall more slowly than expected: [[small]] is too large there, or something is wrong.": "Погрешности [[names]] убывают медленнее ожидаемого: [[small]] там слишком велико или есть ошибка.",
    "Periodic solution up to order [[order]] of [[small]], led by [[leading]]: all variables as functions of [[phase]], and the rate of it. The coefficient of the power k of [[small]] has the index (k).": "Периодическое решение до порядка [[order]] по [[small]], ведущая переменная [[leading]]: все переменные как функции от [[phase]] и скорость этой фазы. Коэффициент при степени k параметра [[small]] обозначен верхним индексом (k).",
    "Secular terms are removed up to this order with any amplitude. Here it is [[amplitude]], the value of [[leading]] at the phase 0, where it has no term [[sine]].": "Вековые члены устранены до этого порядка при любой амплитуде. Здесь она равна [[amplitude]], это значение [[leading]] при фазе 0, где члена [[sine]] нет.",
    "Secular terms are removed for certain amplitudes only. That of this solution: in first approximation [[leading]] is [[value]].": "Вековые члены устраняются только при некоторых амплитудах. Для этого решения в первом приближении [[leading]] равно [[value]].",
    "The amplitude is real and not zero where [[condition]].": "Амплитуда вещественна и отлична от нуля там, где [[condition]].",
    "The frequency without [[small]] is real and not zero where [[condition]].": "Частота при [[small]] = 0 вещественна и отлична от нуля там, где [[condition]].",
    "It holds where the frequency without [[small]] is not zero: [[condition]].": "Верно там, где частота при [[small]] = 0 отлична от нуля: [[condition]].",
    "Resonance, and in general no such solution, where [[condition]] (harmonic [[harmonic]], order [[order]], of [[names]]).": "Резонанс, при котором такого решения, вообще говоря, нет, --- там, где [[condition]] (гармоника [[harmonic]], порядок [[order]], переменные [[names]]).",
    "[[names]], on which no equation depends, follow by quadrature: see mbsym oscillations.": "[[names]], от которых не зависят уравнения, находятся квадратурой: см. mbsym oscillations.",
    "Measured at the given numbers, over one period, against motions that begin in the same state: with [[small]] halved from [[from]] to [[to]] the errors fall like its powers [[orders]] (not proved).": "Измерено при заданных числах на одном периоде в сравнении с движениями из того же состояния: при уменьшении [[small]] вдвое, с [[from]] до [[to]], погрешности убывают как его степени [[orders]] (не доказано).",
    "[[expected]] or more is expected of a right solution to this order, where [[small]] is small enough.": "От верного решения этого порядка ожидается [[expected]] или больше, если [[small]] достаточно мало.",
    "The error of the periodic solution was not measured: [[why]].": "Погрешность периодического решения не измерена: [[why]].",
    "No periodic solution was expanded in powers of [[small]]: [[why]].": "Периодическое решение по степеням [[small]] не разложено: [[why]].",
    "Periodic solutions in powers of [[small]] are looked for by mbsym oscillations.": "Периодические решения по степеням [[small]] ищет команда mbsym oscillations.",
    "[[system]]: series to order [[order]] at [[small]] = [[value]], and the motion": "[[system]]: ряды до порядка [[order]] при [[small]] = [[value]] и движение",
    "(no angles: [[why]])": "(без углов: [[why]])",
    "series": "ряд",
    "motion (simulation)": "движение (численно)",
}

#: Why no angles are drawn.
WORDS = {
    "quantities are prescribed": "есть заданные величины",
    "a speed is no variable of the series": "одна из квазискоростей не входит в ряды",
    "the angles become singular": "углы вырождаются",
}
