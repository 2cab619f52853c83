"""Spanish sentences of periodic solutions in powers of a small parameter."""

# ruff: noqa: E501

SENTENCES = {
    "Periodic solution up to order [[order]] of [[small]], led by [[leading]]": "Solución periódica hasta el orden [[order]] de [[small]], variable principal [[leading]]",
    "The rate of the phase": "Velocidad de la fase",
    "Variables that no equation needs, but for their initial values": "Variables que ninguna ecuación contiene, salvo sus valores iniciales",
    "[[names]]: the values of [[variables]] at the phase 0, which are constant where [[small]] = 0.": "[[names]]: los valores de [[variables]] en la fase 0; estas variables son constantes con [[small]] = 0.",
    "Put into the equations at random rational parameters, it leaves terms of order [[left]] of [[small]] (verified).": "Sustituida en las ecuaciones con parámetros racionales al azar, deja términos de orden [[left]] de [[small]] (verificado).",
    "Put into the equations at random rational parameters, it leaves nothing (verified).": "Sustituida en las ecuaciones con parámetros racionales al azar, no deja nada (verificado).",
    "Of the equations, terms up to degree [[degree]] in the deviations were taken; the others are of higher order.": "De las ecuaciones se tomaron los términos hasta el grado [[degree]] en las desviaciones; los demás son de orden superior.",
    "Whether some remain in higher orders, so that there is no such periodic motion, is not looked at: it is periodic up to this order.": "Si quedan en órdenes superiores, de modo que no haya tal movimiento periódico, no se examina: la solución es periódica hasta este orden.",
    "Other amplitudes are left out, at which they are removed, too: those of [[condition]], where real.": "Se dejan fuera otras amplitudes con las que también se eliminan: las de [[condition]], donde son reales.",
    "Put into the equations cut off so, at random rational parameters, it leaves terms of order [[left]] of [[small]] (verified).": "Sustituida en las ecuaciones así cortadas, con parámetros racionales al azar, deja términos de orden [[left]] de [[small]] (verificado).",
    "Put into the equations cut off so, at random rational parameters, it leaves nothing (verified); of those that are not cut off it may leave terms of order [[next]] of [[small]].": "Sustituida en las ecuaciones así cortadas, con parámetros racionales al azar, no deja nada (verificado); en las no cortadas puede dejar términos de orden [[next]] de [[small]].",
    "Free oscillations of [[names]], whose frequency has the square [[square]], are left out.": "Se dejan fuera las oscilaciones libres de [[names]], cuya frecuencia tiene el cuadrado [[square]].",
    "Without [[small]], roots of [[names]] are not all imaginary: free motions that belong to the others are left out.": "Con [[small]] = 0 no todas las raíces de [[names]] son imaginarias: los movimientos libres que corresponden a las demás no se consideran.",
    "Without [[small]], [[names]] have the root zero: free displacements and drifts that belong to it are left out.": "Con [[small]] = 0 [[names]] tienen la raíz cero: los desplazamientos y derivas libres que le corresponden no se consideran.",
    "Without [[small]], not all roots of [[names]] were found: free motions that belong to the others are left out.": "Con [[small]] = 0 no se hallaron todas las raíces de [[names]]: los movimientos libres que corresponden a las demás no se consideran.",
    "The errors of [[names]] fall more slowly than expected: [[small]] is too large there, or something is wrong.": "Los errores de [[names]] disminuyen más despacio de lo esperado: [[small]] es allí demasiado grande, o algo está mal.",
    "Periodic solution up to order [[order]] of [[small]], led by [[leading]]: all variables as functions of [[phase]], and the rate of it. The coefficient of the power k of [[small]] has the index (k).": "Solución periódica hasta el orden [[order]] de [[small]], variable principal [[leading]]: todas las variables como funciones de [[phase]], y la velocidad de esta fase. El coeficiente de la potencia k de [[small]] lleva el índice (k).",
    "Secular terms are removed up to this order with any amplitude. Here it is [[amplitude]], the value of [[leading]] at the phase 0, where it has no term [[sine]].": "Los términos seculares se eliminan hasta este orden con cualquier amplitud. Aquí es [[amplitude]], el valor de [[leading]] en la fase 0, donde no tiene término [[sine]].",
    "Secular terms are removed for certain amplitudes only. That of this solution: in first approximation [[leading]] is [[value]].": "Los términos seculares se eliminan solo con ciertas amplitudes. La de esta solución: en primera aproximación [[leading]] es [[value]].",
    "The amplitude is real and not zero where [[condition]].": "La amplitud es real y no nula donde [[condition]].",
    "The frequency without [[small]] is real and not zero where [[condition]].": "La frecuencia con [[small]] = 0 es real y no nula donde [[condition]].",
    "It holds where the frequency without [[small]] is not zero: [[condition]].": "Vale donde la frecuencia con [[small]] = 0 no es cero: [[condition]].",
    "Resonance, and in general no such solution, where [[condition]] and [[other]] (harmonic [[harmonic]], order [[order]], of [[names]]).": "Resonancia, y en general ninguna solución así, donde [[condition]] y [[other]] (armónico [[harmonic]], orden [[order]], de [[names]]).",
    "Resonance, and in general no such solution, where [[condition]] (harmonic [[harmonic]], order [[order]], of [[names]]).": "Resonancia, y en general ninguna solución así, donde [[condition]] (armónico [[harmonic]], orden [[order]], de [[names]]).",
    "[[names]], on which no equation depends, follow by quadrature: see mbsym oscillations.": "[[names]], de las que no depende ninguna ecuación, se obtienen por cuadratura: véase mbsym oscillations.",
    "Measured at the given numbers, over one period, against motions that begin in the same state: with [[small]] halved from [[from]] to [[to]] the errors fall like its powers [[orders]] (not proved).": "Medido con los números dados, durante un período, frente a movimientos que empiezan en el mismo estado: al reducir [[small]] a la mitad, de [[from]] a [[to]], los errores disminuyen como sus potencias [[orders]] (no demostrado).",
    "[[expected]] or more is expected of a right solution to this order, where [[small]] is small enough.": "De una solución correcta a este orden se espera [[expected]] o más, si [[small]] es bastante pequeño.",
    "The error of the periodic solution was not measured: [[why]].": "El error de la solución periódica no se midió: [[why]].",
    "No periodic solution was expanded in powers of [[small]]: [[why]].": "No se desarrolló ninguna solución periódica en potencias de [[small]]: [[why]].",
    "Periodic solutions in powers of [[small]] are looked for by mbsym oscillations.": "Las soluciones periódicas en potencias de [[small]] las busca mbsym oscillations.",
    "[[system]]: series to order [[order]] at [[small]] = [[value]], and the motion": "[[system]]: series hasta el orden [[order]] con [[small]] = [[value]], y el movimiento",
    "(no angles: [[why]])": "(sin ángulos: [[why]])",
    "series": "serie",
    "motion (simulation)": "movimiento (simulación)",
}

#: Why no angles are drawn.
WORDS = {
    "quantities are prescribed": "hay magnitudes prescritas",
    "a speed is no variable of the series": "una velocidad no es variable de las series",
    "the angles become singular": "los ángulos se hacen singulares",
}
