"""Russian sentences of symmetries."""

# ruff: noqa: E501

SENTENCES = {
    "Symmetries (Noether) with fields of degree one in the positions and Gamma of degree two, both free of the time:": "Симметрии (Нётер) с полями первой степени по положениям и Gamma второй степени, не зависящими от времени:",
    "The field [[field]] gives an integral that is known ([[name]]).": "Поле [[field]] даёт известный интеграл ([[name]]).",
    "The field [[field]] gives no further integral ([[name]]; verified at a random state).": "Поле [[field]] нового интеграла не даёт ([[name]]; проверено в случайном состоянии).",
    "The field [[field]] gives a further integral, no function of those known without it (proved):": "Поле [[field]] даёт новый интеграл, не функцию интегралов, известных без него (доказано):",
    "The field [[field]] gives an integral of which it is undecided whether it is a function of those of problem 7:": "Поле [[field]] даёт интеграл, о котором не выяснено, есть ли он функция интегралов задачи 7:",
    "None was found; that there is none is not proved.": "Ничего не найдено; что таких нет, не доказано.",
    "Each of them is an identity of the exact ring (proved).": "Каждая есть тождество точного кольца (доказано).",
    "That there are no others is not proved.": "Что других нет, не доказано.",
    "There is none of this kind (proved: rank of the conditions on [[unknowns]] constants at exact states).": "Таких симметрий нет (доказано: ранг условий на постоянные, числом [[unknowns]], в точных состояниях).",
    "There is none of this kind, for almost all values of the parameters (proved: rank of the conditions on [[unknowns]] constants at exact states).": "Таких симметрий нет при почти всех значениях параметров (доказано: ранг условий на постоянные, числом [[unknowns]], в точных состояниях).",
    "There is none of this kind (proved: the conditions on [[unknowns]] constants, compared in independent functions).": "Таких симметрий нет (доказано: условия на постоянные, числом [[unknowns]], сравнены по независимым функциям).",
    "There is none of this kind, for almost all values of the parameters (proved: the conditions on [[unknowns]] constants, compared in independent functions).": "Таких симметрий нет при почти всех значениях параметров (доказано: условия на постоянные, числом [[unknowns]], сравнены по независимым функциям).",
    "Every other of this kind is a combination of these with constant coefficients (proved: rank of the conditions on [[unknowns]] constants at exact states).": "Всякая другая такая симметрия есть их комбинация с постоянными коэффициентами (доказано: ранг условий на постоянные, числом [[unknowns]], в точных состояниях).",
    "Every other of this kind is a combination of these with constant coefficients, for almost all values of the parameters (proved: rank of the conditions on [[unknowns]] constants at exact states).": "Всякая другая такая симметрия есть их комбинация с постоянными коэффициентами при почти всех значениях параметров (доказано: ранг условий на постоянные, числом [[unknowns]], в точных состояниях).",
    "Every other of this kind is a combination of these with constant coefficients (proved: the conditions on [[unknowns]] constants, compared in independent functions).": "Всякая другая такая симметрия есть их комбинация с постоянными коэффициентами (доказано: условия на постоянные, числом [[unknowns]], сравнены по независимым функциям).",
    "Every other of this kind is a combination of these with constant coefficients, for almost all values of the parameters (proved: the conditions on [[unknowns]] constants, compared in independent functions).": "Всякая другая такая симметрия есть их комбинация с постоянными коэффициентами при почти всех значениях параметров (доказано: условия на постоянные, числом [[unknowns]], сравнены по независимым функциям).",
}

WORDS = {"function of those before it": "функция предыдущих"}
