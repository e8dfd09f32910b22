"""What the report says in its own words: how it was made, what differs from the paper, and why."""

METHOD = (
    "Every run goes through the same session and the same compiled step as the live console, headless, as"
    " `higvf run SCENARIO --headless` does; the digest is the SHA-256 of the trajectory that such a run reports too.",
    "All equations run in their corrected form unless a row says otherwise; the case `forms` switches one at a time.",
    "A check mark means that the measured number meets the expectation beside it; a dash, that nothing is promised.",
    "One arena unit is one metre; the paper mixes pixels and metres. Robots are single integrators with a control"
    " period of 0.02 s.",
)

DIFFERENCES = (
    (
        "Guiding vector field [2] by signed distance over a capture distance",
        "With the level set in squared pixels the tangential part matters only within 0.002 px of the path.",
    ),
    (
        "Composite step once, on the blended velocity, and one circulation side for the whole team",
        "The printed human intention has no Z X_R term, so nothing turns a robot that faces an obstacle; a team that"
        " splits round a bar holds itself there.",
    ),
    (
        "Robot intention [11] bounded, formation [12] with a sign, update [15] semi-implicit, speed [17] and blending"
        " [19] with a floor, bumps [29] to [31] dimensionless",
        "The case `forms` shows for each what the printed form does.",
    ),
    (
        "Safety rows [20] to [28] with a linear class-K branch below zero, a term for growing fires, h of the same"
        " obstacle",
        "The cube alone takes twenty minutes out of a violation; without the growth a fire overruns a robot at rest.",
    ),
    (
        "Target memory and a margin of 5 % between targets",
        "Without them a target that goes out of sight is forgotten, and robots waver between equal ones.",
    ),
    (
        "Bar, gains, law of extinguishing and start delay are the project's own",
        "The paper does not give them; absolute loss areas follow from them, orders and signs do not.",
    ),
    (
        "Circle with the centre (650, 300) beside the published (250, 300)",
        "The published one contains none of the starts that the text calls inside.",
    ),
    (
        "Positions of both physical cases, of the obstacles on the circle, and the operator's strokes are the"
        " project's own",
        "The paper shows photographs and gives no numbers; the inputs of case 2 are synthetic recordings.",
    ),
    ("No physical robots", "Both physical cases are simulated."),
)
