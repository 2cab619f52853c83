"""Spanish sentences of problem 9."""

# ruff: noqa: E501

SENTENCES = {
    "Problem 9. Polynomial integrals": "Problema 9. Integrales polinómicas",
    "Polynomials up to weighted degree [[degree]] whose derivatives vanish by the equations of motion; weights of the variables: [[weights]].": "Polinomios de grado ponderado hasta [[degree]] cuyas derivadas se anulan por las ecuaciones del movimiento; pesos de las variables: [[weights]].",
    "Weight [[weight]], [[name]]:": "Peso [[weight]], [[name]]:",
    "Weight [[weight]], where that of weight [[own]] ([[name]]) is zero:": "Peso [[weight]], donde la de peso [[own]] ([[name]]) es cero:",
    "There is none up to weighted degree [[degree]] (proved for almost all values of the parameters).": "Hasta el grado ponderado [[degree]] no hay ninguna (demostrado para casi todos los valores de los parámetros).",
    "But for lengths of unit vectors, which are 1, there is none up to weighted degree [[degree]] (proved for almost all values of the parameters).": "Salvo las longitudes de vectores unitarios, que son 1, hasta el grado ponderado [[degree]] no hay ninguna (demostrado para casi todos los valores de los parámetros).",
    "But for lengths of unit vectors, which are 1, there is none up to weighted degree [[degree]] (proved).": "Salvo las longitudes de vectores unitarios, que son 1, hasta el grado ponderado [[degree]] no hay ninguna (demostrado).",
    "There is none up to weighted degree [[degree]] (proved).": "Hasta el grado ponderado [[degree]] no hay ninguna (demostrado).",
    "Every polynomial integral of weighted degree up to [[degree]] that does not contain [[names]] is a polynomial in these, for almost all values of the parameters (proved).": "Toda integral polinómica de grado ponderado hasta [[degree]] que no contiene [[names]] es un polinomio en estas, para casi todos los valores de los parámetros (demostrado).",
    "Every polynomial integral of weighted degree up to [[degree]] that does not contain [[names]] is a polynomial in these (proved).": "Toda integral polinómica de grado ponderado hasta [[degree]] que no contiene [[names]] es un polinomio en estas (demostrado).",
    "There is none up to weighted degree [[degree]] that does not contain [[names]] (proved for almost all values of the parameters).": "No hay ninguna hasta el grado ponderado [[degree]] que no contenga [[names]] (demostrado para casi todos los valores de los parámetros).",
    "There is none up to weighted degree [[degree]] that does not contain [[names]] (proved).": "No hay ninguna hasta el grado ponderado [[degree]] que no contenga [[names]] (demostrado).",
    "Up to weighted degree [[degree]] there is none without [[names]] beyond those of problem 7, for almost all values of the parameters.": "Hasta el grado ponderado [[degree]] no hay ninguna sin [[names]] aparte de las del problema 7, para casi todos los valores de los parámetros.",
    "Up to weighted degree [[degree]] there is none without [[names]] beyond those of problem 7.": "Hasta el grado ponderado [[degree]] no hay ninguna sin [[names]] aparte de las del problema 7.",
    "None was found.": "No se encontró ninguna.",
    "As functions at least [[count]] of them are independent (proved: rank of the gradients).": "Como funciones son independientes al menos [[count]] de ellas (demostrado: rango de los gradientes).",
    "Every polynomial integral of weighted degree up to [[degree]] is a polynomial in these, for almost all values of the parameters (proved).": "Toda integral polinómica de grado ponderado hasta [[degree]] es un polinomio en ellas, para casi todos los valores de los parámetros (demostrado).",
    "The equations do not contain [[names]]: integrals that do are not looked for here.": "Las ecuaciones no contienen [[names]]: las integrales que sí los contienen no se buscan aquí.",
    "Every polynomial integral of weighted degree up to [[degree]] is a polynomial in these (proved).": "Toda integral polinómica de grado ponderado hasta [[degree]] es un polinomio en ellas (demostrado).",
    "Lengths of unit vectors and products of two of them are the same in every motion: 1 and 0.": "Las longitudes de los vectores unitarios y los productos de dos de ellos son los mismos en todo movimiento: 1 y 0.",
    "Of weight [[weight]] there are at most [[more]] more; they were not found within the budget.": "De peso [[weight]] hay como mucho [[more]] más; no se encontraron dentro del presupuesto.",
    "Up to weighted degree [[degree]] there is none beyond those of problem 7, for almost all values of the parameters.": "Hasta el grado ponderado [[degree]] no hay ninguna además de las del problema 7, para casi todos los valores de los parámetros.",
    "Up to weighted degree [[degree]] there is none beyond those of problem 7.": "Hasta el grado ponderado [[degree]] no hay ninguna además de las del problema 7.",
    "That of weight [[weight]] ([[name]]) depends on those before it as a function (proved: no more can be).": "La de peso [[weight]] ([[name]]) depende de las anteriores como función (demostrado: no puede haber más).",
    "That of weight [[weight]] ([[name]]) depends on those before it as a function (verified at a random state).": "La de peso [[weight]] ([[name]]) depende de las anteriores como función (verificado en un estado al azar).",
    "Whether that of weight [[weight]] ([[name]]) is independent of those before it is undecided.": "No está decidido si la de peso [[weight]] ([[name]]) es independiente de las anteriores.",
}

WORDS = {
    "function of the integrals of problem 7": "función de las integrales del problema 7",
    "further integral": "integral nueva",
    "polynomial integrals": "integrales polinomiales",
}
