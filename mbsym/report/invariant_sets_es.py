"""Spanish sentences of problem 10."""

# ruff: noqa: E501

SENTENCES = {
    "Pieces that are not invariant by themselves, left aside: [[n]].": "Partes que no son invariantes por sí mismas, dejadas aparte: [[n]].",
    "What is said of stability is about these variables: [[names]].": "Lo dicho de la estabilidad se refiere a estas variables: [[names]].",
    "Multipliers of the geometry are Lagrange's: along a motion only the others are constant.": "Los multiplicadores de la geometría son los de Lagrange: a lo largo de un movimiento solo los demás son constantes.",
    "Branches on which the coordinates are singular, left aside: [[n]]; some may have no real points.": "Ramas en las que las coordenadas son singulares, dejadas aparte: [[n]]; algunas pueden no tener puntos reales.",
    "Problem 10. Steady motions and invariant manifolds": "Problema 10. Movimientos estacionarios y variedades invariantes",
    "Families K of first integrals with constant multipliers; a motion that begins where grad K = 0 stays there.": "Familias K de integrales primeras con multiplicadores constantes; un movimiento que comienza donde grad K = 0 permanece allí.",
    "V[[k]], [[name]]: [[formula]].": "V[[k]], [[name]]: [[formula]].",
    "Between the variables: [[relations]].": "Entre las variables: [[relations]].",
    "It has no stationary points for almost all parameters (proved).": "No tiene puntos estacionarios para casi todos los parámetros (demostrado).",
    "Branches left aside, because they are beyond the budget or no point of them was found: [[n]]; some may be empty, and there may be further sets.": "Ramas dejadas de lado por exceder el presupuesto o porque no se halló ningún punto de ellas: [[n]]; algunas pueden ser vacías, y puede haber más conjuntos.",
    "Set [[number]], steady motions: [[equations]].": "Conjunto [[number]], movimientos estacionarios: [[equations]].",
    "They form a family of dimension [[union]].": "Forman una familia de dimensión [[union]].",
    "Set [[number]], an invariant manifold of dimension [[dimension]] for fixed multipliers: [[equations]].": "Conjunto [[number]], una variedad invariante de dimensión [[dimension]] para multiplicadores fijos: [[equations]].",
    "There [[nonzero]].": "Allí [[nonzero]].",
    "Multipliers: [[told]].": "Multiplicadores: [[told]].",
    "On it: [[motion]].": "Movimiento en ella: [[motion]].",
    "No real point was found at the parameters that were tried: whether it has any is open.": "No se halló ningún punto real con los parámetros probados: queda abierto si los tiene.",
    "It is invariant (proved: d/dt of its equations vanishes on it).": "Es invariante (demostrado: la derivada temporal de sus ecuaciones se anula en él).",
    "That it is invariant was not verified: d/dt of its equations could not be reduced on it.": "La invariancia no se verificó: la derivada de sus ecuaciones no se pudo reducir en él.",
    "It is NOT invariant by the equations of motion: this is a defect of mbsym.": "NO es invariante según las ecuaciones del movimiento: es un defecto de mbsym.",
    "Stable (proved: the second variation of K on the level of the integrals is definite).": "Estables (demostrado: la segunda variación de K en el nivel de las integrales es definida).",
    "Stable as a set, near motions on it that stay bounded (proved: K is definite across it).": "Estable como conjunto, cerca de movimientos acotados en él (demostrado: K es definida transversalmente).",
    "Sufficient for stability, for some value of [[chosen]]: [[first]].": "Suficiente para la estabilidad, para algún valor de [[chosen]]: [[first]].",
    "Sufficient for stability: [[first]].": "Suficiente para la estabilidad: [[first]].",
    "Sufficient for stability as a set, near motions on it that stay bounded: [[first]].": "Suficiente para la estabilidad como conjunto, cerca de movimientos acotados en él: [[first]].",
    "Or, with K of the other sign: [[second]].": "O bien, con K del otro signo: [[second]].",
    "The second variation is never definite: this family decides nothing about stability.": "La segunda variación nunca es definida: esta familia no decide nada sobre la estabilidad.",
    "The second variation is degenerate: this family decides nothing about stability.": "La segunda variación es degenerada: esta familia no decide nada sobre la estabilidad.",
    "The second variation was not looked at: it is beyond the budget.": "La segunda variación no se examinó: excede el presupuesto.",
    "First approximation: roots of [[factors]].": "Primera aproximación: raíces de [[factors]].",
    "First approximation: zero roots: [[zeros]]; the others are roots of [[factors]].": "Primera aproximación: raíces nulas: [[zeros]]; las demás son raíces de [[factors]].",
    "Unstable (proved by the first approximation).": "Inestables (demostrado por la primera aproximación).",
    "Necessary for stability: [[conditions]].": "Necesario para la estabilidad: [[conditions]].",
    "Necessary for stability: [[condition]], unless [[unless]].": "Necesario para la estabilidad: [[condition]], salvo que [[unless]].",
    "Further necessary conditions were not written out.": "Otras condiciones necesarias no se escribieron.",
    "All this is for parameters with [[zeros]]; others were not looked at.": "Todo esto vale para parámetros con [[zeros]]; los demás no se examinaron.",
    "Between them is a gap: a point was found at which what is necessary holds strictly and what is sufficient does not; there this family decides nothing.": "Entre ambas hay una brecha: se halló un punto donde lo necesario se cumple estrictamente y lo suficiente no; allí esta familia no decide nada.",
    "Between them is perhaps a gap: a point was found at which what is necessary holds strictly and what is sufficient for no multipliers that were tried.": "Entre ambas hay quizá una brecha: se halló un punto donde lo necesario se cumple estrictamente y lo suficiente con ninguno de los multiplicadores probados.",
    "At every point that was tried where the necessary conditions held strictly the sufficient ones held, too: no gap was found, which is no proof that there is none.": "En todos los puntos probados donde las condiciones necesarias se cumplían estrictamente se cumplían también las suficientes: no se halló brecha, lo que no demuestra que no la haya.",
}

WORDS = {
    "geometry": "geometría",
}
