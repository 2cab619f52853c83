"""Russian sentences of problem 9."""

# ruff: noqa: E501

SENTENCES = {
    "Problem 9. Polynomial integrals": "Задача 9. Полиномиальные интегралы",
    "Polynomials up to weighted degree [[degree]] whose derivatives vanish by the equations of motion; weights of the variables: [[weights]].": "Многочлены взвешенной степени не выше [[degree]], производные которых равны нулю в силу уравнений движения; веса переменных: [[weights]].",
    "Weight [[weight]], [[name]]:": "Вес [[weight]], [[name]]:",
    "Weight [[weight]], where that of weight [[own]] ([[name]]) is zero:": "Вес [[weight]], на нулевом уровне интеграла веса [[own]] ([[name]]):",
    "There is none up to weighted degree [[degree]] (proved for almost all values of the parameters).": "До взвешенной степени [[degree]] таких нет (доказано для почти всех значений параметров).",
    "But for lengths of unit vectors, which are 1, there is none up to weighted degree [[degree]] (proved for almost all values of the parameters).": "Кроме длин единичных векторов, равных 1, до взвешенной степени [[degree]] таких нет (доказано при почти всех значениях параметров).",
    "But for lengths of unit vectors, which are 1, there is none up to weighted degree [[degree]] (proved).": "Кроме длин единичных векторов, равных 1, до взвешенной степени [[degree]] таких нет (доказано).",
    "There is none up to weighted degree [[degree]] (proved).": "До взвешенной степени [[degree]] таких нет (доказано).",
    "Every polynomial integral of weighted degree up to [[degree]] that does not contain [[names]] is a polynomial in these, for almost all values of the parameters (proved).": "Всякий полиномиальный интеграл взвешенной степени не выше [[degree]], не содержащий [[names]], есть многочлен от них при почти всех значениях параметров (доказано).",
    "Every polynomial integral of weighted degree up to [[degree]] that does not contain [[names]] is a polynomial in these (proved).": "Всякий полиномиальный интеграл взвешенной степени не выше [[degree]], не содержащий [[names]], есть многочлен от них (доказано).",
    "There is none up to weighted degree [[degree]] that does not contain [[names]] (proved for almost all values of the parameters).": "До взвешенной степени [[degree]] интегралов, не содержащих [[names]], нет (доказано для почти всех значений параметров).",
    "There is none up to weighted degree [[degree]] that does not contain [[names]] (proved).": "До взвешенной степени [[degree]] интегралов, не содержащих [[names]], нет (доказано).",
    "Up to weighted degree [[degree]] there is none without [[names]] beyond those of problem 7, for almost all values of the parameters.": "До взвешенной степени [[degree]] сверх интегралов задачи 7 нет интегралов без [[names]] при почти всех значениях параметров.",
    "Up to weighted degree [[degree]] there is none without [[names]] beyond those of problem 7.": "До взвешенной степени [[degree]] сверх интегралов задачи 7 нет интегралов без [[names]].",
    "None was found.": "Ничего не найдено.",
    "As functions at least [[count]] of them are independent (proved: rank of the gradients).": "Как функции независимы по меньшей мере [[count]] из них (доказано: ранг градиентов).",
    "Every polynomial integral of weighted degree up to [[degree]] is a polynomial in these, for almost all values of the parameters (proved).": "Всякий полиномиальный интеграл взвешенной степени не выше [[degree]] есть многочлен от них при почти всех значениях параметров (доказано).",
    "The equations do not contain [[names]]: integrals that do are not looked for here.": "Уравнения не содержат [[names]]: интегралы, которые их содержат, здесь не ищутся.",
    "Every polynomial integral of weighted degree up to [[degree]] is a polynomial in these (proved).": "Всякий полиномиальный интеграл взвешенной степени не выше [[degree]] есть многочлен от них (доказано).",
    "Lengths of unit vectors and products of two of them are the same in every motion: 1 and 0.": "Длины единичных векторов и произведения двух из них одни и те же во всяком движении: 1 и 0.",
    "Of weight [[weight]] there are at most [[more]] more; they were not found within the budget.": "Веса [[weight]] есть ещё не более [[more]]; в пределах бюджета они не найдены.",
    "Up to weighted degree [[degree]] there is none beyond those of problem 7, for almost all values of the parameters.": "До взвешенной степени [[degree]] сверх интегралов задачи 7 их нет при почти всех значениях параметров.",
    "Up to weighted degree [[degree]] there is none beyond those of problem 7.": "До взвешенной степени [[degree]] сверх интегралов задачи 7 их нет.",
    "That of weight [[weight]] ([[name]]) depends on those before it as a function (proved: no more can be).": "Интеграл веса [[weight]] ([[name]]) как функция зависит от предыдущих (доказано: больше независимых быть не может).",
    "That of weight [[weight]] ([[name]]) depends on those before it as a function (verified at a random state).": "Интеграл веса [[weight]] ([[name]]) как функция зависит от предыдущих (проверено в случайном состоянии).",
    "Whether that of weight [[weight]] ([[name]]) is independent of those before it is undecided.": "Независим ли интеграл веса [[weight]] ([[name]]) от предыдущих, не выяснено.",
}

WORDS = {
    "function of the integrals of problem 7": "функция интегралов задачи 7",
    "further integral": "новый интеграл",
    "polynomial integrals": "полиномиальные интегралы",
}
