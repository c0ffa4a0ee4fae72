"""Names as users write them before they know the catalogue, and what they mean.

Written down before the scorer was: textbook symbols, words of machine designers, other spellings, typing errors. Each
phrase is of a mechanism; what is meant must be among the first three suggestions.
"""

#: Phrases for quantities, by mechanism: one `PHRASE -> NAME` a line.
QUANTITIES = {
    "planar_4r": """
        mu -> transmission_angle
        μ -> transmission_angle
        \\mu -> transmission_angle
        mu_min -> transmission_angle_min
        μmin -> transmission_angle_min
        minimum transmission angle -> transmission_angle_min
        transmissionAngle -> transmission_angle
        pressure angle -> transmission_angle
        mechanical advantage -> d_theta4_d_theta1
        torque -> T41
        peak torque -> T41_peak
        crank torque -> T41
        motor torque -> T41
        rms(T41) -> T41_rms
        T_41 -> T41
        T14 -> T41
        shaking force -> shaking_force
        F_shaking -> shaking_force
        bearing force -> F41
        force at O -> F41
        reaction at B -> F32
        F41x -> F41_x
        w4 -> omega4
        ω₄ -> omega4
        omeg4 -> omega4
        rocker speed -> omega4
        output angular velocity -> omega4
        angular velocity of coupler -> omega2
        omega3 -> omega2
        acceleration -> alpha4
        output angle -> theta4
        follower angle -> theta4
        psi -> theta4
        coupler_point_y -> P_y
        coupler curve -> P_x
        vPx -> P_vx
        position of B -> B_x
        max_omega4 -> omega4_max
        peak omega4 -> omega4_peak
        error of the greatest omega4 -> omega4_max_error
        omega4_avg -> omega4_mean
        theta1_at_max_omega4 -> theta1_at_omega4_max
        argmax omega4 -> theta1_at_omega4_max
        crank angle of minimum transmission angle -> theta1_at_transmission_angle_min
        all extrema of T41 -> T41_extrema
        number of extrema of omega4 -> omega4_extrema_count
        domega4_da2 -> d_omega4_d_a2
        derivative of omega4 with respect to a2 -> d_omega4_d_a2
        d_omega4_da2_max -> d_omega4_d_a2_max
        omega4_err -> omega4_error
        grashof -> grashof_class
        crank-rocker -> grashof_class
        oscillation angle -> swing
        quick return ratio -> time_ratio
        power -> input_power
        jerk -> jerk4
        dead centre -> theta1_low
        limit angles -> theta1_low
        assembles -> status
        joint angle -> joint_angle_1
        closure error -> loop_residual
        torque fluctuation -> T41_fluctuation
    """,
    "slider_crank": """
        omega4_max -> omega2_max
        mu_min -> transmission_angle_min
        piston velocity -> slider_velocity
        piston position -> slider_position
        piston acceleration max -> slider_acceleration_max
        x -> slider_position
        a -> slider_acceleration
        side thrust -> side_force
        connecting rod angle -> theta2
        conrod angular velocity -> omega2
        crank torque -> T41
        top dead center -> outer_dead_centre
        TDC -> outer_dead_centre
        wrist pin force -> F32
        slider velocity rms -> slider_velocity_rms
        dslider_position_dr -> d_slider_position_d_r
    """,
    "focal": """
        pressure angle -> transmission_angle_F
        F position -> F_x
        lambda -> lambda_
        dψ/dφ -> dpsi_dphi
        straight line error -> F_path_residual
        crank angle -> sigma
    """,
    "hart": """
        straight line deviation -> F_deviation
        stroke length -> stroke
        point F -> F_x
        lambda -> lambda_
        velocity of F -> dF_y_dphi
    """,
    "minkowski_4r": """
        transmission angle -> zeta
        coupler point -> X_x
        branching point -> theta_branching
        coupler angle -> phi
    """,
}

#: Phrases for inputs, by mechanism.
INPUTS = {
    "planar_4r": """
        A1 -> a1
        l1 -> a1
        length_crank -> a1
        coupler length -> a2
        output link -> a3
        follower length -> a3
        frame -> a4
        fixed link -> a4
        w1 -> omega1
        rpm -> omega1
        input speed -> omega1
        rho -> density
        bar_radius -> radius
        mass_crank -> m1
        mass coupler -> m2
        J2 -> I2
        moment of inertia of the output link -> I3
        gravity -> gravity_y
        centre of mass of the coupler -> G2_u
        coupler point -> P_u
        load torque -> T_load
        angular acceleration -> alpha1
        external force -> FP_x
    """,
    "slider_crank": """
        crank radius -> r
        connecting rod length -> l
        L -> l
        offset -> e
        piston mass -> m3
        gas force -> F_load
        a1 -> r
    """,
    "hart": """
        k -> kappa
        base length -> d
    """,
    "focal": """
        ground -> d
        lambda -> lambda_
        coupler -> c
        angular velocity -> omega
    """,
    "minkowski_4r": """
        coupler -> h
        ground -> g
        tol -> tolerance
    """,
}

#: Phrases for mechanisms.
MECHANISMS = """
    fourbar -> planar_4r
    four-bar linkage -> planar_4r
    crank_rocker -> planar_4r
    Planar_4R -> planar_4r
    crank_slider -> slider_crank
    piston -> slider_crank
    minkowski -> minkowski_4r
    burmester -> focal
    six-bar -> hart
    straight line -> hart
"""


def pairs(lines: str) -> list[tuple[str, str]]:
    """Return the phrases of a table with what they mean."""
    rows = (line.rpartition(" -> ") for line in map(str.strip, lines.splitlines()) if line)
    return [(phrase, name) for phrase, _, name in rows]
