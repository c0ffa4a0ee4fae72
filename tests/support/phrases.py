"""Names as users write them before they know the catalogue, and what they mean.

Written down before the scorer was: textbook symbols, words of machine designers, other spellings, typing errors. Each
phrase is of a mechanism; what is meant must be among the first three suggestions.
"""

#: Phrases for quantities, by mechanism: `NAME: PHRASE | PHRASE` a line.
QUANTITIES = {
    "planar_4r": """
        transmission_angle: mu | μ | \\mu | transmissionAngle | pressure angle
        transmission_angle_min: mu_min | μmin | minimum transmission angle
        mechanical_advantage: mechanical advantage | force amplification
        P_speed: path length
        theta4_travel: theta4 dwell
        T41: torque | crank torque | motor torque | T_41 | T14
        T41_peak: peak torque
        T41_rms: rms(T41)
        shaking_force: shaking force | F_shaking
        F41: bearing force | force at O
        F32: reaction at B
        F41_x: F41x
        omega4: w4 | ω₄ | omeg4 | rocker speed | output angular velocity
        omega2: angular velocity of coupler | omega3
        alpha4: acceleration
        theta4: output angle | follower angle | psi
        P_y: coupler_point_y
        P_x: coupler curve
        P_vx: vPx
        B_x: position of B
        omega4_max: max_omega4
        omega4_peak: peak omega4
        omega4_max_error: error of the greatest omega4
        omega4_mean: omega4_avg
        theta1_at_omega4_max: theta1_at_max_omega4 | argmax omega4
        theta1_at_transmission_angle_min: crank angle of minimum transmission angle
        T41_extrema: all extrema of T41
        omega4_extrema_count: number of extrema of omega4
        d_omega4_d_a2: domega4_da2 | derivative of omega4 with respect to a2
        d_omega4_d_a2_max: d_omega4_da2_max
        omega4_error: omega4_err
        grashof_class: grashof | crank-rocker
        swing: oscillation angle
        time_ratio: quick return ratio
        input_power: power
        jerk4: jerk
        theta1_low: dead centre | limit angles
        status: assembles
        joint_angle_1: joint angle
        loop_residual: closure error
        T41_fluctuation: torque fluctuation
    """,
    "slider_crank": """
        omega2_max: omega4_max
        transmission_angle_min: mu_min
        slider_velocity: piston velocity
        slider_position: piston position | x
        slider_acceleration_max: piston acceleration max
        slider_acceleration: a
        side_force: side thrust
        theta2: connecting rod angle
        omega2: conrod angular velocity
        T41: crank torque
        outer_dead_centre: top dead center | TDC
        F32: wrist pin force
        slider_velocity_rms: slider velocity rms
        d_slider_position_d_r: dslider_position_dr
    """,
    "focal": """
        transmission_angle_F: pressure angle
        F_x: F position
        lambda_: lambda
        dpsi_dphi: dψ/dφ
        F_path_residual: straight line error
        sigma: crank angle
    """,
    "hart": """
        F_deviation: straight line deviation
        stroke: stroke length
        F_x: point F
        lambda_: lambda
        dF_y_dphi: velocity of F
    """,
    "minkowski_4r": """
        zeta: transmission angle
        X_x: coupler point
        theta_branching: branching point
        phi: coupler angle
    """,
}

#: Phrases for inputs, by mechanism.
INPUTS = {
    "planar_4r": """
        a1: A1 | l1 | length_crank
        a2: coupler length
        a3: output link | follower length
        a4: frame | fixed link
        omega1: w1 | rpm | input speed
        density: rho
        radius: bar_radius
        m1: mass_crank
        m2: mass coupler
        I2: J2
        I3: moment of inertia of the output link
        gravity_y: gravity
        G2_u: centre of mass of the coupler
        P_u: coupler point
        T_load: load torque
        alpha1: angular acceleration
        FP_x: external force
    """,
    "slider_crank": """
        r: crank radius | a1
        l: connecting rod length | L
        e: offset
        m3: piston mass
        F_load: gas force
    """,
    "hart": """
        kappa: k
        d: base length
    """,
    "focal": """
        d: ground
        lambda_: lambda
        c: coupler
        omega: angular velocity
    """,
    "minkowski_4r": """
        h: coupler
        g: ground
        tolerance: tol
    """,
}

#: Phrases for mechanisms.
MECHANISMS = """
        planar_4r: fourbar | four-bar linkage | crank_rocker | Planar_4R
        slider_crank: crank_slider | piston
        minkowski_4r: minkowski
        focal: burmester
        hart: six-bar | straight line
"""


def pairs(lines: str) -> list[tuple[str, str]]:
    """Return the phrases of a table with what they mean."""
    rows = [line.partition(": ") for line in map(str.strip, lines.splitlines()) if line]
    return [(phrase, name) for name, _, phrases in rows for phrase in phrases.split(" | ")]
