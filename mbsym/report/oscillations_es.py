"""Spanish sentences of periodic solutions in powers of a small parameter."""

# ruff: noqa: E501

SENTENCES = {
    "Periodic solution up to order [[order]] of [[small]], led by [[leading]]": "Solución periódica hasta el orden [[order]] de [[small]], variable principal [[leading]]",
    "The rate of the phase": "Velocidad de la fase",
    "Variables that no equation needs, but for their initial values": "Variables que ninguna ecuación contiene, salvo sus valores iniciales",
    "Secular terms are removed up to this order with any [[amplitude]]: the value of [[leading]] at the phase 0, where it has no term sin([[phase]]).": "Los términos seculares se eliminan hasta este orden con cualquier [[amplitude]]: es el valor de [[leading]] en la fase 0; [[leading]] no tiene término sin([[phase]]).",
    "Secular terms are removed for one amplitude only: in first approximation [[leading]] is [[value]]*cos([[phase]]).": "Los términos seculares se eliminan solo con una amplitud: en primera aproximación [[leading]] es [[value]]*cos([[phase]]).",
    "[[names]]: the values of [[variables]] at the phase 0, which are constant where [[small]] = 0.": "[[names]]: los valores de [[variables]] en la fase 0; estas variables son constantes con [[small]] = 0.",
    "Put into the equations at random rational parameters, it leaves terms of order [[left]] of [[small]] (verified).": "Sustituida en las ecuaciones con parámetros racionales al azar, deja términos de orden [[left]] de [[small]] (verificado).",
    "Put into the equations at random rational parameters, it leaves nothing (verified).": "Sustituida en las ecuaciones con parámetros racionales al azar, no deja nada (verificado).",
    "Of the equations, terms up to degree [[degree]] in the deviations were taken; the others are of higher order.": "De las ecuaciones se tomaron los términos hasta el grado [[degree]] en las desviaciones; los demás son de orden superior.",
    "The frequency without [[small]] is real and not zero where [[square]] > 0.": "La frecuencia con [[small]] = 0 es real y no nula donde [[square]] > 0.",
    "It holds where the frequency without [[small]] is not zero: [[frequency]] != 0.": "Vale donde la frecuencia con [[small]] = 0 no es cero: [[frequency]] != 0.",
    "Resonance, and in general no such solution, where one of these vanishes: [[divisors]].": "Resonancia, y en general ninguna solución así, donde se anula una de estas expresiones: [[divisors]].",
    "[[value]] (harmonic [[harmonic]], order [[order]], [[names]])": "[[value]] (armónico [[harmonic]], orden [[order]], [[names]])",
    "Free oscillations of [[names]], whose frequency has the square [[square]], are left out.": "Se dejan fuera las oscilaciones libres de [[names]], cuya frecuencia tiene el cuadrado [[square]].",
    "Without [[small]], roots of [[names]] are not all imaginary: only what is forced of them is here.": "Con [[small]] = 0 no todas las raíces de [[names]] son imaginarias: aquí está solo su movimiento forzado.",
    "Measured at the numbers of the description, over one period, against motions that begin in the same state: with [[small]] halved from [[from]] to [[to]] the errors fall by 2^k, k = [[orders]] (not proved).": "Medido con los números de la descripción, durante un período, frente a movimientos que empiezan en el mismo estado: al reducir [[small]] a la mitad, de [[from]] a [[to]], los errores disminuyen en 2^k, k = [[orders]] (no demostrado).",
    "k = [[expected]] or more is expected of a right solution to this order, where [[small]] is small enough.": "De una solución correcta a este orden se espera k = [[expected]] o más, si [[small]] es bastante pequeño.",
    "The errors of [[names]] fall more slowly than expected: [[small]] is too large there, or something is wrong.": "Los errores de [[names]] disminuyen más despacio de lo esperado: [[small]] es allí demasiado grande, o algo está mal.",
}
