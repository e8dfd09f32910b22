"""Fixed texts of the report: the method, and the differences from the paper with their reasons."""

METHOD = (
    "Every run uses the session and the compiled step of the live console, as `higvf run SCENARIO --headless` does. The"
    " digest is the SHA-256 of the trajectory; the command reports the same digest.",
    "All equations have their corrected form unless stated otherwise; the case `forms` switches one at a time.",
    "A check mark means that the measured value meets the expectation; a dash means that there is no expectation.",
    "One arena unit is one metre; the paper mixes pixels and metres. Robots are single integrators with a control"
    " period of 0.02 s.",
)

DIFFERENCES = (
    (
        "Guiding vector field [2] with the signed distance in units of a capture distance",
        "With the level set in squared pixels, the tangential part is significant only within 0.002 px of the path.",
    ),
    (
        "One composite step, on the blended velocity, and one circulation direction for the whole team",
        "The printed human intention has no Z X_R term, so that no term turns a robot that faces an obstacle. A team"
        " that splits round a bar blocks itself.",
    ),
    (
        "Robot intention [11] bounded, formation [12] with a sign, update [15] semi-implicit, speed [17] and blending"
        " [19] with a floor, bumps [29] to [31] dimensionless",
        "The case `forms` shows the effect of each printed form.",
    ),
    (
        "Safety constraints [20] to [28] with a linear class-K branch below zero, a term for growing fires, and the h"
        " of the same obstacle",
        "With the cubic class-K function alone, a robot needs twenty minutes to leave a violation. Without the growth"
        " term, a fire overruns a robot at rest.",
    ),
    (
        "Target memory and a margin of 5 % between targets",
        "Without them, a robot drops a target that is out of sight, and switches repeatedly between equal targets.",
    ),
    (
        "The project's own bar, parameters, law of extinguishing and start delay",
        "The paper does not give them. The absolute loss areas depend on them; the orders and signs do not.",
    ),
    (
        "A circle with the centre (650, 300) in addition to the published (250, 300)",
        "The published circle contains none of the start positions that the text calls inside.",
    ),
    (
        "The project's own positions in both physical cases, obstacles on the circle, and strokes of the operator",
        "The paper shows photographs and gives no numbers. The inputs of case 2 are synthetic recordings.",
    ),
    ("No physical robots", "Both physical cases are simulated."),
)
