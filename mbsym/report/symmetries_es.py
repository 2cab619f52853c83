"""Spanish sentences of symmetries."""

# ruff: noqa: E501

SENTENCES = {
    "Symmetries (Noether) with fields of degree one in the positions and Gamma of degree two, both free of the time:": "Simetrías (Noether) con campos de grado uno en las posiciones y Gamma de grado dos, ambos independientes del tiempo:",
    "The field [[field]] gives an integral that is known ([[name]]).": "El campo [[field]] da una integral conocida ([[name]]).",
    "The field [[field]] gives no further integral ([[name]]; verified at a random state).": "El campo [[field]] no da una integral nueva ([[name]]; verificado en un estado al azar).",
    "The field [[field]] gives a further integral, no function of those known without it (proved):": "El campo [[field]] da una integral nueva, que no es función de las conocidas sin ella (demostrado):",
    "The field [[field]] gives an integral of which it is undecided whether it is a function of those of problem 7:": "El campo [[field]] da una integral de la que no está decidido si es función de las del problema 7:",
    "None was found; that there is none is not proved.": "No se encontró ninguna; que no haya ninguna no está demostrado.",
    "Each of them is an identity of the exact ring (proved).": "Cada una es una identidad del anillo exacto (demostrado).",
    "That there are no others is not proved.": "Que no haya otras no está demostrado.",
    "There is none of this kind (proved: rank of the conditions on [[unknowns]] constants at exact states).": "No hay ninguna de esta clase (demostrado: rango de las condiciones sobre [[unknowns]] constantes en estados exactos).",
    "There is none of this kind, for almost all values of the parameters (proved: rank of the conditions on [[unknowns]] constants at exact states).": "No hay ninguna de esta clase, para casi todos los valores de los parámetros (demostrado: rango de las condiciones sobre [[unknowns]] constantes en estados exactos).",
    "There is none of this kind (proved: the conditions on [[unknowns]] constants, compared in independent functions).": "No hay ninguna de esta clase (demostrado: las condiciones sobre [[unknowns]] constantes, comparadas en funciones independientes).",
    "There is none of this kind, for almost all values of the parameters (proved: the conditions on [[unknowns]] constants, compared in independent functions).": "No hay ninguna de esta clase, para casi todos los valores de los parámetros (demostrado: las condiciones sobre [[unknowns]] constantes, comparadas en funciones independientes).",
    "Every other of this kind is a combination of these with constant coefficients (proved: rank of the conditions on [[unknowns]] constants at exact states).": "Toda otra de esta clase es una combinación de estas con coeficientes constantes (demostrado: rango de las condiciones sobre [[unknowns]] constantes en estados exactos).",
    "Every other of this kind is a combination of these with constant coefficients, for almost all values of the parameters (proved: rank of the conditions on [[unknowns]] constants at exact states).": "Toda otra de esta clase es una combinación de estas con coeficientes constantes, para casi todos los valores de los parámetros (demostrado: rango de las condiciones sobre [[unknowns]] constantes en estados exactos).",
    "Every other of this kind is a combination of these with constant coefficients (proved: the conditions on [[unknowns]] constants, compared in independent functions).": "Toda otra de esta clase es una combinación de estas con coeficientes constantes (demostrado: las condiciones sobre [[unknowns]] constantes, comparadas en funciones independientes).",
    "Every other of this kind is a combination of these with constant coefficients, for almost all values of the parameters (proved: the conditions on [[unknowns]] constants, compared in independent functions).": "Toda otra de esta clase es una combinación de estas con coeficientes constantes, para casi todos los valores de los parámetros (demostrado: las condiciones sobre [[unknowns]] constantes, comparadas en funciones independientes).",
}

WORDS = {"function of those before it": "función de las anteriores"}
