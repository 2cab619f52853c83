"""Spanish sentences of problem 12."""

# ruff: noqa: E501

SENTENCES = {
    "Problem 12. Small parameters": "Problema 12. Parámetros pequeños",
    "Slow integral manifold up to order [[order]] of [[small]]: the fast variables [[fast]] as functions of the slow ones [[slow]], and the flow on it. The coefficient of the power k of [[small]] has the index (k).": "Variedad integral lenta hasta el orden [[order]] de [[small]]: las variables rápidas [[fast]] como funciones de las lentas [[slow]], y el flujo en ella. El coeficiente de la potencia k de [[small]] lleva el índice (k).",
    "The description names no small parameter, and no prescribed quantity has a parameter as its rate: nothing is expanded.": "La descripción no nombra ningún parámetro pequeño, y ninguna cantidad prescrita tiene un parámetro como velocidad: no hay nada que desarrollar.",
    "The manifold attracts near this motion for all sufficiently small [[small]] > 0 (proved: Hurwitz's minors of the fast roots, by their first coefficients).": "La variedad atrae cerca de este movimiento para todo [[small]] $> 0$ suficientemente pequeño (demostrado: menores de Hurwitz de las raíces rápidas, por sus primeros coeficientes).",
    "The manifold attracts near this motion for all sufficiently small [[small]] > 0 where [[conditions]] (proved: Hurwitz's minors of the fast roots, by their first coefficients).": "La variedad atrae cerca de este movimiento para todo [[small]] $> 0$ suficientemente pequeño si [[conditions]] (demostrado: menores de Hurwitz de las raíces rápidas, por sus primeros coeficientes).",
    "The manifold does not attract near this motion for any sufficiently small [[small]] > 0 (proved: a Hurwitz minor of the fast roots is negative).": "La variedad no atrae cerca de este movimiento para ningún [[small]] $> 0$ suficientemente pequeño (demostrado: un menor de Hurwitz de las raíces rápidas es negativo).",
    "Whether the manifold attracts near this motion is undecided: a Hurwitz minor of the fast roots vanishes to the order of the expansion, or has no sign.": "No está decidido si la variedad atrae cerca de este movimiento: un menor de Hurwitz de las raíces rápidas se anula hasta el orden del desarrollo, o no tiene signo.",
    "All roots of the flow on it but [[zeros]] that are zero have negative real parts for all sufficiently small [[small]] > 0 (proved in first approximation).": "Todas las raíces del flujo en ella, salvo [[zeros]] que son nulas, tienen parte real negativa para todo [[small]] $> 0$ suficientemente pequeño (demostrado en primera aproximación).",
    "All roots of the flow on it but [[zeros]] that are zero have negative real parts for all sufficiently small [[small]] > 0 where [[conditions]] (proved in first approximation).": "Todas las raíces del flujo en ella, salvo [[zeros]] que son nulas, tienen parte real negativa para todo [[small]] $> 0$ suficientemente pequeño si [[conditions]] (demostrado en primera aproximación).",
    "Of the flow on it, not all roots but [[zeros]] that are zero have negative real parts for sufficiently small [[small]] > 0 (proved in first approximation).": "No todas las raíces del flujo en ella, salvo [[zeros]] que son nulas, tienen parte real negativa para [[small]] $> 0$ suficientemente pequeño (demostrado en primera aproximación).",
    "Whether the roots of the flow on it have negative real parts is undecided: a Hurwitz minor vanishes to the order of the expansion, or has no sign.": "No está decidido si las raíces del flujo en ella tienen parte real negativa: un menor de Hurwitz se anula hasta el orden del desarrollo, o no tiene signo.",
    "[[name]] is multiplied by the power [[power]] of [[small]].": "[[name]] se multiplica por la potencia [[power]] de [[small]].",
    "Put into the equations at a random rational state, it leaves terms of order [[left]] (verified).": "Al sustituirla en las ecuaciones en un estado racional al azar, quedan términos de orden [[left]] (verificado).",
    "Put into the equations at a random rational state, it leaves nothing (verified).": "Al sustituirla en las ecuaciones en un estado racional al azar, no queda nada (verificado).",
    "It holds where these are not zero, which were divided by: [[provided]].": "Vale donde no se anulan las expresiones por las que se dividió: [[provided]].",
    "Nothing is said of stability: [[missing]].": "No se dice nada de la estabilidad: [[missing]].",
    "The characteristic polynomial of all variables is divided by that of the flow without a remainder up to order [[known]] (verified).": "El polinomio característico de todas las variables es divisible por el del flujo, sin resto hasta el orden [[known]] (verificado).",
    "By the reduction principle (Strygin and Sobolev) a steady state on an attracting slow manifold is stable, asymptotically stable or unstable as it is in the flow on it. How small [[small]] has to be is not known from this: at given values problem 6 decides.": "Por el principio de reducción (Strygin y Sobolev) un estado estacionario en una variedad lenta que atrae es estable, asintóticamente estable o inestable tal como lo es en el flujo sobre ella. De aquí no se sabe cuán pequeño debe ser [[small]]: con los valores dados decide el problema 6.",
    "The error of the flow was not measured: [[why]].": "El error del flujo no se midió: [[why]].",
    "Measured against a simulation of all equations over a time of [[time]]: the distance of the slow variables is no larger than the errors of the integrations.": "Medido frente a una simulación de todas las ecuaciones durante un tiempo de [[time]]: la distancia de las variables lentas no supera los errores de las integraciones.",
    "Measured against a simulation of all equations over a time of [[time]], both from the manifold: the largest distance of the slow variables, as a part of their size, is [[distances]] at the given [[small]], a half and a quarter of it.": "Medido frente a una simulación de todas las ecuaciones durante un tiempo de [[time]], ambas desde la variedad: la mayor distancia de las variables lentas, como parte de su tamaño, es [[distances]] con el [[small]] dado, con la mitad y con la cuarta parte.",
    "It shrinks like the power [[orders]] of [[small]]; [[expected]] is expected where [[small]] is small enough.": "Disminuye como la potencia [[orders]] de [[small]]; se espera [[expected]] cuando [[small]] es bastante pequeño.",
    "Averaging over [[phase]] gives nothing: [[why]].": "El promedio sobre [[phase]] no da nada: [[why]].",
    "Averaged over the phase [[phase]] with the rate [[rate]], taken as of order 1/epsilon, and [[lengths]] as of order epsilon: for times of order 1 the motion stays within order epsilon of one in the effective potential below (averaging theorem).": "Promediado sobre la fase [[phase]] con la velocidad [[rate]], tomada de orden $1/\\epsilon$, y [[lengths]] de orden $\\epsilon$: durante tiempos de orden 1 el movimiento queda a una distancia de orden $\\epsilon$ de uno en el potencial efectivo de abajo (teorema del promedio).",
    "What the shaking adds: [[formula]].": "Lo que añade la vibración: [[formula]].",
    "Effective potential: [[formula]].": "Potencial efectivo: [[formula]].",
    "Of the stability of the averaged motion there is no result: [[why]].": "De la estabilidad del movimiento promediado no hay resultado: [[why]].",
    "The averaged motion is there where [[conditions]].": "El movimiento promediado existe donde [[conditions]].",
    "The averaged motion, not the motion itself, by problem 6: [[names]]: [[word]].": "El movimiento promediado, no el movimiento mismo, por el problema 6: [[names]]: [[word]].",
    "What problem 6 asks of the parameters: [[conditions]].": "Lo que el problema 6 pide de los parámetros: [[conditions]].",
    "Further conditions are not written out here.": "Aquí no se escriben otras condiciones.",
    "At the given values: [[word]].": "Con los valores dados: [[word]].",
    "The distance to the averaged motion was not measured: [[why]].": "La distancia al movimiento promediado no se midió: [[why]].",
    "Measured over a time of [[time]]: the largest distance of the motion from the averaged one, as a part of its size, is [[distances]] at the given values, and with epsilon a half and a quarter of it.": "Medido durante un tiempo de [[time]]: la mayor distancia del movimiento al promediado, como parte de su tamaño, es [[distances]] con los valores dados, y con la mitad y la cuarta parte de $\\epsilon$.",
    "It shrinks like the power [[orders]] of epsilon; 1 is expected where epsilon is small enough.": "Disminuye como la potencia [[orders]] de $\\epsilon$; se espera 1 cuando $\\epsilon$ es bastante pequeño.",
    "No slow manifold was found in powers of [[small]]: [[why]].": "No se halló ninguna variedad lenta en potencias de [[small]]: [[why]].",
}

WORDS = {
    "small parameters": "parámetros pequeños",
    "a condition too long to be written out": "una condición demasiado larga para escribirla",
    "a denominator vanishes at the given numbers": "un denominador se anula con los números dados",
    "the description does not give all numbers and an initial state": "la descripción no da todos los números y un estado inicial",
}
