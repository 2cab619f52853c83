"""The words of maps in other languages; those of verdicts are the ones of every report."""

from __future__ import annotations

from mbsym.report.language import Language

_RUSSIAN = {
    "divergence": "дивергенция",
    "flutter": "флаттер",
    "divergence and flutter": "дивергенция и флаттер",
    "zero root: constant term": "нулевой корень: свободный член",
    "imaginary roots: Hurwitz minor": "мнимые корни: минор Гурвица",
    "double root: discriminant": "кратный корень: дискриминант",
    "real roots meet: discriminant": "вещественные корни сливаются: дискриминант",
    "common root: resultant": "общий корень: результант",
    "det K = 0": "det K = 0",
    "det M = 0": "det M = 0",
    "leading coefficient": "старший коэффициент",
    "det D = 0": "det D = 0",
    "no damping: D = 0": "нет демпфирования: D = 0",
    "no circulatory forces: N = 0": "нет циркулярных сил: N = 0",
    "no gyroscopic forces: G = 0": "нет гироскопических сил: G = 0",
    "cyclic coordinates set free": "циклические координаты свободны",
    "sign that the energy depends on": "знак, от которого зависит энергия",
    "assumption": "предположение",
    "declared sign": "объявленный знак",
    "triangle inequality": "неравенство треугольника",
    "division by zero": "деление на нуль",
    "not admissible": "недопустимо",
    "kinetic energy not positive definite": "кинетическая энергия не положительно определена",
    "formulas divide by zero": "деление на нуль в формулах",
    "too large to be decided": "слишком велико для решения",
    "withdrawn: the check failed": "отозвано: проверка не прошла",
    "not reached": "не рассмотрено",
    "degree of instability": "степень неустойчивости",
    "null directions": "нулевых направлений",
    "number of roots with positive real part": "число корней с положительной вещественной частью",
    "dashed: another verdict on the curve alone": "штрих: иной вывод только на кривой",
    "but for single values not looked at": "кроме отдельных нерассмотренных значений",
    "Stability of": "Устойчивость:",
    "Degree of instability of": "Степень неустойчивости:",
    "The curves of the map:": "Кривые карты:",
    "The points of the map:": "Точки карты:",
    "degrees": "степени",
    "in": "по",
    "terms": "членов",
}

_SPANISH = {
    "divergence": "divergencia",
    "flutter": "flameo",
    "divergence and flutter": "divergencia y flameo",
    "zero root: constant term": "raíz nula: término independiente",
    "imaginary roots: Hurwitz minor": "raíces imaginarias: menor de Hurwitz",
    "double root: discriminant": "raíz doble: discriminante",
    "real roots meet: discriminant": "raíces reales se juntan: discriminante",
    "common root: resultant": "raíz común: resultante",
    "det K = 0": "det K = 0",
    "det M = 0": "det M = 0",
    "leading coefficient": "coeficiente principal",
    "det D = 0": "det D = 0",
    "no damping: D = 0": "sin amortiguamiento: D = 0",
    "no circulatory forces: N = 0": "sin fuerzas circulatorias: N = 0",
    "no gyroscopic forces: G = 0": "sin fuerzas giroscópicas: G = 0",
    "cyclic coordinates set free": "coordenadas cíclicas liberadas",
    "sign that the energy depends on": "signo del que depende la energía",
    "assumption": "hipótesis",
    "declared sign": "signo declarado",
    "triangle inequality": "desigualdad triangular",
    "division by zero": "división por cero",
    "not admissible": "no admisible",
    "kinetic energy not positive definite": "energía cinética no definida positiva",
    "formulas divide by zero": "las fórmulas dividen por cero",
    "too large to be decided": "demasiado grande para decidirse",
    "withdrawn: the check failed": "retirado: la comprobación falló",
    "not reached": "no alcanzado",
    "degree of instability": "grado de inestabilidad",
    "null directions": "direcciones nulas",
    "number of roots with positive real part": "número de raíces con parte real positiva",
    "dashed: another verdict on the curve alone": "a trazos: otro veredicto solo en la curva",
    "but for single values not looked at": "salvo valores aislados que no se examinaron",
    "Stability of": "Estabilidad de",
    "Degree of instability of": "Grado de inestabilidad de",
    "The curves of the map:": "Las curvas del mapa:",
    "The points of the map:": "Los puntos del mapa:",
    "degrees": "grados",
    "in": "en",
    "terms": "términos",
}

WORDS = {"ru": _RUSSIAN, "es": _SPANISH}


def say(language: Language, english: str) -> str:
    """A word of a map, or of a verdict, in a language."""
    known = WORDS.get(language.name, {})
    return known[english] if english in known else language.say(english)
